// The class that `lcpbench recommend` prints for steps of small and medium size, at work.
#include <printed_step.h>

#include <cmath>

int main() {
  // Two discs of 1 kg, one upon the other: the ground carries both.
  const std::int32_t body[] = {0, -1, 1, 0};
  const double J[] = {0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0};
  const double b[] = {-9.81, 0};
  const double inverse_mass[] = {1, 1, 2, 1, 1, 2};
  lcpbench::StepRows rows;
  rows.rows = 2;
  rows.bodies = 2;
  rows.body = body;
  rows.J = J;
  rows.b = b;
  rows.inverse_mass = inverse_mass;
  ContactSolver solver;
  double forces[2] = {0, 0};
  const bool holds = solver.Solve(rows, forces);
  return holds && std::abs(forces[0] - 19.62) < 1e-5 && std::abs(forces[1] - 9.81) < 1e-5 ? 0 : 1;
}
