#include "solvers/pivoting/least_norm.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/pivoting/dantzig.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// Rows with w = 0 to the accuracy of the answer: all of them together may take this part of the tolerance.
constexpr double kPartOfTolerance = 0.1;
// Forces up to this part of the largest one count as rounding.
constexpr double kPartOfSlack = 1e-12;

// D^-1/2 A D^-1/2, root = D^1/2.
Eigen::MatrixXd Scaled(const Eigen::MatrixXd& A, const Eigen::VectorXd& root) {
  return root.cwiseInverse().asDiagonal() * A * root.cwiseInverse().asDiagonal();
}

bool IsSemidefinite(const LcpProblem& problem, const Eigen::VectorXd& root, double rank_tolerance) {
  if (problem.facts().symmetric && problem.facts().positive_semidefinite) return true;
  if (!problem.IsNumericallySymmetric()) return false;
  if (problem.size() == 0) return true;
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Scaled(problem.DenseA(), root), Eigen::EigenvaluesOnly)
          .eigenvalues();
  return values[0] >= -rank_tolerance * values[values.size() - 1];
}

// The rows that may carry force.
std::vector<Index> ClosedRows(const LcpProblem& problem, const Metrics& metrics, const Eigen::VectorXd& f,
                              const Eigen::VectorXd& root, double tolerance) {
  const double limit = kPartOfTolerance * tolerance * problem.b().cwiseQuotient(root).norm() /
                       std::sqrt(static_cast<double>(std::max<Index>(problem.size(), 1)));
  std::vector<Index> closed;
  for (Index i = 0; i < problem.size(); ++i) {
    const bool is_closed = problem.is_bilateral(i) || f[i] > 0 || metrics.w[i] / root[i] <= limit;
    if (is_closed) closed.push_back(i);
  }
  return closed;
}

// On the closed rows of A: an orthonormal basis of the forces that move nothing, and given forces without their part
// in it.
struct FreeForces {
  FreeForces(const Eigen::MatrixXd& A, const Eigen::VectorXd& f, const Eigen::VectorXd& root, double rank_tolerance)
      : across(f) {
    const Index n = A.rows();
    if (n == 0) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Scaled(A, root));
    const double least = rank_tolerance * eigen.eigenvalues()[n - 1];
    const Index nullity = (eigen.eigenvalues().array() <= least).count();
    basis.resize(n, nullity);
    if (nullity == 0) return;
    const Eigen::MatrixXd spanning = root.cwiseInverse().asDiagonal() * eigen.eigenvectors().leftCols(nullity);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(spanning);
    basis = qr.householderQ() * Eigen::MatrixXd::Identity(n, nullity);
    across -= basis * (basis.transpose() * f);
  }
  Eigen::MatrixXd basis;
  Eigen::VectorXd across;
};

}  // namespace

LeastNormForces FindLeastNormForces(const LcpProblem& problem, const Eigen::VectorXd& f,
                                    const LeastNormOptions& options) {
  const Index n = problem.size();
  if (f.size() != n) {
    throw InputError("least norm: expected " + std::to_string(n) + " forces, found " + std::to_string(f.size()));
  }
  if (!(options.rank_tolerance > 0 && options.rank_tolerance < 1)) {
    throw InputError("least norm: expected a rank tolerance in (0, 1), found " + NumberText(options.rank_tolerance));
  }
  LeastNormForces answer;
  answer.f = f;
  answer.rank_tolerance = options.rank_tolerance;
  const auto refuse = [&](LcpStatus status, const std::string& why) {
    answer.status = status;
    answer.detail = why;
    return answer;
  };
  if (!problem.is_plain()) return refuse(LcpStatus::kUnsupported, "least norm is for plain problems");
  if (n > kMostRowsOfLeastNorm) {
    return refuse(LcpStatus::kUnsupported, "least norm is for up to " + std::to_string(kMostRowsOfLeastNorm) + " rows");
  }
  const Eigen::VectorXd root = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 1.0; });
  if (!IsSemidefinite(problem, root, options.rank_tolerance)) {
    return refuse(LcpStatus::kUnsupported, "A is not symmetric positive semidefinite");
  }
  const Metrics metrics = ComputeMetrics(problem, f);
  if (!PassesTier(metrics, options.tolerance)) {
    return refuse(LcpStatus::kNumericalFailure, "the given f does not pass " + NumberText(options.tolerance));
  }
  const std::vector<Index> closed = ClosedRows(problem, metrics, f, root, options.tolerance);
  const FreeForces free(problem.DenseA()(closed, closed), f(closed), root(closed), options.rank_tolerance);
  answer.nullity = free.basis.cols();
  Eigen::VectorXd g = free.across;

  std::vector<Index> contacts;  // among the closed rows
  for (size_t k = 0; k < closed.size(); ++k) {
    if (!problem.is_bilateral(closed[k])) contacts.push_back(static_cast<Index>(k));
  }
  if (answer.nullity > 0 && !contacts.empty()) {
    const Eigen::MatrixXd basis = free.basis(contacts, Eigen::all);
    MatrixFacts psd;
    psd.symmetric = psd.positive_semidefinite = true;
    // Forces may be negative by as much as rounding: a set without an inner point would have none in doubles.
    const double slack = kPartOfSlack * f.lpNorm<Eigen::Infinity>();
    const LcpProblem signs = LcpProblem::FromDense(problem.id(), basis * basis.transpose(),
                                                   Eigen::VectorXd(g(contacts).array() + slack), {}, psd);
    LcpOptions limits{.tolerance = options.tolerance, .time_limit_s = options.time_limit_s};
    LcpResult result;
    DantzigSolver().Solve(signs, limits, &result);
    if (result.status != LcpStatus::kSolved) {
      return refuse(result.status, "the forces' signs were not found: " + result.detail);
    }
    g += free.basis * (basis.transpose() * result.f);
  }
  Eigen::VectorXd least = Eigen::VectorXd::Zero(n);
  const double none = n > 0 ? 10 * kPartOfSlack * f.lpNorm<Eigen::Infinity>() : 0;
  for (size_t k = 0; k < closed.size(); ++k) {
    const double force = g[static_cast<Index>(k)];
    // What is no more than the slack counts as none: a row without any force around it has no other scale.
    least[closed[k]] = problem.is_bilateral(closed[k]) || force > none ? force : 0.0;
  }
  if (!PassesTier(ComputeMetrics(problem, least), options.tolerance)) {
    return refuse(LcpStatus::kNumericalFailure,
                  "the forces of least norm do not pass " + NumberText(options.tolerance) + " at this rank tolerance");
  }
  answer.f = std::move(least);
  answer.status = LcpStatus::kSolved;
  return answer;
}

std::optional<LeastNormForces> TakeLeastNorm(const LcpProblem& problem, const LeastNormOptions& options,
                                             LcpResult* result) {
  if (result->status != LcpStatus::kSolved) return std::nullopt;
  LeastNormForces found = FindLeastNormForces(problem, result->f, options);
  if (found.status != LcpStatus::kSolved) {
    result->detail += (result->detail.empty() ? "" : "; ") + ("not of least norm: " + found.detail);
    return std::nullopt;
  }
  result->f = found.f;
  return found;
}

}  // namespace lcpbench
