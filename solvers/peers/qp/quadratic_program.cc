#include "solvers/peers/qp/quadratic_program.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Columns = Eigen::SparseMatrix<double>;

// The columns of J that can move, and their masses.
void TakeFactors(const LcpProblem& problem, QuadraticProgram* qp) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const Index n = problem.size();
  std::vector<int> place(static_cast<std::size_t>(inverse_mass.size()), -1);
  std::vector<Index> kept;
  for (Index k = 0; k < inverse_mass.size(); ++k) {
    if (!(inverse_mass[k] > 0)) continue;
    place[static_cast<std::size_t>(k)] = static_cast<int>(kept.size());
    kept.push_back(k);
  }
  std::vector<Eigen::Triplet<double, int>> entries;
  entries.reserve(static_cast<std::size_t>(problem.J().nonZeros()));
  for (Index row = 0; row < n; ++row) {
    for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
      const int column = place[static_cast<std::size_t>(it.col())];
      if (column >= 0) entries.emplace_back(static_cast<int>(row), column, it.value());
    }
  }
  qp->C = Columns(n, static_cast<Index>(kept.size()));
  qp->C.setFromTriplets(entries.begin(), entries.end());
  qp->H = Eigen::VectorXd(inverse_mass(kept).cwiseInverse()).asDiagonal();
}

// A = (P^T L) D (P^T L)^T in the place of J M^-1 J^T; what D has of rounding is left out.
void FactorA(const LcpProblem& problem, QuadraticProgram* qp) {
  const Index n = problem.size();
  RequireDenseMatrices(n, 4);
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(problem.DenseA());
  const Eigen::VectorXd D = ldlt.vectorD();
  Eigen::MatrixXd L = ldlt.matrixL();
  L = (ldlt.transpositionsP().transpose() * L).eval();
  const double least = std::numeric_limits<double>::epsilon() * static_cast<double>(n) * D.cwiseAbs().maxCoeff();
  std::vector<Index> kept;
  for (Index k = 0; k < n; ++k) {
    if (D[k] > least) kept.push_back(k);
  }
  qp->H = Eigen::VectorXd(D(kept).cwiseInverse()).asDiagonal();
  qp->C = Eigen::MatrixXd(L(Eigen::all, kept)).sparseView();
}

QuadraticProgram MakePrimal(const LcpProblem& problem, const QpLayout& layout) {
  QuadraticProgram qp;
  qp.is_primal = true;
  if (problem.has_factors()) {
    TakeFactors(problem, &qp);
  } else {
    FactorA(problem, &qp);
  }
  if (layout.dense) {
    RequireDenseMatrices(std::max(qp.C.rows(), qp.C.cols()), 4);
    qp.dense_H = qp.H;
    qp.dense_C = qp.C;
    qp.H = {};
    qp.C = {};
  }
  return qp;
}

QuadraticProgram MakeDual(const LcpProblem& problem, const QpLayout& layout) {
  const Index n = problem.size();
  QuadraticProgram qp;
  qp.bounds_are_rows = layout.bounds_are_rows;
  if (layout.dense) {
    RequireDenseMatrices(n, 4);
    qp.dense_H = problem.DenseA();
  } else {
    RequireSparseMatrices(n, static_cast<double>(problem.SparseA().nonZeros()), 4);
    qp.H = problem.SparseA();
  }
  if (!layout.bounds_are_rows) return qp;
  const auto unilateral = n - static_cast<Index>(problem.bilateral_rows().size());
  Columns C(unilateral, n);
  C.reserve(Eigen::VectorXi::Constant(n, 1));
  for (Index row = 0, i = 0; row < n; ++row) {
    if (!problem.is_bilateral(row)) C.insert(i++, row) = 1;
  }
  C.makeCompressed();
  if (layout.dense) {
    qp.dense_C = C;
  } else {
    qp.C.swap(C);
  }
  return qp;
}

// What depends on b.
void SetB(const LcpProblem& problem, QuadraticProgram* qp) {
  const Index n = problem.size();
  qp->bilateral.assign(static_cast<std::size_t>(n), 0);
  for (const Index row : problem.bilateral_rows()) qp->bilateral[static_cast<std::size_t>(row)] = 1;
  if (qp->is_primal) {
    const Index columns = std::max(qp->H.cols(), qp->dense_H.cols());
    qp->g.setZero(columns);
    qp->x_lower.setConstant(columns, -kInfinity);
    qp->lower = -problem.b();
    qp->upper.setConstant(n, kInfinity);
    for (const Index row : problem.bilateral_rows()) qp->upper[row] = qp->lower[row];
    return;
  }
  qp->g = problem.b();
  qp->x_lower.setConstant(n, qp->bounds_are_rows ? -kInfinity : 0.0);
  const auto rows = qp->bounds_are_rows ? n - static_cast<Index>(problem.bilateral_rows().size()) : 0;
  for (const Index row : problem.bilateral_rows()) qp->x_lower[row] = -kInfinity;
  qp->lower.setZero(rows);
  qp->upper.setConstant(rows, kInfinity);
}

