#pragma once

#include <cmath>
#include <type_traits>

namespace lcpbench {

inline double SquareRoot(double a) { return std::sqrt(a); }

/// A vector of the plane over double, or over DoubleDouble (double_double.h) for formulas that are evaluated in both.
/// Plain arithmetic in a fixed order, so that the model gives the same bits everywhere.
template <class T>
struct VecOf {
  T x{};
  T y{};
  bool operator==(const VecOf&) const = default;
};
using Vec2 = VecOf<double>;

template <class T>
constexpr VecOf<T> operator+(VecOf<T> a, VecOf<T> b) {
  return {a.x + b.x, a.y + b.y};
}
template <class T>
constexpr VecOf<T> operator-(VecOf<T> a, VecOf<T> b) {
  return {a.x - b.x, a.y - b.y};
}
template <class T>
constexpr VecOf<T> operator-(VecOf<T> a) {
  return {-a.x, -a.y};
}
template <class T>
constexpr VecOf<T> operator*(std::type_identity_t<T> s, VecOf<T> a) {
  return {s * a.x, s * a.y};
}
template <class T>
constexpr T Dot(VecOf<T> a, VecOf<T> b) {
  return a.x * b.x + a.y * b.y;
}
/// The scalar a_x b_y - a_y b_x.
template <class T>
constexpr T Cross(VecOf<T> a, VecOf<T> b) {
  return a.x * b.y - a.y * b.x;
}
/// z-hat x a: a turned by +90 degrees.
template <class T>
constexpr VecOf<T> Perp(VecOf<T> a) {
  return {-a.y, a.x};
}
/// sqrt, not hypot: correctly rounded on every machine.
template <class T>
T Norm(VecOf<T> a) {
  return SquareRoot(a.x * a.x + a.y * a.y);
}
inline double Norm(Vec2 a) { return Norm<double>(a); }
template <class T>
VecOf<T> Unit(VecOf<T> a) {
  const T norm = Norm(a);
  return {a.x / norm, a.y / norm};
}
/// The vector a turned by the angle of the unit vector r = (cos, sin).
template <class T>
constexpr VecOf<T> Turn(VecOf<T> r, VecOf<T> a) {
  return {r.x * a.x - r.y * a.y, r.y * a.x + r.x * a.y};
}
inline bool IsFinite(Vec2 a) { return std::isfinite(a.x) && std::isfinite(a.y); }

/// A rotation of the plane by an angle, as its cosine and sine.
struct Rotation {
  double cos = 1;
  double sin = 0;
};

/// cos(theta) and sin(theta), theta [rad] finite, each correctly rounded to nearest: the same bits on every machine and
/// with every mathematics library, which std::sin does not promise. Exact for theta = 0. About 0.1 microseconds; MPFR
/// [Fousse et al. 2007] decides the rare cases in which the fast evaluation cannot.
/// @return NaN, NaN for an angle that is not finite
Rotation SinCos(double theta);

/// cos(theta) and sin(theta) as sums of two doubles, to about 32 digits; `high` is SinCos(theta). MPFR always: about 10
/// microseconds.
struct RotationParts {
  Rotation high;
  Rotation low;
};
RotationParts SinCosParts(double theta);

/// R(theta) a.
constexpr Vec2 Rotate(Rotation r, Vec2 a) { return {r.cos * a.x - r.sin * a.y, r.sin * a.x + r.cos * a.y}; }
/// R(-theta) a: a vector of the world in the frame that is turned by theta.
constexpr Vec2 RotateBack(Rotation r, Vec2 a) { return Rotate({r.cos, -r.sin}, a); }

/// The angle of a direction, counter-clockwise from the x axis, in (-pi, pi] [rad]: atan2(y, x) correctly rounded to
/// nearest by MPFR, hence the same bits on every machine, which std::atan2 does not promise. A few microseconds: for
/// building shapes, not for inner loops.
/// @param direction  any length > 0; (0, 0) gives 0, a number that is not finite may give NaN
double AngleOf(Vec2 direction);

}  // namespace lcpbench
