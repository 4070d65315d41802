/* One time step from the arrays of an engine to forces, as step.cc does it in C++. */
#include <lcpbench.h>
#include <stdio.h>

int main(void) {
  const int32_t body[] = {0, -1, 1, 0};
  const double J[] = {0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0};
  const double b[] = {-9.81, 0}, inverse_mass[] = {1, 1, 2, 1, 1, 2};
  const lcpbench_problem_data data = {.size = sizeof data, /* contacts only, in the plane */
                                      .form = LCPBENCH_TWO_BODIES,
                                      .rows = 2,
                                      .bodies = 2,
                                      .values = J,
                                      .body = body,
                                      .inverse_mass = inverse_mass,
                                      .b = b};
  const lcpbench_step_options options = {.size = sizeof options, .max_rows = 1000, .max_bodies = 500};
  lcpbench_answer answer = {.size = sizeof answer};
  lcpbench_step* step = NULL;
  double f[2];
  if (lcpbench_step_create(&options, &step) || lcpbench_step_solve(step, &data, NULL, f, NULL, &answer)) {
    fprintf(stderr, "%s\n", lcpbench_last_error());
    return 2;
  }
  printf("%s: %g N and %g N\n", lcpbench_status_key(answer.status), f[0], f[1]);
  lcpbench_step_free(step);
  return answer.status == LCPBENCH_SOLVED ? 0 : 1;
}
