#include "solvers/exact/dyadic_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

constexpr int kMostRefinements = 60;
// A refinement that gains less than a factor of this has come to its end.
constexpr double kLeastGain = 2;

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

double ToDouble(const BigInteger& number, long bits) {
  long exponent = 0;
  const double mantissa = mpz_get_d_2exp(&exponent, number.backend().data());
  return std::ldexp(mantissa, static_cast<int>(exponent - bits));
}

long Exponent(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent;
}

double RootOfDiagonal(const LcpProblem& problem, Index i) {
  const double diagonal = problem.DiagonalA()[i];
  return diagonal > 0 ? std::sqrt(diagonal) : 1;
}

int RefineForces(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale,
                 const ProximalFactor& factor, const std::vector<BigInteger>& target, long goal_bits,
                 const Deadline& deadline, std::vector<BigInteger>* f, std::vector<BigInteger>* w) {
  const std::vector<Index>& rows = factor.rows();
  const long gap_bits = lcp.matrix_bits() + scale.force_bits;
  double before = std::numeric_limits<double>::infinity();
  long unit = scale.load_exponent;  // residuals are scaled by 2^-unit, so that doubles hold them
  Eigen::VectorXd residual(static_cast<Index>(rows.size()));
  int step = 0;
  for (;; ++step) {
    lcp.ComputeGaps(*f, scale.force_bits, w);
    double largest = 0;
    for (Index k = 0; k < residual.size(); ++k) {
      const Index i = rows[At(k)];
      const BigInteger& gap = (*w)[At(i)];
      residual[k] = target.empty() ? ToDouble(gap, gap_bits + unit) : ToDouble(gap - target[At(k)], gap_bits + unit);
      largest = std::max(largest, std::abs(residual[k]) / RootOfDiagonal(problem, i));
    }
    const double size = std::ldexp(largest, static_cast<int>(unit - scale.load_exponent));
    if (!(size > std::ldexp(1.0, static_cast<int>(-goal_bits))) || !(size * kLeastGain <= before)) return step;
    if (step >= kMostRefinements || deadline.Expired()) return step;
    before = size;
    const Eigen::VectorXd change = factor.Solve(residual);
    if (!change.allFinite()) return step;
    for (Index k = 0; k < change.size(); ++k) (*f)[At(rows[At(k)])] -= Scaled(change[k], scale.force_bits + unit);
    // The next residual is smaller by some digits; ldexp keeps far smaller ones as well.
    unit += Exponent(largest);
  }
}

}  // namespace lcpbench
