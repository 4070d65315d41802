#include "model/placed_shapes.h"

#include <cmath>
#include <utility>
#include <variant>

namespace lcpbench {

template <class T>
std::optional<double> Round<T>::Parameter(Vec2 N) const {
  if (is_vertex) return std::nullopt;
  const Vec2 u = Rotate({rotation.cos, -rotation.sin}, rho > 0 ? N : -N);
  return std::atan2(u.y, u.x);
}
template struct Round<double>;
template struct Round<DoubleDouble>;

template <class T>
Round<T> PlaceRound(const Feature& vertex_or_arc, Rotation rotation) {
  const VecOf<T> turn = LiftRotation<T>(rotation);
  if (const auto* vertex = std::get_if<Vertex>(&vertex_or_arc)) {
    return {Turn(turn, Lift<T>(vertex->p)), 0, true, rotation};
  }
  const auto& arc = std::get<ArcEdge>(vertex_or_arc);
  const double rho = arc.side == Side::kConvex ? arc.radius : -arc.radius;
  return {Turn(turn, Lift<T>(arc.center)), rho, false, rotation};
}
template Round<double> PlaceRound(const Feature& vertex_or_arc, Rotation rotation);
template Round<DoubleDouble> PlaceRound(const Feature& vertex_or_arc, Rotation rotation);

template <class T>
Line<T> PlaceLine(const StraightEdge& edge, Rotation rotation) {
  const VecOf<T> turn = LiftRotation<T>(rotation);
  const VecOf<T> along = Lift<T>(edge.b) - Lift<T>(edge.a);
  const VecOf<T> direction = Turn(turn, Unit(along));
  return {Turn(turn, Lift<T>(edge.a)), direction, -Perp(direction), Norm(along)};
}
template Line<double> PlaceLine(const StraightEdge& edge, Rotation rotation);
template Line<DoubleDouble> PlaceLine(const StraightEdge& edge, Rotation rotation);

ClosestPoints Swapped(const ClosestPoints& c) {
  ClosestPoints swapped = c;
  swapped.n = -c.n;
  std::swap(swapped.R1, swapped.R2);
  swapped.moment1 = -c.moment2;
  swapped.moment2 = -c.moment1;
  std::swap(swapped.curvature1, swapped.curvature2);
  swapped.owner = 3 - c.owner;
  std::swap(swapped.s1, swapped.s2);
  return swapped;
}

}  // namespace lcpbench
