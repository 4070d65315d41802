#include "solvers/exact/unique_forces.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/exact/sparse_rank.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// The tier that f must pass, and the part of the largest force or gap that is more than its error.
constexpr double kTier = 1e-6;
constexpr double kClear = 1e-6;

// Whether its rank may take more than kMostWorkOfUniqueForces, n^2 times the columns, where elimination fills the rows:
// that of at most 16 entries a row, on average, fills few.
bool RankCostsTooMuch(const LcpProblem& problem) {
  constexpr Index kFewEntries = 16;
  const SparseMatrix& given = problem.has_factors() ? problem.J() : problem.SparseA();
  const auto rows = static_cast<double>(given.rows());
  return given.nonZeros() > kFewEntries * given.rows() &&
         rows * rows * static_cast<double>(given.cols()) > kMostWorkOfUniqueForces;
}

}  // namespace

std::optional<bool> UniqueForces(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const MatrixFacts& facts = problem.facts();
  const Index n = problem.size();
  if (n == 0) return true;
  if (!problem.is_plain() || !facts.symmetric || !facts.positive_semidefinite || f.size() != n) return std::nullopt;
  if (n > kMostRowsOfUniqueForces || RankCostsTooMuch(problem)) return std::nullopt;
  const Metrics metrics = ComputeMetrics(problem, f);
  if (!PassesTier(metrics, kTier)) return std::nullopt;
  const Eigen::VectorXd root = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 1.0; });
  const Eigen::VectorXd force = root.cwiseProduct(f);
  const Eigen::VectorXd gap = metrics.w.cwiseQuotient(root);
  const double clear = kClear * std::max(force.lpNorm<Eigen::Infinity>(), gap.lpNorm<Eigen::Infinity>());
  std::vector<Index> loaded;
  std::vector<Index> not_open;
  for (Index i = 0; i < n; ++i) {
    if (problem.is_bilateral(i) || force[i] > clear) loaded.push_back(i);
    if (problem.is_bilateral(i) || !(gap[i] > clear)) not_open.push_back(i);
  }
  const auto are_independent = [&](const std::vector<Index>& rows) {
    return RankOfRows(problem, rows) == static_cast<Index>(rows.size());
  };
  if (!are_independent(loaded)) return false;
  if (loaded.size() == not_open.size() || are_independent(not_open)) return true;
  return std::nullopt;
}

}  // namespace lcpbench
