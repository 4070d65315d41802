#pragma once

#include <cmath>

#include "model/geometry/vec2.h"

namespace lcpbench {

/// An unevaluated sum hi + lo of two doubles, |lo| <= ulp(hi)/2: about 32 decimal digits from + - * / sqrt of doubles
/// alone, so the same bits on every machine. It evaluates what cancels: the residuals of closest points, and gaps that
/// are differences of large radii. Products are split without fused multiply-add, so magnitudes must stay below about
/// 1e145 (squares are taken); beyond, results are NaN or infinite, never merely wrong. Needs -ffp-contract=off.
/// [Dekker 1971; Hida, Li, Bailey 2001]
struct DoubleDouble {
  double hi = 0;
  double lo = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double value) : hi(value) {}  // NOLINT(google-explicit-constructor): an exact conversion
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
};

/// a + b, given |a| >= |b|.
constexpr DoubleDouble FastTwoSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a + b without rounding error.
constexpr DoubleDouble TwoSum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a b without rounding error.
constexpr DoubleDouble TwoProduct(double a, double b) {
  constexpr double kSplitter = 0x1p27 + 1;  // halves of 26 bits, whose products are exact
  const double a_scaled = kSplitter * a;
  const double b_scaled = kSplitter * b;
  const double a_hi = a_scaled - (a_scaled - a);
  const double b_hi = b_scaled - (b_scaled - b);
  const double a_lo = a - a_hi;
  const double b_lo = b - b_hi;
  const double product = a * b;
  return {product, ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}

constexpr DoubleDouble operator-(DoubleDouble a) { return {-a.hi, -a.lo}; }

constexpr DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble high = TwoSum(a.hi, b.hi);
  const DoubleDouble low = TwoSum(a.lo, b.lo);
  const DoubleDouble sum = FastTwoSum(high.hi, high.lo + low.hi);
  return FastTwoSum(sum.hi, sum.lo + low.lo);
}

constexpr DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + -b; }

constexpr DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble product = TwoProduct(a.hi, b.hi);
  return FastTwoSum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

constexpr DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
  const double first = a.hi / b.hi;
  const DoubleDouble remainder = a - first * b;
  const double second = remainder.hi / b.hi;
  const double third = (remainder - second * b).hi / b.hi;
  return FastTwoSum(first, second) + third;
}

constexpr bool operator<(DoubleDouble a, DoubleDouble b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }
constexpr bool operator>(DoubleDouble a, DoubleDouble b) { return b < a; }
constexpr bool operator==(DoubleDouble a, DoubleDouble b) { return a.hi == b.hi && a.lo == b.lo; }

/// One Newton step from the double root doubles its digits.
inline DoubleDouble SquareRoot(DoubleDouble a) {
  if (!(a.hi > 0)) return std::sqrt(a.hi);
  const double root = std::sqrt(a.hi);
  return FastTwoSum(root, (a - TwoProduct(root, root)).hi / (2 * root));
}

constexpr DoubleDouble Absolute(DoubleDouble a) { return a.hi < 0 ? -a : a; }
inline double Absolute(double a) { return std::abs(a); }

/// To the nearest double.
constexpr double ToDouble(DoubleDouble a) { return a.hi; }
constexpr double ToDouble(double a) { return a; }

template <class T>
constexpr VecOf<T> Lift(Vec2 a) {
  return {T(a.x), T(a.y)};
}
template <class T>
constexpr Vec2 ToVec2(VecOf<T> a) {
  return {ToDouble(a.x), ToDouble(a.y)};
}

/// (cos, sin) of a rotation. In DoubleDouble made a unit vector to all its digits: what is left of the rounding of cos
/// and sin is a turn by about 1e-16, which no length multiplies into a change of size.
template <class T>
VecOf<T> LiftRotation(Rotation r) {
  const VecOf<T> turn = {r.cos, r.sin};
  return std::is_same_v<T, double> ? turn : Unit(turn);
}

/// To 32 digits, by MPFR.
inline VecOf<DoubleDouble> ExactRotation(double theta) {
  const RotationParts parts = SinCosParts(theta);
  return {FastTwoSum(parts.high.cos, parts.low.cos), FastTwoSum(parts.high.sin, parts.low.sin)};
}

/// How the angles of a pair are placed in DoubleDouble: as unit vectors along their rounded cosine and sine, a turn by
/// 1e-16 away, or exactly.
enum class Angles { kRounded, kExact };

}  // namespace lcpbench
