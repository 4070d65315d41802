#include "solvers/exact/dyadic_lcp.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lcpbench {
namespace {

constexpr int kDigits = std::numeric_limits<double>::digits;
// More than a double's: bounds shall not grow by their own rounding.
constexpr mpfr_prec_t kBoundBits = 96;

constexpr int kMostRefinements = 60;
// A refinement that gains less than a factor of this has come to its end.
constexpr double kLeastGain = 2;

// value = mantissa 2^exponent
struct Parts {
  std::int64_t mantissa;
  int exponent;
};

Parts Split(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(fraction, kDigits)), exponent - kDigits};
}

// The bits behind the point that all of the numbers need.
template <class Iterator>
long BitsOf(Iterator begin, Iterator end) {
  long bits = 0;
  for (; begin != end; ++begin) {
    if (*begin == 0) continue;
    const Parts parts = Split(*begin);
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(parts.mantissa));
    bits = std::max(bits, -static_cast<long>(parts.exponent) - zeros);
  }
  return bits;
}

std::vector<BigInteger> Scaled(const double* begin, Index count, long bits) {
  std::vector<BigInteger> scaled(At(count));
  for (Index i = 0; i < count; ++i) scaled[At(i)] = lcpbench::Scaled(begin[i], bits);
  return scaled;
}

}  // namespace

BigInteger Scaled(double value, long bits) {
  const Parts parts = Split(value);
  BigInteger scaled(parts.mantissa);
  const long shift = bits + parts.exponent;
  if (shift >= 0) {
    mpz_mul_2exp(scaled.backend().data(), scaled.backend().data(), static_cast<mp_bitcnt_t>(shift));
  } else {
    mpz_tdiv_q_2exp(scaled.backend().data(), scaled.backend().data(), static_cast<mp_bitcnt_t>(-shift));
  }
  return scaled;
}

DyadicLcp::DyadicLcp(const LcpProblem& problem) : problem_(problem) {
  const Index n = problem.size();
  const auto take = [this](const double* values, Index count) {
    entry_bits_ = BitsOf(values, values + count);
    entries_ = Scaled(values, count, entry_bits_);
  };
  diagonal_.resize(At(n));
  if (problem.has_factors()) {
    const SparseMatrix& J = problem.J();
    const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
    take(J.valuePtr(), J.nonZeros());
    const long mass_bits = BitsOf(inverse_mass.data(), inverse_mass.data() + inverse_mass.size());
    inverse_mass_ = Scaled(inverse_mass.data(), inverse_mass.size(), mass_bits);
    matrix_bits_ = 2 * entry_bits_ + mass_bits;
    for (Index i = 0; i < n; ++i) {
      for (Index k = J.outerIndexPtr()[i]; k < J.outerIndexPtr()[i + 1]; ++k) {
        diagonal_[At(i)] += entries_[At(k)] * entries_[At(k)] * inverse_mass_[At(J.innerIndexPtr()[k])];
      }
    }
  } else if (problem.given_form() == MatrixForm::kSparse) {
    const SparseMatrix& A = problem.SparseA();
    take(A.valuePtr(), A.nonZeros());
    matrix_bits_ = entry_bits_;
    for (Index i = 0; i < n; ++i) {
      for (Index k = A.outerIndexPtr()[i]; k < A.outerIndexPtr()[i + 1]; ++k) {
        if (A.innerIndexPtr()[k] == i) diagonal_[At(i)] = entries_[At(k)];
      }
    }
  } else {
    take(problem.DenseA().data(), n * n);
    matrix_bits_ = entry_bits_;
    for (Index i = 0; i < n; ++i) diagonal_[At(i)] = entries_[At(i * n + i)];
  }
  b_bits_ = BitsOf(problem.b().data(), problem.b().data() + n);
  b_ = Scaled(problem.b().data(), n, b_bits_);
}

