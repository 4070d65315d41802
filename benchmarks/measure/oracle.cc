#include "benchmarks/measure/oracle.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <optional>

#include "benchmarks/measure/body_system.h"
#include "support/clock.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/linear_algebra/cholmod_factor.h"
#include "solvers/linear_algebra/graph_order.h"
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

// Up-looking LDL^T of a symmetric matrix that leaves out the rows whose pivot vanishes.
class Elimination {
 public:
  explicit Elimination(const ColumnMatrix& C) : C_(C), n_(static_cast<int>(C.cols())) {
    const auto n = static_cast<std::size_t>(n_);
    parent_.assign(n, -1);
    flag_.assign(n, -1);
    columns_.resize(n);
    pivot_.assign(n, 0);
    y_.assign(n, 0);
    path_.resize(n);
    pattern_.resize(n);
    FindTree();
  }

  std::vector<bool> KeptRows() {
    std::vector<bool> kept(static_cast<std::size_t>(n_));
    for (int k = 0; k < n_; ++k) kept[static_cast<std::size_t>(k)] = Eliminate(k);
    return kept;
  }

 private:
  struct Entry {
    int row = 0;
    double value = 0;
  };
  static std::size_t At(int i) { return static_cast<std::size_t>(i); }

  void FindTree() {
    for (int k = 0; k < n_; ++k) {
      flag_[At(k)] = k;
      for (ColumnMatrix::InnerIterator it(C_, k); it && it.index() < k; ++it) {
        for (int i = it.index(); flag_[At(i)] != k; i = parent_[At(i)]) {
          if (parent_[At(i)] == -1) parent_[At(i)] = k;
          flag_[At(i)] = k;
        }
      }
    }
    std::fill(flag_.begin(), flag_.end(), -1);
  }

  // Row k of L; false, and a column that takes no part, if it depends on the rows before.
  bool Eliminate(int k) {
    int top = n_;
    flag_[At(k)] = k;
    double pivot = 0;
    for (ColumnMatrix::InnerIterator it(C_, k); it && it.index() <= k; ++it) {
      if (it.index() == k) {
        pivot = it.value();
        continue;
      }
      y_[At(it.index())] = it.value();
      int length = 0;
      for (int i = it.index(); flag_[At(i)] != k; i = parent_[At(i)]) {
        path_[At(length++)] = i;
        flag_[At(i)] = k;
      }
      while (length > 0) pattern_[At(--top)] = path_[At(--length)];
    }
    const double diagonal = pivot;
    for (; top < n_; ++top) {
      const int i = pattern_[At(top)];
      const double y = y_[At(i)];
      y_[At(i)] = 0;
      if (pivot_[At(i)] == 0) continue;
      for (const Entry& entry : columns_[At(i)]) y_[At(entry.row)] -= entry.value * y;
      const double l = y / pivot_[At(i)];
      pivot -= l * y;
      columns_[At(i)].push_back({k, l});
    }
    // Entries of column i below row k do not exist yet, so y_ at k itself was reached by no update.
    y_[At(k)] = 0;
    const bool kept = pivot > kDependent * diagonal;
    pivot_[At(k)] = kept ? pivot : 0;
    return kept;
  }

  const ColumnMatrix& C_;
  int n_;
  std::vector<int> parent_;
  std::vector<int> flag_;
  std::vector<std::vector<Entry>> columns_;
  std::vector<double> pivot_;
  std::vector<double> y_;
  std::vector<int> path_;
  std::vector<int> pattern_;
};

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
  const ColumnMatrix sub = Submatrix(A, rows);
  Eigen::AMDOrdering<int> ordering;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
  ordering(sub.selfadjointView<Eigen::Upper>(), inverse);
  const Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order = inverse.inverse();
  ColumnMatrix permuted(sub.rows(), sub.cols());
  permuted = sub.twistedBy(order);
  const std::vector<bool> kept = Elimination(permuted).KeptRows();
  std::vector<Index> independent;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (kept[static_cast<std::size_t>(order.indices()[static_cast<Index>(k)])]) independent.push_back(rows[k]);
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
