#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "solvers/lcp/problem.h"

/// Internal to solvers/: the laws of all rows in one form. A force stands in a range [lower, upper]: w > 0 needs f =
/// lower, w < 0 needs f = upper, between them w = 0. Unilateral rows have [0, inf), bilateral ones (-inf, inf), bounded
/// rows their bounds, friction rows [-mu f_n, mu f_n], sliding rows -s mu f_n at both ends. Residual, sides and sums
/// follow from ranges alone [docs/friction.md section 4]. What kernels of instruction sets call of it is inlined
/// whatever the flags, and calls nothing that may not be: see linear_algebra/vector_register.h.
namespace lcpbench {

/// Where a row stands on the graph of its law: its force at an end of the range, or inside, where it is an unknown and
/// the gap is 0.
enum class RangeSide : signed char { kLower = -1, kInside = 0, kUpper = 1 };

/// The range of a bilateral row. Ranges have types, so that no infinite end is compared, and no point has an inside.
struct LineRange {};
/// The range of a unilateral row.
struct HalfLineRange {};
/// The range of a sliding row.
struct PointRange {
  double force;  ///< the only one
};
/// The range of a friction row, and of a bounded row.
struct IntervalRange {
  double lower;  ///< may be -infinity
  double upper;  ///< >= lower, may be infinity
};

/// The natural residual of a row, D f - clamp(D f - w), without that sum, in which a large force rounds the gap away. A
/// gap that is NaN stays. `force` is D f, in the unit of the range.
[[gnu::always_inline]] inline double ResidualOf(LineRange /*range*/, double /*force*/, double gap) { return gap; }
/// The same.
[[gnu::always_inline]] inline double ResidualOf(HalfLineRange /*range*/, double force, double gap) {
  return !(force < gap) ? gap : force;
}
/// The same.
[[gnu::always_inline]] inline double ResidualOf(PointRange range, double force, double /*gap*/) {
  return force - range.force;
}
/// The same.
[[gnu::always_inline]] inline double ResidualOf(IntervalRange range, double force, double gap) {
  const double from_lower = force - range.lower, from_upper = force - range.upper;
  const double below = from_lower < gap ? from_lower : gap;
  return from_upper > below ? from_upper : below;
}

/// The side of D f - w [Alart, Curnier 1991]; of a range without an inside always the same.
inline RangeSide SideOf(LineRange /*range*/, double /*trial*/) { return RangeSide::kInside; }
/// The same.
inline RangeSide SideOf(HalfLineRange /*range*/, double trial) {
  return static_cast<RangeSide>(static_cast<int>(trial > 0) - 1);
}
/// The same.
inline RangeSide SideOf(PointRange /*range*/, double /*trial*/) { return RangeSide::kLower; }
/// The same. Without a branch: sides are hard to predict.
inline RangeSide SideOf(IntervalRange range, double trial) {
  const int is_wide = static_cast<int>(range.lower < range.upper);
  const int is_above = is_wide & static_cast<int>(trial > range.upper);
  return static_cast<RangeSide>(is_above - ((1 - is_wide) | static_cast<int>(trial < range.lower)));
}

/// By how much a gap is wrong where the force is within its range to the last bit; <= 0: right.
[[gnu::always_inline]] inline double GapDefect(double gap, bool is_at_lower, bool is_at_upper) {
  const double inside = std::abs(gap);
  const double lower = is_at_lower ? std::min(inside, -gap) : inside;
  return is_at_upper ? std::min(lower, gap) : lower;
}

/// f_t / f_n of a friction or sliding row that is not inside its range.
inline double SlopeOf(const FrictionRow& row, RangeSide side) {
  return (row.slip != 0 ? -row.slip : static_cast<signed char>(side)) * row.mu;
}
/// Whether the two directions of slip of a row differ.
inline bool CanStick(const FrictionRow& row) { return row.mu > 0 && row.slip == 0; }

/// The rows of a problem, law by law. Units are those of the lists: the problem's, or scaled.
struct Laws {
  std::span<const Index> joints;          ///< bilateral rows
  std::span<const Index> normals;         ///< unilateral rows
  std::span<const FrictionRow> friction;  ///< friction and sliding rows, by their normal rows
  std::span<const BoundedRow> bounded;    ///< bounded rows