void DyadicLcp::ComputeGaps(const std::vector<BigInteger>& f, long force_bits, std::vector<BigInteger>* w) const {
  const Index n = problem_.size();
  w->resize(At(n));
  const auto shift = static_cast<mp_bitcnt_t>(matrix_bits_ + force_bits - b_bits_);
  for (Index i = 0; i < n; ++i) mpz_mul_2exp((*w)[At(i)].backend().data(), b_[At(i)].backend().data(), shift);
  if (problem_.has_factors()) {
    const SparseMatrix& J = problem_.J();
    std::vector<BigInteger> moved(inverse_mass_.size());
    for (Index i = 0; i < n; ++i) {
      if (f[At(i)] == 0) continue;
      for (Index k = J.outerIndexPtr()[i]; k < J.outerIndexPtr()[i + 1]; ++k) {
        moved[At(J.innerIndexPtr()[k])] += entries_[At(k)] * f[At(i)];
      }
    }
    for (size_t k = 0; k < moved.size(); ++k) moved[k] *= inverse_mass_[k];
    for (Index i = 0; i < n; ++i) {
      for (Index k = J.outerIndexPtr()[i]; k < J.outerIndexPtr()[i + 1]; ++k) {
        (*w)[At(i)] += entries_[At(k)] * moved[At(J.innerIndexPtr()[k])];
      }
    }
  } else if (problem_.given_form() == MatrixForm::kSparse) {
    const SparseMatrix& A = problem_.SparseA();
    for (Index i = 0; i < n; ++i) {
      for (Index k = A.outerIndexPtr()[i]; k < A.outerIndexPtr()[i + 1]; ++k) {
        (*w)[At(i)] += entries_[At(k)] * f[At(A.innerIndexPtr()[k])];
      }
    }
  } else {
    for (Index j = 0; j < n; ++j) {
      if (f[At(j)] == 0) continue;
      for (Index i = 0; i < n; ++i) (*w)[At(i)] += entries_[At(j * n + i)] * f[At(j)];
    }
  }
}

UpperBound::UpperBound(const BigInteger& number, long bits) {
  mpfr_init2(value_, kBoundBits);
  mpfr_set_z_2exp(value_, number.backend().data(), -bits, MPFR_RNDU);
}
UpperBound::UpperBound(double number) {
  mpfr_init2(value_, kBoundBits);
  mpfr_set_d(value_, number, MPFR_RNDU);
}
UpperBound::UpperBound(const UpperBound& other) {
  mpfr_init2(value_, kBoundBits);
  mpfr_set(value_, other.value_, MPFR_RNDU);
}
UpperBound& UpperBound::operator=(const UpperBound& other) {
  mpfr_set(value_, other.value_, MPFR_RNDU);
  return *this;
}
UpperBound::~UpperBound() { mpfr_clear(value_); }

UpperBound& UpperBound::operator+=(const UpperBound& other) {
  mpfr_add(value_, value_, other.value_, MPFR_RNDU);
  return *this;
}
UpperBound& UpperBound::operator*=(const UpperBound& other) {
  mpfr_mul(value_, value_, other.value_, MPFR_RNDU);
  return *this;
}
void UpperBound::DivideBy(const BigInteger& divisor, long bits) {
  mpfr_t below;
  mpfr_init2(below, kBoundBits);
  mpfr_set_z_2exp(below, divisor.backend().data(), -bits, MPFR_RNDD);
  mpfr_div(value_, value_, below, MPFR_RNDU);
  mpfr_clear(below);
}
void UpperBound::DivideBy(double divisor) { mpfr_div_d(value_, value_, divisor, MPFR_RNDU); }
void UpperBound::TakeRoot() { mpfr_sqrt(value_, value_, MPFR_RNDU); }
double UpperBound::ToDouble() const { return mpfr_get_d(value_, MPFR_RNDU); }

bool UpperBound::IsBelow(const BigInteger& number, long bits) const {
  mpfr_t below;
  mpfr_init2(below, kBoundBits);
  mpfr_set_z_2exp(below, number.backend().data(), -bits, MPFR_RNDD);
  const bool is_below = mpfr_less_p(value_, below) != 0;
  mpfr_clear(below);
  return is_below;
}

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
