#include "solvers/exact/modes/mode_answer.h"

#include <cmath>

#include "solvers/exact/modes/mode_system.h"
#include "solvers/lcp/law.h"

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
  Eigen::VectorXd omega, root = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 1.0; });
  problem.ComputeW(f, &omega);
  omega = omega.cwiseQuotient(root);
  const Eigen::VectorXd trial = root.cwiseProduct(f) - omega;
  std::vector<FrictionRow> friction = problem.friction_rows();
  std::vector<BoundedRow> bounded = problem.bounded_rows();
  for (FrictionRow& row : friction) row.mu *= root[row.row] / root[row.normal];
  for (BoundedRow& row : bounded) {
    row.lower *= root[row.row];
    row.upper *= root[row.row];
  }
  std::vector<Index> normals;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.kind(i) == RowKind::kUnilateral) normals.push_back(i);
  }
  std::vector<RangeSide> sides(At(problem.size()));
  Laws{problem.bilateral_rows(), normals, friction, bounded}.VisitRanges(
      trial, [&](Index i, const auto& range) { sides[At(i)] = SideOf(range, trial[i]); });
  std::string modes(At(problem.size()), 'O');
  for (Index i = 0; i < problem.size(); ++i) {
    if (sides[At(i)] == RangeSide::kInside) modes[At(i)] = problem.is_bilateral(i) ? 'B' : 'C';
  }
  const auto mode_of = [](RangeSide side) {
    return side == RangeSide::kInside ? 'S' : side == RangeSide::kLower ? '+' : '-';
  };
  for (const FrictionRow& row : problem.friction_rows()) {
    const bool is_open = sides[At(row.normal)] == RangeSide::kLower;
    const RangeSide slip = row.mu > 0 || omega[row.row] >= 0 ? sides[At(row.row)] : RangeSide::kUpper;
    modes[At(row.row)] = is_open ? 'o' : row.slip != 0 ? 'k' : mode_of(slip);
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    const bool is_upper = row.lower == row.upper && omega[row.row] < 0;
    modes[At(row.row)] = is_upper ? '-' : mode_of(sides[At(row.row)]);
  }
  return modes;
}

}  // namespace lcpbench
