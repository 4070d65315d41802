#pragma once

#include <vector>

#include "solvers/exact/independent_block.h"
#include "solvers/exact/rational.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Integers stand for numbers of 2^-bits, with the number of bits beside them: value 2^bits, its fraction cut off.
BigInteger Scaled(double value, long bits);

/// number 2^-bits as a double, nearly.
double ToDouble(const BigInteger& number, long bits);

/// The exponent that frexp finds.
long FrexpExponent(double value);

/// D_ii^1/2, 1 where A_ii = 0.
double RootOfDiagonal(const LcpProblem& problem, Index i);

/// The problem, taken as its doubles, in integers: doubles are integers times powers of two, and so are products and
/// sums of them. A f + b is then evaluated without any rounding, in one pass over the given form. Internal to
/// solvers/exact/.
class DyadicLcp {
 public:
  /// @param problem  not owned; must outlive this. O(nnz of the given form)
  explicit DyadicLcp(const LcpProblem& problem);

  /// Bits of the diagonal of A.
  long matrix_bits() const { return matrix_bits_; }
  /// A_ii 2^matrix_bits.
  const BigInteger& diagonal(Index i) const { return diagonal_[At(i)]; }
  /// Forces must have as many bits as this or more, so that gaps have all those of b.
  long least_force_bits() const { return b_bits_ - matrix_bits_; }

  /// w = A f + b with matrix_bits() + force_bits bits.
  /// O(nnz of the given form) products of integers, some 0.1 us each
  void ComputeGaps(const std::vector<BigInteger>& f, long force_bits, std::vector<BigInteger>* w) const;

  /// |D^-1/2 d|_2 rounded up, D = diag A with 1 where that is 0, for d in units of 2^-bits.
  double ScaledNorm(const std::vector<BigInteger>& d, long bits) const;

 private:
  const LcpProblem& problem_;
  const SparseMatrix& given_;        // J or A
  std::vector<BigInteger> entries_;  // of it, in the order of storage
  std::vector<BigInteger> inverse_mass_;
  std::vector<BigInteger> diagonal_;
  std::vector<BigInteger> b_;
  long matrix_bits_ = 0;
  long b_bits_ = 0;
};

/// A double that is not below; infinite beyond the range of doubles.
double RoundUp(const Rational& value);
/// Not below the root of square >= 0.
double RootUp(const Rational& square);

/// The digits of forces and gaps, and what they are measured by. Internal to solvers/exact/.
struct DyadicScale {
  long force_bits = 0;     ///< forces are integers times 2^-force_bits
  long load_exponent = 0;  ///< |D^-1/2 b|_inf is below 2^load_exponent, and not far
};

/// w = `target` on the rows of the factor, by iterative refinement: residuals without rounding, changes in doubles.
/// Until |D^-1/2 (w - target)|_inf <= 2^(load_exponent - goal_bits), or refinements gain nothing any more.
/// @param target  one integer per row of the factor, digits as of w; empty for zeros
/// @param w       of the f that is left
/// @return the number of refinements
int RefineForces(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale,
                 const ProximalFactor& factor, const std::vector<BigInteger>& target, long goal_bits,
                 const Deadline& deadline, std::vector<BigInteger>* f, std::vector<BigInteger>* w);

}  // namespace lcpbench
