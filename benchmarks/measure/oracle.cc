#include "benchmarks/measure/oracle.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "benchmarks/measure/body_order.h"
#include "benchmarks/measure/body_system.h"
#include "solvers/lcp/solver.h"
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
// The shortest of a few runs of `run`, which fills in a Factorisation and returns false on failure.
template <typename Run>
std::optional<Factorisation> Shortest(const Run& run) {
  constexpr int kMostRuns = 5;
  constexpr double kBudget = 1;  // s; longer ones run once
  std::optional<Factorisation> shortest;
  double total = 0;
  for (int k = 0; k < kMostRuns && total < kBudget; ++k) {
    Factorisation one;
    if (!run(&one)) return std::nullopt;
    total += one.total_s();
    if (!shortest.has_value() || one.total_s() < shortest->total_s()) shortest = one;
  }
  return shortest;
}

// Analyses, factorises and solves in `order` (empty: AMD of the matrix).
bool TimeOnce(const ColumnMatrix& lower, CholmodFactor::Definiteness kind, const Eigen::VectorXi& order,
              double (*now)(), Factorisation* time) {
  const Eigen::VectorXd right = Eigen::VectorXd::Ones(lower.cols());
  Eigen::VectorXd x;
  CholmodFactor factor;
  const double start = now();
  factor.Analyze(kind, lower, order);
  const double analysed = now();
  if (!factor.Factorize()) return false;
  const double factorised = now();
  factor.Solve(right, &x);
  time->solve_s = now() - factorised;
  time->factor_s = factorised - analysed;
  time->analyse_s = analysed - start;
  time->fill = factor.fill();
  time->flops = factor.flops();
  return true;
}
#endif

// Negative without CHOLMOD.
double TimeIndependent(const LcpProblem& problem, const std::vector<Index>& independent, double (*now)()) {
#ifdef LCPBENCH_WITH_SUITESPARSE
  if (independent.empty()) return 0;
  const ColumnMatrix lower = Submatrix(problem.SparseA(), independent).triangularView<Eigen::Lower>();
  const std::optional<Factorisation> time = Shortest([&](Factorisation* one) {
    return TimeOnce(lower, CholmodFactor::Definiteness::kPositiveDefinite, {}, now, one);
  });
  return time.has_value() ? time->total_s() : -1;
#else
  static_cast<void>(problem);
  static_cast<void>(independent);
  static_cast<void>(now);
  return -1;
#endif
}

}  // namespace

double OracleTime::best() const {
  if (contact_s < 0 || body_s < 0) return std::max(contact_s, body_s);
  return std::min(contact_s, body_s);
}

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

double TimeContactSpace(const LcpProblem& problem, const std::vector<Index>& active, double (*now)()) {
  return TimeIndependent(problem, IndependentRows(problem.SparseA(), active), now);
}

std::vector<Factorisation> TimeBodySpace(const LcpProblem& problem, const std::vector<Index>& active, double (*now)()) {
  std::vector<Factorisation> times;
#ifdef LCPBENCH_WITH_SUITESPARSE
  if (!problem.has_factors()) return times;
  const BodySystem system = MakeBodySystem(problem, active);
  if (system.bodies() == 0) {
    times.emplace_back().name = "nothing to solve";
    return times;
  }
  using Kind = CholmodFactor::Definiteness;
  // Operations per entry of L up to which columns one by one may beat supernodes: measured to break even at 60 to 90.
  constexpr double kMostForColumns = 150;
  for (const BodyOrder method : kBodyOrders) {
    for (const Kind kind : {Kind::kPositiveDefinite, Kind::kQuasidefinite}) {
      if (kind == Kind::kQuasidefinite && !times.empty() && times.back().flops > kMostForColumns * times.back().fill) {
        continue;
      }
      std::optional<Factorisation> time = Shortest([&](Factorisation* one) {
        const double start = now();
        const Eigen::VectorXi bodies = OrderBodies(system, method);
        if (bodies.size() < system.bodies()) return false;
        const Eigen::VectorXi order = ExpandOrder(system, bodies);
        one->order_s = now() - start;
        return TimeOnce(system.lower, kind, order, now, one);
      });
      if (!time.has_value()) continue;
      time->name = ToString(method) + (kind == Kind::kPositiveDefinite ? "" : "-simplicial");
      times.push_back(*time);
    }
  }
#else
  static_cast<void>(problem);
  static_cast<void>(active);
  static_cast<void>(now);
#endif
  return times;
}

std::optional<Factorisation> Cheapest(const std::vector<Factorisation>& times) {
  const auto best = std::min_element(times.begin(), times.end(), [](const Factorisation& a, const Factorisation& b) {
    return a.total_s() < b.total_s();
  });
  return best == times.end() ? std::nullopt : std::optional(*best);
}

OracleTime TimeOracle(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  OracleTime time;
  const std::vector<Index> active = ActiveRows(problem, f, w);
  const std::vector<Index> independent = IndependentRows(problem.SparseA(), active);
  time.active = static_cast<Index>(active.size());
  time.independent = static_cast<Index>(independent.size());
  time.contact_s = TimeIndependent(problem, independent, &SteadyNow);
  const std::optional<Factorisation> body = Cheapest(TimeBodySpace(problem, active));
  if (body.has_value()) time.body_s = body->total_s();
  return time;
}

}  // namespace lcpbench
