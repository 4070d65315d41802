#pragma once

#include "model/geometry/double_double.h"
#include "model/geometry/placed_feature.h"

namespace lcpbench {

/// A vertex or an arc, by its centre of curvature: the world-frame arm U from the body's centre of mass. T is double,
/// or DoubleDouble where lengths cancel.
template <class T>
struct Round {
  VecOf<T> U;
  double rho = 0;  ///< signed radius; 0 for a vertex
  bool is_vertex = false;
  Rotation rotation;

  CurvaturePair curvature() const { return is_vertex ? CurvaturePair{0, 1} : CurvaturePair{1, 1 / rho}; }
  /// The angle, in the body frame, of the point with the world-frame outward normal N; none for a vertex.
  std::optional<double> Parameter(Vec2 N) const;
};

/// A straight edge: the world-frame arm of its start, its direction and outward normal.
template <class T>
struct Line {
  VecOf<T> A;
  VecOf<T> direction;
  VecOf<T> normal;
  T length{};
};

/// The (cos, sin) that turns a feature into the world; a double has room for rounded angles only.
template <class T>
VecOf<T> TurnOf(const PlacedFeature& placed, Angles angles);

/// @param placed  a vertex or an arc
template <class T>
Round<T> PlaceRound(const PlacedFeature& placed, Angles angles);

/// @param placed  a straight edge
template <class T>
Line<T> PlaceLine(const PlacedFeature& placed, Angles angles);

/// x1 - x2, without rounding where T has room for it.
template <class T>
VecOf<T> Difference(Vec2 x1, Vec2 x2) {
  return {T(x1.x) - T(x2.x), T(x1.y) - T(x2.y)};
}

/// R x n, by the shorter of the two arms that give it.
template <class T>
double Moment(VecOf<T> R, VecOf<T> U, VecOf<T> n) {
  return ToDouble(Dot(U, U) > Dot(R, R) ? Cross(R, n) : Cross(U, n));
}

}  // namespace lcpbench
