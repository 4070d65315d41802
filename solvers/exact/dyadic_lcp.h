#pragma once

#include <mpfr.h>

#include <boost/multiprecision/gmp.hpp>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Integers of any size: n stands for n 2^-bits, with the bits told beside it.
using BigInteger = boost::multiprecision::mpz_int;

/// value 2^bits, its fraction cut off.
BigInteger Scaled(double value, long bits);

/// The problem as its doubles say it, in integers: doubles are integers times powers of two, and so are products and
/// sums of them. A f + b is then evaluated without any rounding, in one pass over the given form. Internal to
/// solvers/exact/.
class DyadicLcp {
 public:
  /// @param problem  not owned; must outlive this. O(nnz of the given form)
  explicit DyadicLcp(const LcpProblem& problem);

  /// Bits of the diagonal of A.
  long matrix_bits() const { return matrix_bits_; }
  /// A_ii 2^matrix_bits.
  const BigInteger& diagonal(Index i) const { return diagonal_[static_cast<size_t>(i)]; }
  /// Forces must have as many bits as this or more, so that gaps have all those of b.
  long least_force_bits() const { return b_bits_ - matrix_bits_; }

  /// w = A f + b with matrix_bits() + force_bits bits.
  /// O(nnz of the given form) products of integers, some 0.1 us each
  void ComputeGaps(const std::vector<BigInteger>& f, long force_bits, std::vector<BigInteger>* w) const;

 private:
  const LcpProblem& problem_;
  std::vector<BigInteger> entries_;  // of J or A, in the order of storage
  std::vector<BigInteger> inverse_mass_;
  std::vector<BigInteger> diagonal_;
  std::vector<BigInteger> b_;
  long entry_bits_ = 0;
  long matrix_bits_ = 0;
  long b_bits_ = 0;
};

/// A sum, product, quotient or root of numbers >= 0 that is never below the exact one: every operation rounds up.
class UpperBound {
 public:
  /// number 2^-bits, number >= 0.
  UpperBound(const BigInteger& number, long bits);
  explicit UpperBound(double number);
  UpperBound(const UpperBound& other);
  UpperBound& operator=(const UpperBound& other);
  ~UpperBound();

  UpperBound& operator+=(const UpperBound& other);
  UpperBound& operator*=(const UpperBound& other);
  /// Divided by divisor 2^-bits > 0.
  void DivideBy(const BigInteger& divisor, long bits);
  void DivideBy(double divisor);
  void TakeRoot();
  /// Not below; infinite beyond the range of doubles.
  double ToDouble() const;
  /// Whether number 2^-bits is larger, for certain.
  bool IsBelow(const BigInteger& number, long bits) const;

 private:
  mpfr_t value_;
};

}  // namespace lcpbench
