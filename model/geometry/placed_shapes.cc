#include "model/geometry/placed_shapes.h"

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

template <>
VecOf<double> TurnOf<double>(const PlacedFeature& placed, Angles /*angles*/) {
  return LiftRotation<double>(placed.rotation);
}
template <>
VecOf<DoubleDouble> TurnOf<DoubleDouble>(const PlacedFeature& placed, Angles angles) {
  if (angles == Angles::kExact && placed.theta) return ExactRotation(*placed.theta);
  return LiftRotation<DoubleDouble>(placed.rotation);
}

template <class T>
Round<T> PlaceRound(const PlacedFeature& placed, Angles angles) {
  const VecOf<T> turn = TurnOf<T>(placed, angles);
  if (const auto* vertex = std::get_if<Vertex>(&placed.feature)) {
    return {Turn(turn, Lift<T>(vertex->p)), 0, true, placed.rotation};
  }
  const auto& arc = std::get<ArcEdge>(placed.feature);
  const double rho = arc.side == Side::kConvex ? arc.radius : -arc.radius;
  return {Turn(turn, Lift<T>(arc.center)), rho, false, placed.rotation};
}
template Round<double> PlaceRound(const PlacedFeature& placed, Angles angles);
template Round<DoubleDouble> PlaceRound(const PlacedFeature& placed, Angles angles);

template <class T>
Line<T> PlaceLine(const PlacedFeature& placed, Angles angles) {
  const auto& edge = std::get<StraightEdge>(placed.feature);
  const VecOf<T> turn = TurnOf<T>(placed, angles);
  const VecOf<T> along = Lift<T>(edge.b) - Lift<T>(edge.a);
  const VecOf<T> direction = Turn(turn, Unit(along));
  return {Turn(turn, Lift<T>(edge.a)), direction, -Perp(direction), Norm(along)};
}
template Line<double> PlaceLine(const PlacedFeature& placed, Angles angles);
template Line<DoubleDouble> PlaceLine(const PlacedFeature& placed, Angles angles);

}  // namespace lcpbench
