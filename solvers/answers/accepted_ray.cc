#include "solvers/answers/accepted_ray.h"

#include <algorithm>
#include <cmath>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// Entries of D^1/2 y below this part of the largest may be rounding of zeros.
constexpr double kNoise = 1e-12;
// A ray is multiplied by these, then its entries are cut to so many bits.
constexpr double kMultiples[] = {1, 3, 5, 7};
constexpr int kFewBits = 20;

double WithFewBits(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, kFewBits)), exponent - kFewBits);
}

}  // namespace

std::optional<Eigen::VectorXd> AcceptedRay(const LcpProblem& problem, const Eigen::VectorXd& direction) {
  Eigen::VectorXd ray = direction;
  FarkasVerdict verdict = VerifyFarkasRay(problem, ray);
  if (!verdict.accepted) {
    const Eigen::ArrayXd size = problem.DiagonalA().cwiseAbs().cwiseSqrt().cwiseProduct(ray).array().abs();
    ray = (size < kNoise * size.maxCoeff()).select(0.0, ray.array());
    verdict = VerifyFarkasRay(problem, ray);
    if (!verdict.accepted) return std::nullopt;
  }
  if (verdict.proved) return ray;
  for (const double multiple : kMultiples) {
    Eigen::VectorXd short_ray = ray.unaryExpr([&](double y) { return WithFewBits(multiple * y); });
    if (VerifyFarkasRay(problem, short_ray).proved) return short_ray;
  }
  return ray;
}

}  // namespace lcpbench
