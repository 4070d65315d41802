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
  const SparseMatrix J = problem.J().cwiseAbs();
  return J * problem.inverse_mass().cwiseProduct(J.transpose() * absolute);
}

// |x|_2, of which units may make the squares too large or small for doubles. Eigen's own stableNorm ends on an
// assertion about the alignment of its copies where that is 64 bytes and vectors are narrower.
double NormInRange(const Eigen::VectorXd& x) {
  const double largest = x.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest)) return largest;
  return largest * (x / largest).norm();
}

}  // namespace

double RoundingFloor(const LcpProblem& problem, const Eigen::VectorXd& f) {
  if (f.size() != problem.size() || !f.allFinite()) return std::numeric_limits<double>::infinity();
  if (f.size() == 0) return 0;
  const Eigen::VectorXd root =
      problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1 : std::sqrt(std::abs(d)); });
  const double change = kUnitRoundoff * NormInRange(Magnitude(problem, f).cwiseQuotient(root));
  const double b = NormInRange(problem.b().cwiseQuotient(root));
  return b == 0 ? change : change / b;
}

}  // namespace lcpbench
