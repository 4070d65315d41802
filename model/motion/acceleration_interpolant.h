#pragma once

#include <array>
#include <vector>

#include "model/contact/body.h"
#include "model/motion/acceleration_flow.h"

namespace lcpbench {

/// A step between its ends: positions by the polynomial of degree 5 with the positions, velocities and accelerations of
/// both ends (error of order 6 in the step), velocities by its derivative. For first estimates of events.
class StepInterpolant {
 public:
  /// @param bodies  tell which are movable
  /// @param begin_accelerations, end_accelerations  three a body
  StepInterpolant(const std::vector<Body>& bodies, double step, const MotionState& begin,
                  const std::vector<double>& begin_accelerations, const MotionState& end,
                  const std::vector<double>& end_accelerations);

  double step() const { return step_; }
  /// @param time  0 to step [s]
  MotionState At(double time) const;

 private:
  // q(u) = sum of c_k u^k, u = time / step.
  using Quintic = std::array<double, 6>;
  double step_;
  std::vector<Quintic> coordinates_;  // three a movable body
};

}  // namespace lcpbench
