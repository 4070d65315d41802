/* One time step from the arrays of an engine to forces, as step.cc does it in C++. */
#include <lcpbench.h>
#include <stdio.h>

int main(void) {
  const int32_t body[] = {0, -1, 1, 0};
  const double J[] = {0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0};
  const double b[] = {-9.81, 0}, inverse_mass[] = {1, 1, 2, 1, 1, 2};
  const lcpbench_step_rows rows = {.size = sizeof rows, /* contacts only, in the plane */
                                   .rows = 2,
                                   .bodies = 2,
                                   .body = body,
                                   .J = J,
                                   .b = b,
                                   .inverse_mass = inverse_mass};
  lcpbench_step_answer answer;
  lcpbench_step* step = NULL;
  double f[2];
  if (lcpbench_step_create(NULL, &step) || lcpbench_step_reserve(step, 1000, 500) ||
      lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer)) {
    fprintf(stderr, "%s\n", lcpbench_last_error());
    return 2;
  }
  printf("%s: %g N and %g N\n", lcpbench_status_key(answer.status), f[0], f[1]);
  lcpbench_step_free(step);
  return answer.status == LCPBENCH_SOLVED ? 0 : 1;
}
