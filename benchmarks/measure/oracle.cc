#include "benchmarks/measure/oracle.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <optional>

#include "benchmarks/measure/body_system.h"
#include "support/clock.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/linear_algebra/cholmod_factor.h"
#endif

namespace lcpbench {
namespace {

using ColumnMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// A[rows, rows], both triangles.
ColumnMatrix Submatrix(const SparseMatrix& A, const std::vector<Index>& rows) {
  std::vector<int> place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k) place[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double, int>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (SparseMatrix::InnerIterator it(A, rows[k]); it; ++it) {
      const int j = place[static_cast<std::size_t>(it.col())];
      if (j >= 0) entries.emplace_back(static_cast<int>(k), j, it.value());
    }
  }
  const auto n = static_cast<Index>(rows.size());
  ColumnMatrix sub(n, n);
  sub.setFromTriplets(entries.begin(), entries.end());
  return sub;
}

#ifdef LCPBENCH_WITH_SUITESPARSE
using Kind = CholmodFactor::Definiteness;

// Analyses, factorizes and solves in the order that `order` gives (empty: AMD of the matrix), a few times; the
// shortest. Nothing where it fails.
template <typename Order>
std::optional<Factorization> Shortest(const ColumnMatrix& lower, Kind kind, const Order& order) {
  constexpr int kMostRuns = 5;
  constexpr double kBudget = 1;  // s; longer ones run once
  const Eigen::VectorXd right = Eigen::VectorXd::Ones(lower.cols());
  std::optional<Factorization> shortest;
  double total = 0;
  for (int k = 0; k < kMostRuns && total < kBudget; ++k) {
    Eigen::VectorXd x;
    CholmodFactor factor;
    const double start = SteadyNow();
    const std::optional<Eigen::VectorXi> given = order();
    if (!given) return std::nullopt;
    factor.Analyze(kind, lower, *given);
    if (!factor.Factorize()) return std::nullopt;
    factor.Solve(right, &x);
    const double seconds = SteadyNow() - start;
    total += seconds;
    if (!shortest || seconds < shortest->seconds) shortest = {seconds, factor.fill(), factor.flops()};
  }
  return shortest;
}
#endif

}  // namespace

std::vector<Index> ActiveRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  std::vector<Index> rows;
  const Eigen::VectorXd& d = problem.DiagonalA();
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.is_bilateral(i) || d[i] * f[i] > w[i]) rows.push_back(i);
  }
  return rows;
}

std::vector<Index> IndependentRows(const SparseMatrix& A, const std::vector<Index>& rows) {
  if (rows.empty()) return {};
  // What is left of a dependent row's pivot: so much that its column of L is of the size of others, and little enough
  // against kDependent.
  constexpr double kShift = 1e-14;
  ColumnMatrix shifted = Submatrix(A, rows);
  const Eigen::VectorXd diagonal = shifted.diagonal();
  for (Index k = 0; k < diagonal.size(); ++k) {
    shifted.coeffRef(k, k) += std::max(kShift * diagonal[k], std::numeric_limits<double>::min());
  }
  const Eigen::SimplicialLDLT<ColumnMatrix> factor(shifted);
  if (factor.info() != Eigen::Success) return {};
  std::vector<Index> independent;
  for (Index k = 0; k < diagonal.size(); ++k) {
    const double pivot = factor.vectorD()[factor.permutationP().indices()[k]];
    if (pivot > kDependent * diagonal[k]) independent.push_back(rows[static_cast<std::size_t>(k)]);
  }
  return independent;
}

#ifdef LCPBENCH_WITH_SUITESPARSE
std::vector<Factorization> TimeBodySpace(const LcpProblem& problem, const std::vector<Index>& active) {
  if (!problem.has_factors()) return {};
  const BodySystem system = MakeBodySystem(problem, active);
  if (system.bodies() == 0) return {Factorization{}};
  // Operations per entry of L up to which columns one by one may beat supernodes: measured to break even at 60 to 90.
  constexpr double kMostForColumns = 150;
  std::vector<Factorization> times;
  for (const GraphOrder method : {GraphOrder::kMinimumDegree, GraphOrder::kNestedDissection}) {
    for (const Kind kind : {Kind::kPositiveDefinite, Kind::kQuasidefinite}) {
      if (kind == Kind::kQuasidefinite && !times.empty() && times.back().flops > kMostForColumns * times.back().fill) {
        continue;
      }
      const auto time = Shortest(system.lower, kind, [&]() -> std::optional<Eigen::VectorXi> {
        const Eigen::VectorXi bodies = OrderGraph(system.graph, method);
        if (bodies.size() < system.bodies()) return std::nullopt;  // CHOLMOD without METIS
        return system.Expand(bodies);
      });
      if (time) times.push_back(*time);
    }
  }
  return times;
}

double TimeOracle(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  const std::vector<Index> active = ActiveRows(problem, f, w);
  const std::vector<Index> independent = IndependentRows(problem.SparseA(), active);
  if (independent.empty()) return 0;
  std::vector<Factorization> times = TimeBodySpace(problem, active);
  const ColumnMatrix lower = Submatrix(problem.SparseA(), independent).triangularView<Eigen::Lower>();
  const auto contact = Shortest(lower, Kind::kPositiveDefinite, [] { return std::optional(Eigen::VectorXi()); });
  if (contact) times.push_back(*contact);
  double least = -1;
  for (const Factorization& time : times) least = least < 0 ? time.seconds : std::min(least, time.seconds);
  return least;
}
#else
std::vector<Factorization> TimeBodySpace(const LcpProblem& /*problem*/, const std::vector<Index>& /*active*/) {
  return {};
}
double TimeOracle(const LcpProblem& /*problem*/, const Eigen::VectorXd& /*f*/, const Eigen::VectorXd& /*w*/) {
  return -1;
}
#endif

}  // namespace lcpbench
