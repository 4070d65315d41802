#include "model/motion/acceleration_interpolant.h"

namespace lcpbench {

StepInterpolant::StepInterpolant(const std::vector<Body>& bodies, double step, const MotionState& begin,
                                 const std::vector<double>& begin_accelerations, const MotionState& end,
                                 const std::vector<double>& end_accelerations)
    : step_(step) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].fixed) continue;
    for (std::size_t j = 0; j < 3; ++j) {
      const double q0 = begin[k + j];
      const double v0 = begin[k + 3 + j] * step;
      const double a0 = begin_accelerations[3 * i + j] * step * step / 2;
      // What the first three terms lack at the end: position, velocity, half the acceleration.
      const double dq = end[k + j] - q0 - v0 - a0;
      const double dv = end[k + 3 + j] * step - v0 - 2 * a0;
      const double da = end_accelerations[3 * i + j] * step * step / 2 - a0;
      coordinates_.push_back({q0, v0, a0, 10 * dq - 4 * dv + da, -15 * dq + 7 * dv - 2 * da, 6 * dq - 3 * dv + da});
    }
    k += 6;
  }
}

MotionState StepInterpolant::At(double time) const {
  const double u = time / step_;
  MotionState state(2 * coordinates_.size());
  for (std::size_t c = 0; c < coordinates_.size(); ++c) {
    const Quintic& q = coordinates_[c];
    const std::size_t k = 6 * (c / 3) + c % 3;
    state[k] = q[0] + u * (q[1] + u * (q[2] + u * (q[3] + u * (q[4] + u * q[5]))));
    state[k + 3] = (q[1] + u * (2 * q[2] + u * (3 * q[3] + u * (4 * q[4] + u * (5 * q[5]))))) / step_;
  }
  return state;
}

}  // namespace lcpbench
