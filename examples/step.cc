// One time step from the arrays of an engine to forces (docs/embedding.md). c/step.c is the same in C.

#include <cstdint>
#include <cstdio>

#include "solvers/step/step_solver.h"

int main() {
  // A disc of 1 kg on the ground (-1), and another one upon it. Of each: x, y, rotation.
  const std::int32_t body[] = {0, -1, 1, 0};
  const double J[] = {0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0};
  const double b[] = {-9.81, 0}, inverse_mass[] = {1, 1, 2, 1, 1, 2};
  lcpbench::StepRows rows;
  rows.rows = 2;
  rows.bodies = 2;
  rows.body = body;
  rows.J = J;
  rows.b = b;
  rows.inverse_mass = inverse_mass;
  lcpbench::StepSolver solver;  // one for every thread, kept from step to step
  solver.Reserve(1000, 500);
  double f[2];
  const lcpbench::StepAnswer answer = solver.Solve(rows, nullptr, f);
  const bool is_solved = answer.status == lcpbench::LcpStatus::kSolved;
  std::printf("%s: %g N and %g N\n", is_solved ? "solved" : "not solved", f[0], f[1]);
  return is_solved ? 0 : 1;
}
