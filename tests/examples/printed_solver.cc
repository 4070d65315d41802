// The class that `lcpbench recommend` prints for a solver, at work.
#include <printed_solver.h>

int main() {
  // Two bodies of 1 kg on a line: the ground carries both.
  Eigen::MatrixXd A(2, 2);
  A << 1, -1, -1, 2;
  const auto problem = lcpbench::LcpProblem::FromDense("two", A, Eigen::Vector2d(-9.81, 0));
  ContactSolver solver;
  Eigen::VectorXd forces;
  const bool holds = solver.Solve(problem, &forces);
  return holds && (forces - Eigen::Vector2d(19.62, 9.81)).norm() < 1e-5 ? 0 : 1;
}