// The LCP's rows that have a bound, where the bounds are rows.
Eigen::VectorXd OfBounds(const QuadraticProgram& qp, const Eigen::VectorXd& of_rows) {
  Eigen::VectorXd kept(qp.rows());
  for (Index row = 0, i = 0; row < of_rows.size() && i < kept.size(); ++row) {
    if (qp.bilateral[static_cast<std::size_t>(row)] == 0) kept[i++] = of_rows[row];
  }
  return kept;
}

QpStart MakeStart(const LcpProblem& problem, const QuadraticProgram& qp, const Eigen::VectorXd& f) {
  QpStart start;
  if (qp.is_primal) {
    const bool dense = qp.dense_H.cols() > 0;
    const Eigen::VectorXd masses = dense ? Eigen::VectorXd(qp.dense_H.diagonal()) : Eigen::VectorXd(qp.H.diagonal());
    const Eigen::VectorXd impulse =
        dense ? Eigen::VectorXd(qp.dense_C.transpose() * f) : Eigen::VectorXd(qp.C.transpose() * f);
    start.x = impulse.cwiseQuotient(masses);
    start.y = f;
    start.bound_y.setZero(qp.variables());
    return start;
  }
  Eigen::VectorXd w(problem.size());
  problem.ComputeW(f, &w);
  w = w.cwiseMax(0);
  start.x = f;
  for (Index row = 0; row < f.size(); ++row) {
    if (problem.kind(row) != RowKind::kUnilateral) {
      w[row] = 0;
    } else {
      start.x[row] = std::max(0.0, f[row]);
      // Complementary, too: qpOASES never takes back a multiplier of a bound that does not hold its variable.
      if (start.x[row] > 0) w[row] = 0;
    }
  }
  start.y = OfBounds(qp, w);
  start.bound_y = w;
  return start;
}

bool HasTiers(std::string_view key) {
  return std::any_of(AllPeers().begin(), AllPeers().end(),
                     [key](const PeerEntry& peer) { return peer.key == key && peer.tiers.has_value(); });
}

}  // namespace

QpPeer::QpPeer(std::string_view key, SettingsReader* reader)
    : has_tiers_(HasTiers(key)),
      tier_(has_tiers_ || key.ends_with("-default") ? PeerTier(key, reader) : PeerTier()),
      is_primal_(key.find("-primal") != std::string_view::npos) {}

std::string QpPeer::WhyUnsupported(const LcpProblem& problem) const { return WhyNotQuadraticProgram(problem); }

void QpPeer::DoPrepare(const LcpProblem& problem) {
  prepared_ = is_primal_ ? MakePrimal(problem, layout_) : MakeDual(problem, layout_);
}

void QpPeer::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  QuadraticProgram& qp = prepared_;
  std::optional<QpStart> start;
  TimeConversion(options, result, [&] {
    SetB(problem, &qp);
    if (options.initial_f != nullptr) start = MakeStart(problem, qp, *options.initial_f);
  });
  if (qp.variables() == 0) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A = 0: the primal program has no variables";
    return;
  }
  Run(qp, start ? &*start : nullptr, options, deadline, result);
  if (result->status == LcpStatus::kIterationLimit && deadline.Expired()) result->status = LcpStatus::kTimeLimit;
}

void QpPeer::SetAnswer(const QuadraticProgram& qp, const double* x, const double* y, double sign,
                       LcpResult* result) const {
  const Index n = result->f.size();
  if (qp.is_primal) {
    result->f = sign * Eigen::Map<const Eigen::VectorXd>(y, n);
  } else {
    result->f = Eigen::Map<const Eigen::VectorXd>(x, n);
  }
}

void QpPeer::SetRay(const QuadraticProgram& qp, const double* x, const double* y, double sign,
                    LcpResult* result) const {
  LcpResult ray;
  ray.f.setZero(result->f.size());
  SetAnswer(qp, x, y, sign, &ray);
  if (ray.f.allFinite() && ray.f.cwiseAbs().maxCoeff() > 0) result->farkas_ray = ray.f;
}

}  // namespace lcpbench
