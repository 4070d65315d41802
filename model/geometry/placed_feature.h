#pragma once

#include <optional>

#include "model/geometry/double_double.h"
#include "model/geometry/feature.h"

namespace lcpbench {

/// A body's feature placed in the world: a body-frame point c is at x + R(theta) c.
struct PlacedFeature {
  const Feature& feature;
  Vec2 x;             ///< the body's centre of mass [m]
  Rotation rotation;  ///< SinCos(theta)
  /// Where given, pairs whose contact point depends strongly on the angle are placed by it to twice the digits.
  std::optional<double> theta = std::nullopt;
};

/// The (cos, sin) of a rotation by theta; a double has room for rounded angles only.
template <class T>
VecOf<T> TurnOf(Rotation rotation, std::optional<double> theta, Angles angles) {
  if constexpr (std::is_same_v<T, DoubleDouble>) {
    if (angles == Angles::kExact && theta) return ExactRotation(*theta);
  }
  return LiftRotation<T>(rotation);
}

}  // namespace lcpbench
