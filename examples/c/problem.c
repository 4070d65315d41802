/* A disc of 1 kg on the ground and another one upon it: the ground carries both, the lower one the upper. */
#include <lcpbench.h>
#include <stdio.h>

int main(void) {
  const int32_t starts[3] = {0, 1, 3}, indices[3] = {1, 1, 4}; /* rows of J: the vertical velocities 1 and 4 */
  const double J[3] = {1, -1, 1}, inverse_mass[6] = {1, 1, 2, 1, 1, 2};
  const double b[2] = {-9.81, 0}; /* J g */
  const lcpbench_problem_data data = {.size = sizeof data,
                                      .form = LCPBENCH_FACTORS,
                                      .by_rows = 1,
                                      .rows = 2,
                                      .columns = 6,
                                      .values = J,
                                      .entries = 3,
                                      .starts = starts,
                                      .indices = indices,
                                      .inverse_mass = inverse_mass,
                                      .b = b};
  lcpbench_problem* problem = NULL;
  lcpbench_solver* solver = NULL;
  lcpbench_answer answer = {.size = sizeof answer};
  lcpbench_verdict verdict = {.size = sizeof verdict};
  if (lcpbench_problem_create(&data, &problem) || lcpbench_solver_create("auto", NULL, &solver) ||
      lcpbench_solve(solver, problem, NULL, &answer) || lcpbench_verify(problem, &answer, 1e-9, &verdict, NULL)) {
    fprintf(stderr, "%s\n", lcpbench_last_error());
    return 2;
  }
  const double* f = answer.f;
  printf("forces %g N and %g N, rho %g\n", f[0], f[1], verdict.rho);
  const int holds = verdict.passes && f[0] > 19.6199 && f[0] < 19.6201 && f[1] > 9.8099 && f[1] < 9.8101;
  lcpbench_solver_free(solver);
  lcpbench_problem_free(problem);
  return holds ? 0 : 1;
}
