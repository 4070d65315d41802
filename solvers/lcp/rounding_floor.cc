#include "solvers/lcp/rounding_floor.h"

#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

constexpr double kUnitRoundoff = 0x1p-53;

// |A| |f|, or from factors its bound.
Eigen::VectorXd Magnitude(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd absolute = f.cwiseAbs();
  switch (problem.given_form()) {
    case MatrixForm::kDense:
      return problem.DenseA().cwiseAbs() * absolute;
    case MatrixForm::kSparse:
      return problem.SparseA().cwiseAbs() * absolute;
    case MatrixForm::kFactors:
      break;
  }
  const SparseMatrix& J = problem.J();
  Eigen::VectorXd body = Eigen::VectorXd::Zero(J.cols());
  for (Index i = 0; i < J.rows(); ++i) {
    if (absolute[i] == 0) continue;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) body[it.col()] += std::abs(it.value()) * absolute[i];
  }
  body.array() *= problem.inverse_mass().array();
  Eigen::VectorXd magnitude = Eigen::VectorXd::Zero(J.rows());
  for (Index i = 0; i < J.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) magnitude[i] += std::abs(it.value()) * body[it.col()];
  }
  return magnitude;
}

}  // namespace

double RoundingFloor(const LcpProblem& problem, const Eigen::VectorXd& f) {
  if (f.size() != problem.size() || !f.allFinite()) return std::numeric_limits<double>::infinity();
  if (f.size() == 0) return 0;
  const Eigen::VectorXd root =
      problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1 : std::sqrt(std::abs(d)); });
  const Eigen::VectorXd scaled_change = Magnitude(problem, f).cwiseQuotient(root);
  const Eigen::VectorXd scaled_b = problem.b().cwiseQuotient(root);
  // stableNorm: squares of what units make large or small stay within range. Of vectors: copies that Eigen 3.4 makes of
  // expressions on the way fail its own assertion on alignment.
  const double change = kUnitRoundoff * scaled_change.stableNorm();
  const double b = scaled_b.stableNorm();
  return b == 0 ? change : change / b;
}

}  // namespace lcpbench
