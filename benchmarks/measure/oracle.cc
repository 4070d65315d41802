#include "benchmarks/measure/oracle.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "benchmarks/measure/quantile.h"
#include "solvers/lcp/law.h"
#include "solvers/lcp/residual.h"
#include "support/array_index.h"
#include "support/clock.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/linear_algebra/cholmod_factor.h"
#endif

namespace lcpbench {
namespace {

constexpr Index kPerBody = 3;

using ColumnMatrix = BodySystem::ColumnMatrix;

// chosen.size() x n, ones at (k, chosen[k]): from the left it picks rows, transposed from the right columns.
ColumnMatrix Picking(const std::vector<Index>& chosen, Index n) {
  std::vector<Eigen::Triplet<double, int>> ones;
  ones.reserve(chosen.size());
  for (const Index i : chosen) ones.emplace_back(static_cast<int>(ones.size()), static_cast<int>(i), 1);
  ColumnMatrix picking(static_cast<Index>(chosen.size()), n);
  picking.setFromTriplets(ones.begin(), ones.end());
  return picking;
}

// A[rows, rows], both triangles.
ColumnMatrix Submatrix(const SparseMatrix& A, const std::vector<Index>& rows) {
  const ColumnMatrix picking = Picking(rows, A.rows());
  return picking * ColumnMatrix(A) * picking.transpose();
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

bool Passes(const LcpProblem& problem, double tolerance, const Eigen::VectorXd& f) {
  ResidualEstimate residual(problem);
  return residual.Rho(f) <= tolerance && residual.Meets(tolerance, f);
}

// From factors by the arrays alone, unless a row's backward error is not small at once: of a small problem an
// LcpProblem takes longer than the solve.
bool Passes(const ProblemArrays& arrays, double tolerance, const Eigen::VectorXd& f, Eigen::VectorXd* velocity) {
  const bool is_plain = arrays.friction.empty() && arrays.bounded.empty();
  if (arrays.form != MatrixForm::kFactors || !is_plain) return Passes(LcpProblem::FromArrays(arrays), tolerance, f);
  const auto columns = static_cast<Index>(arrays.inverse_mass.size());
  const Eigen::Map<const SparseMatrix> J(arrays.rows, columns, arrays.row_start.back(), arrays.row_start.data(),
                                         arrays.column.data(), arrays.value.data());
  const Eigen::Map<const Eigen::VectorXd> inverse_mass(arrays.inverse_mass.data(), columns);
  velocity->setZero(columns);
  for (Index i = 0; i < arrays.rows; ++i) {
    if (f[i] == 0) continue;
    for (decltype(J)::InnerIterator it(J, i); it; ++it) (*velocity)[it.col()] += it.value() * f[i];
  }
  velocity->array() *= inverse_mass.array();
  LawSums<double> sums(std::sqrt(tolerance));
  for (Index i = 0; i < arrays.rows; ++i) {
    double diagonal = 0;
    double sum = 0;
    for (decltype(J)::InnerIterator it(J, i); it; ++it) {
      diagonal += inverse_mass[it.col()] * (it.value() * it.value());
      sum += it.value() * (*velocity)[it.col()];
    }
    const double b = arrays.b[At(i)];
    const bool is_joint = !arrays.bilateral.empty() && arrays.bilateral[At(i)] != 0;
    // (|A| |f|)_i is at least that.
    const double magnitude = std::max(std::abs(sum), diagonal * std::abs(f[i])) + std::abs(b);
    sums.Add(diagonal, b, sum + b, f[i], is_joint, magnitude);
  }
  double rho = 0;
  if (sums.Judge(tolerance, 0, &rho) == LawSums<double>::Known::kRight) return true;
  return rho <= tolerance && Passes(LcpProblem::FromArrays(arrays), tolerance, f);
}

}  // namespace

double TimeCheck(const LcpProblem& problem, const Eigen::VectorXd& f) {
  constexpr double kTolerance = 1e-6;
  constexpr int kRuns = 5;
  const ProblemArrays arrays = ProblemArrays::Of(problem);
  Eigen::VectorXd velocity;
  Stopwatch watch;
  std::vector<double> times;
  for (int run = 0; run < kRuns; ++run) {
    watch.Start();
    const volatile bool passes = Passes(arrays, kTolerance, f, &velocity);
    times.push_back(watch.Seconds());
    static_cast<void>(passes);
  }
  return MedianOf(std::move(times));
}

Eigen::VectorXi BodySystem::Expand(const Eigen::VectorXi& order_of_bodies) const {
  Eigen::VectorXi order(lower.cols());
  Index next = 0;
  for (const int body : order_of_bodies) {
    for (int k = first[At(body)]; k < first[At(body) + 1]; ++k) order[next++] = k;
  }
  return order;
}

BodySystem MakeBodySystem(const LcpProblem& problem, const std::vector<Index>& rows) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const ColumnMatrix J = Picking(rows, problem.size()) * ColumnMatrix(problem.J());
  BodySystem system;
  system.first = {0};
  std::vector<Index> body_of;  // of each unknown
  for (Index begin = 0; begin < J.cols(); begin += kPerBody) {
    std::vector<Index> movable;
    bool takes_part = false;
    for (Index column = begin; column < begin + kPerBody; ++column) {
      if (inverse_mass[column] == 0) continue;
      movable.push_back(column);
      for (ColumnMatrix::InnerIterator it(J, column); it; ++it) takes_part = takes_part || it.value() != 0;
    }
    if (!takes_part) continue;
    body_of.insert(body_of.end(), movable.size(), system.bodies());
    system.column_of.insert(system.column_of.end(), movable.begin(), movable.end());
    system.first.push_back(static_cast<int>(body_of.size()));
  }

  Eigen::VectorXd root_stiffness(J.rows());
  for (Index k = 0; k < J.rows(); ++k) {
    const double diagonal = std::max(problem.DiagonalA()[rows[At(k)]], std::numeric_limits<double>::min());
    root_stiffness[k] = std::sqrt(kStiffness / diagonal);
  }
  const ColumnMatrix columns = Picking(system.column_of, J.cols());
  const ColumnMatrix root = root_stiffness.asDiagonal() * (J * columns.transpose());
  const ColumnMatrix stiffness = root.transpose() * root;
  const ColumnMatrix mass = columns * inverse_mass.cwiseInverse().asDiagonal() * columns.transpose();
  system.lower = ColumnMatrix(stiffness + mass).triangularView<Eigen::Lower>();
  const ColumnMatrix incidence = root.cwiseAbs() * Picking(body_of, system.bodies());
  system.graph = incidence.transpose() * incidence;
  return system;
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
    if (pivot > kDependent * diagonal[k]) independent.push_back(rows[At(k)]);
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
