#include "solvers/exact/modes/mode_answer.h"

#include <cmath>

#include "solvers/exact/modes/mode_system.h"

namespace lcpbench {

std::string FindFaultOfModes(const ExactLcp& problem, const std::string& modes, const RationalVector& f) {
  if (f.size() != At(problem.size) || modes.size() != f.size()) return "f or modes have another size than the problem";
  const RationalVector w = GapsOf(problem, f);
  for (const Law& law : LawsOf(problem, modes)) {
    const Rational value = ValueOf(law, f, w);
    if (law.is_equation ? value == 0 : value >= 0) continue;
    const LawTerm& term = law.terms.front();
    return std::string(term.is_gap ? "w" : "f") + " of row " + std::to_string(term.row) + " does not obey mode " +
           modes[At(term.row)];
  }
  return {};
}

std::string ModesOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Index n = problem.size();
  Eigen::VectorXd w, root(n);
  problem.ComputeW(f, &w);
  for (Index i = 0; i < n; ++i) root[i] = problem.DiagonalA()[i] > 0 ? std::sqrt(problem.DiagonalA()[i]) : 1;
  const Eigen::VectorXd trial = root.cwiseProduct(f) - w.cwiseQuotient(root);
  std::string modes(At(n), 'O');
  for (Index i = 0; i < n; ++i) {
    if (trial[i] > 0) modes[At(i)] = 'C';
    if (problem.is_bilateral(i)) modes[At(i)] = 'B';
  }
  for (const FrictionRow& row : problem.friction_rows()) {
    const double most = row.mu * root[row.row] / root[row.normal] * trial[row.normal];
    const char slip = trial[row.row] > most ? '-' : trial[row.row] < -most ? '+' : 'S';
    modes[At(row.row)] = modes[At(row.normal)] == 'O' ? 'o' : row.slip != 0 ? 'k' : slip;
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    const double force = trial[row.row] / root[row.row];
    modes[At(row.row)] = force < row.lower ? '+' : force > row.upper ? '-' : 'S';
  }
  return modes;
}

}  // namespace lcpbench
