#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "model/geometry/area_moments.h"

namespace lcpbench {

// What the files of the single curves (straight_edge.h, arc.h, oval.h, bezier.h) share; feature.h says what a curve is.

/// Which side of a closed curve holds the material: convex = inside, concave = outside.
enum class Side { kConvex, kConcave };

constexpr double SignOf(Side side) { return side == Side::kConvex ? 1 : -1; }

/// How closest points of a curve are found: in closed form, of a line or a circle, or by a search along it.
enum class CurveKind { kStraight, kArc, kSearched };

/// How a feature enters the curvature formulas: (r, s) = (1, kappa) for an edge of signed curvature kappa [1/m] (> 0
/// convex, 0 straight, < 0 concave), (0, 1) for a vertex. [docs/model.md section 4]
struct CurvaturePair {
  double r = 1;
  double s = 0;
  bool is_vertex() const { return r == 0; }
};

/// A point of a curve, found by its normal.
struct SpanPoint {
  Vec2 arm;  ///< from the body's centre of mass, world axes [m]
  CurvaturePair curvature;
  /// Where it is on its curve: (s, 0) of a Bezier curve, a vector at the angle s of an oval.
  Vec2 place;
};

/// The piece s_begin..s_end of a curve that has been turned into the world's axes, `turn` being those of an oval.
struct TurnedPiece {
  double s_begin = 0;
  double s_end = 1;
  Rotation turn;
};

/// What encloses a piece of a curve that turns by less than 180 degrees: it lies within `height` of its chord, and its
/// directions of travel lie in the cone from `first` to `second`, whichever way round is less than 180 degrees.
struct Enclosure {
  double height = 0;
  Vec2 first;
  Vec2 second;
};

/// How slender a (super)ellipse may be: the ratio of its semi-axes.
inline constexpr double kMaxAspectRatio = 1e6;
/// The largest m of a superellipse: beyond it the corners are sharper than any use of the curve.
inline constexpr int kMaxSuperellipseExponent = 1000;

/// A curve at a place (smooth_curve.h), over double or DoubleDouble: derivatives by tau (oval) or s (Bezier), arms from
/// the body's centre of mass in world axes.
template <class T>
struct CurveJet {
  VecOf<T> c;
  VecOf<T> d1;
  VecOf<T> d2;
  VecOf<T> N;  ///< outward unit normal
  T kappa{};   ///< signed curvature
};

/// A number of a curve, or several, and its name.
template <class Curve, class Member>
struct Field {
  const char* name;
  Member Curve::*member;
};
// clang deduces it by itself from version 17 on.
template <class Curve, class Member>
Field(const char*, Member Curve::*) -> Field<Curve, Member>;

/// Calls visit(name, value) for the kFields of a curve or vertex.
template <class Curve, class Visit>
void ForEachField(Curve& curve, const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field.name, curve.*field.member), ...); }, Curve::kFields);
}

template <class T>
T Cubed(T x) {
  return x * x * x;
}

/// x^n, n >= 0, by repeated squaring: the same bits everywhere.
template <class T>
T IntegerPower(T x, int n) {
  T power(1);
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) power = power * x;
    x = x * x;
  }
  return power;
}

/// The greater of |x| and |y|.
inline double Largest(Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); }
/// a / |a|, or 0 for 0.
inline Vec2 UnitOrZero(Vec2 a) { return Norm(a) > 0 ? Unit(a) : a; }
inline double DistanceToSegment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double square = Dot(along, along);
  const double t = square > 0 ? std::clamp(Dot(p - a, along) / square, 0.0, 1.0) : 0;
  return Norm(p - a - t * along);
}
/// Whether v points into the cone of less than 180 degrees between u1 and u2.
inline bool InCone(Vec2 v, Vec2 u1, Vec2 u2) {
  // The last condition matters to cones that are thin but for rounding, for which the others hold on the opposite side
  // too.
  if (Cross(u1, u2) < 0) std::swap(u1, u2);
  return Cross(u1, v) >= 0 && Cross(v, u2) >= 0 && Dot(v, u1 + u2) > 0;
}

}  // namespace lcpbench