  /// visit(row, range) of the friction and bounded rows at forces of their normal rows.
  template <typename Force, typename Visit>
  void VisitOthers(const Force& force, const Visit& visit) const {
    for (const FrictionRow& row : friction) {
      if (!CanStick(row)) {
        visit(row.row, PointRange{SlopeOf(row, RangeSide::kLower) * force[row.normal]});
        continue;
      }
      const double most = row.mu * std::max(force[row.normal], 0.0);
      visit(row.row, IntervalRange{-most, most});
    }
    for (const BoundedRow& row : bounded) visit(row.row, IntervalRange{row.lower, row.upper});
  }
  /// The same of all rows.
  template <typename Force, typename Visit>
  void VisitRanges(const Force& force, const Visit& visit) const {
    for (const Index row : joints) visit(row, LineRange{});
    for (const Index row : normals) visit(row, HalfLineRange{});
    VisitOthers(force, visit);
  }
};

/// Numbers of verdicts in problems that are not plain.
namespace law {
/// As the verifier's: forces up to this part of a contact's loads are rounding.
inline constexpr double kPartOfLoad = 0x1p-46;
/// As the verifier's: rho is relative to no less than this part of all loads.
inline constexpr double kLeastScale = 0x1p-20;
/// Roundings of a sum over a row, beside one for each term.
inline constexpr double kTermsBesideRows = 64;

/// x x
inline double Square(double x) { return x * x; }

/// S of the loads of unilateral, bilateral and bounded rows, of friction rows as far as friction answers them, and of
/// all, each summed up in squares.
inline double Scale(double plain, double answered, double all) {
  const double scale = std::max(std::sqrt(plain + answered), kLeastScale * std::sqrt(all));
  return scale == 0 ? 1 : scale;
}
}  // namespace law

/// Rounding of a gap that is summed over a row's two bodies and the rows of each, in parts of its sum of absolute
/// values.
template <typename Sum = double>
inline constexpr double kRoundingOfTwoBodies = 32 * static_cast<double>(std::numeric_limits<Sum>::epsilon());

/// rho (verify.h) of forces f with gaps w = A f + b, added up row by row; and, from the sums of absolute values that
/// the gaps are made of, what rounding can hide of it and whether every row's backward error is small. The one coding
/// of these in solvers/, but for the verifier, which stays apart so that it is independent, and for passes in vector
/// registers.
/// @tparam Real  what is added up in
template <typename Real>
class LawSums {
 public:
  /// What is known of f in view of rounding.
  enum class Known { kRight, kUnclear, kWrong };

  LawSums() = default;
  /// @param row_limit  largest backward error that a row may have
  [[gnu::always_inline]] explicit LawSums(double row_limit) : row_limit_(row_limit) {}

  /// The natural residual of a plain row, in the unit of its gap; a gap that is NaN stays.
  /// @param force  A_ii f_i
  [[gnu::always_inline]] static Real Defect(Real gap, Real force, bool is_joint) {
    return is_joint || !(force < gap) ? gap : force;
  }

  /// A plain row in the problem's units.
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
  /// The residual of a row in scaled variables.
  [[gnu::always_inline]] void AddResidual(Real residual) { defects_ += residual * residual; }
  /// Adds what rounding may hide of the gap of such a row.
  [[gnu::always_inline]] void AddHidden(Real hidden) { magnitudes_ += hidden * hidden; }
  /// The same of one whose gap is wrong by `defect` (GapDefect).
  /// @param magnitude  (|A| |f| + |b|)_i
  [[gnu::always_inline]] void AddHidden(Real hidden, Real defect, Real magnitude) {
    AddHidden(hidden);
    meets_ &= defect + hidden <= row_limit_ * magnitude;
    may_meet_ &= defect - hidden <= row_limit_ * magnitude;
  }

  /// A row's backward error is too large.
  void RefuseRow() { meets_ = false; }
  /// Rounding of a row's gap may hide that its backward error is too large.
  [[gnu::always_inline]] void DoubtRow() { is_clear_ = false; }

  /// |D^-1/2 min(w, D f)|_2, or the norm of all residuals.
  Real norm() const { return std::sqrt(defects_); }
  /// rho (verify.h) of plain rows.
  Real rho() const { return std::sqrt(defects_ / (loads_ > 0 ? loads_ : 1)); }
  /// Judges plain rows. kRight: rho and what rounding hides of it are within the tolerance, and all rows meet their
  /// limit.
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
  /// Judges scaled rows: whether rho and all that rounding may hide of it are within the tolerance, and of each row.
  /// @param scale  S
  bool AreSurelyRight(double tolerance, double scale) const {
    return meets_ && norm() / scale + std::sqrt(magnitudes_) / scale <= tolerance;
  }
  /// The same: whether rho without all that rounding may hide of it, or a row, is beyond its limit.
  bool AreSurelyWrong(double tolerance, double scale) const {
    return !may_meet_ || !(norm() / scale - std::sqrt(magnitudes_) / scale <= tolerance);
  }

 private:
  double row_limit_ = 0;
  Real defects_ = 0, loads_ = 0, magnitudes_ = 0;  // squares, over A_ii
  bool meets_ = true, may_meet_ = true, is_clear_ = true;
};

}  // namespace lcpbench
