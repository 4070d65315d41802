#include "model/geometry/placed_feature.h"

namespace lcpbench {

template <>
VecOf<double> TurnOf<double>(Rotation rotation, std::optional<double> /*theta*/, Angles /*angles*/) {
  return LiftRotation<double>(rotation);
}
template <>
VecOf<DoubleDouble> TurnOf<DoubleDouble>(Rotation rotation, std::optional<double> theta, Angles angles) {
  if (angles == Angles::kExact && theta) return ExactRotation(*theta);
  return LiftRotation<DoubleDouble>(rotation);
}

}  // namespace lcpbench
