#include "solvers/exact/dyadic_lcp.h"

#include <mpfr.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

constexpr int kMostRefinements = 60;
// A refinement that gains less than a factor of this has come to its end.
constexpr double kLeastGainOfStep = 2;

// Quotients by diagonals, which are below 2^1024, and roots are rounded far below the digits of doubles.
constexpr long kBitsOfNorm = 1200;
constexpr mpfr_prec_t kBitsOfRoot = 100;

double RoundedUp(const Rational& value, bool takes_root) {
  mpfr_t rounded;
  mpfr_init2(rounded, kBitsOfRoot);
  mpfr_set_q(rounded, value.backend().data(), MPFR_RNDU);
  if (takes_root) mpfr_sqrt(rounded, rounded, MPFR_RNDU);
  const double result = mpfr_get_d(rounded, MPFR_RNDU);
  mpfr_clear(rounded);
  return result;
}

// The bits behind the point that all of the numbers need, and the numbers times 2^bits.
std::vector<BigInteger> AllScaled(const double* values, Index count, long* bits) {
  *bits = 0;
  for (Index i = 0; i < count; ++i) {
    *bits = std::max(*bits, static_cast<long>(msb(denominator(Rational(values[i])))));
  }
  std::vector<BigInteger> scaled(At(count));
  for (Index i = 0; i < count; ++i) scaled[At(i)] = Scaled(values[i], *bits);
  return scaled;
}

}  // namespace

BigInteger Scaled(double value, long bits) {
  const Rational scaled = Shifted(Rational(value), bits);
  return numerator(scaled) / denominator(scaled);
}

DyadicLcp::DyadicLcp(const LcpProblem& problem)
    : problem_(problem),
      given_(problem.has_factors() ? problem.J() : problem.SparseA()),
      diagonal_(At(problem.size())) {
  entries_ = AllScaled(given_.valuePtr(), given_.nonZeros(), &matrix_bits_);
  if (problem.has_factors()) {
    long mass_bits = 0;
    inverse_mass_ = AllScaled(problem.inverse_mass().data(), problem.inverse_mass().size(), &mass_bits);
    matrix_bits_ = 2 * matrix_bits_ + mass_bits;
  }
  for (Index i = 0; i < problem.size(); ++i) {
    for (Index k = given_.outerIndexPtr()[i]; k < given_.outerIndexPtr()[i + 1]; ++k) {
      const Index column = given_.innerIndexPtr()[k];
      if (problem.has_factors()) {
        diagonal_[At(i)] += entries_[At(k)] * entries_[At(k)] * inverse_mass_[At(column)];
      } else if (column == i) {
        diagonal_[At(i)] = entries_[At(k)];
      }
    }
  }
  b_ = AllScaled(problem.b().data(), problem.size(), &b_bits_);
}

void DyadicLcp::ComputeGaps(const std::vector<BigInteger>& f, long force_bits, std::vector<BigInteger>* w) const {
  const Index n = problem_.size();
  const int* const start = given_.outerIndexPtr();
  const int* const column = given_.innerIndexPtr();
  // M^-1 J^T f, from factors.
  std::vector<BigInteger> moved(inverse_mass_.size());
  for (Index i = 0; problem_.has_factors() && i < n; ++i) {
    if (f[At(i)] == 0) continue;
    for (Index k = start[i]; k < start[i + 1]; ++k) moved[At(column[k])] += entries_[At(k)] * f[At(i)];
  }
  for (size_t k = 0; k < moved.size(); ++k) moved[k] *= inverse_mass_[k];
  const std::vector<BigInteger>& factor = problem_.has_factors() ? moved : f;
  w->resize(At(n));
  const auto shift = static_cast<mp_bitcnt_t>(matrix_bits_ + force_bits - b_bits_);
  for (Index i = 0; i < n; ++i) {
    BigInteger& sum = (*w)[At(i)];
    mpz_mul_2exp(sum.backend().data(), b_[At(i)].backend().data(), shift);
    for (Index k = start[i]; k < start[i + 1]; ++k) sum += entries_[At(k)] * factor[At(column[k])];
  }
}

double DyadicLcp::ScaledNorm(const std::vector<BigInteger>& d, long bits) const {
  const BigInteger one = Scaled(1, matrix_bits_);
  BigInteger sum = 0;  // of squares rounded up to units of 2^-sum_bits
  const long sum_bits = 2 * bits + kBitsOfNorm;
  for (size_t i = 0; i < d.size(); ++i) {
    if (d[i] == 0) continue;
    const BigInteger& diagonal = diagonal_[i] > 0 ? diagonal_[i] : one;
    BigInteger square = d[i] * d[i];
    square <<= static_cast<unsigned>(matrix_bits_ + kBitsOfNorm);
    sum += (square + diagonal - 1) / diagonal;
  }
  return RootUp(Shifted(Rational(sum), -sum_bits));
}

double RoundUp(const Rational& value) { return RoundedUp(value, false); }
double RootUp(const Rational& square) { return RoundedUp(square, true); }

double ToDouble(const BigInteger& number, long bits) {
  long exponent = 0;
  const double mantissa = mpz_get_d_2exp(&exponent, number.backend().data());
  return std::ldexp(mantissa, static_cast<int>(exponent - bits));
}

long FrexpExponent(double value) {
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
    if (!(size > std::ldexp(1.0, static_cast<int>(-goal_bits))) || !(size * kLeastGainOfStep <= before)) return step;
    if (step >= kMostRefinements || deadline.Expired()) return step;
    before = size;
    const Eigen::VectorXd change = factor.Solve(residual);
    if (!change.allFinite()) return step;
    for (Index k = 0; k < change.size(); ++k) (*f)[At(rows[At(k)])] -= Scaled(change[k], scale.force_bits + unit);
    // The next residual is smaller by some digits; ldexp keeps far smaller ones as well.
    unit += FrexpExponent(largest);
  }
}

}  // namespace lcpbench
