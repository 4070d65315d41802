#pragma once

#include <cmath>
#include <limits>

namespace lcpbench {

/// Rounding of a gap that is summed over a row's two bodies and the rows of each, in parts of its sum of absolute
/// values.
template <typename Sum = double>
inline constexpr double kRoundingOfTwoBodies = 32 * static_cast<double>(std::numeric_limits<Sum>::epsilon());

/// rho (verify.h) of forces f with gaps w = A f + b, added up row by row; and, from the sums of absolute values that
/// the gaps are made of, what rounding can hide of it and whether every row's backward error is small. The one coding
/// of these in solvers/, but for the verifier, which stays apart so that it is independent, and for passes in vector
/// registers. What kernels of instruction sets call of it is inlined whatever the flags, and calls nothing that may not
/// be: see linear_algebra/vector_register.h.
/// @tparam Real  what is added up in
template <typename Real>
class ResidualSums {
 public:
  /// What is known of f in view of rounding.
  enum class Known { kRight, kUnclear, kWrong };

  ResidualSums() = default;
  /// @param row_limit  largest backward error that a row may have
  [[gnu::always_inline]] explicit ResidualSums(double row_limit) : row_limit_(row_limit) {}

  /// The natural residual of a row, in the unit of its gap; a gap that is NaN stays.
  /// @param force  A_ii f_i
  [[gnu::always_inline]] static Real Defect(Real gap, Real force, bool is_joint) {
    return is_joint || !(force < gap) ? gap : force;
  }

  /// @param d          |A_ii|; 0 counts as 1
  /// @param magnitude  (|A| |f| + |b|)_i, or a sum of more absolute values; without it only rho is known
  [[gnu::always_inline]] void Add(Real d, Real b, Real gap, Real f, bool is_joint, Real magnitude = 0) {
    const Real unit = d > 0 ? d : 1;
    const Real inverse = 1 / unit;
    const Real defect = Defect(gap, unit * f, is_joint);
    defects_ += defect * (defect * inverse);
    loads_ += b * (b * inverse);
    magnitudes_ += magnitude * (magnitude * inverse);
    const Real limit = row_limit_ * magnitude;
    meets_ &= (defect <= limit) & (-defect <= limit) & (is_joint | (f >= 0));
  }

  /// A row's backward error is too large.
  void RefuseRow() { meets_ = false; }
  /// Rounding of a row's gap may hide that its backward error is too large.
  [[gnu::always_inline]] void DoubtRow() { is_clear_ = false; }

  /// |D^-1/2 min(w, D f)|_2
  Real defect_norm() const { return std::sqrt(defects_); }
  /// rho (verify.h).
  Real rho() const { return std::sqrt(defects_ / (loads_ > 0 ? loads_ : 1)); }
  /// kRight: rho and what rounding hides of it are within the tolerance, and all rows meet their limit.
  /// @param roundings  bound of the rounding of a gap in parts of its magnitude
  /// @param rho        written
  [[gnu::always_inline]] Known Judge(double tolerance, double roundings, double* rho) const {
    const Real inverse = 1 / (loads_ > 0 ? loads_ : 1);
    const Real found = std::sqrt(defects_ * inverse);
    const Real rounding = roundings * std::sqrt(magnitudes_ * inverse);
    *rho = static_cast<double>(found);
    if (!(found <= tolerance && meets_)) return Known::kWrong;
    return is_clear_ && found + rounding <= tolerance ? Known::kRight : Known::kUnclear;
  }

 private:
  double row_limit_ = 0;
  Real defects_ = 0, loads_ = 0, magnitudes_ = 0;  // squares, over A_ii
  bool meets_ = true, is_clear_ = true;
};

}  // namespace lcpbench
