#include "model/motion/make_motion.h"

#include <utility>

namespace lcpbench {

std::unique_ptr<Motion> MakeMotion(MotionLevel level, World world, const MotionOptions& options, LcpSolver& solver) {
  if (level == MotionLevel::kAcceleration) {
    return std::make_unique<AccelerationMotion>(std::move(world), options.acceleration, solver);
  }
  return std::make_unique<VelocityMotion>(std::move(world), options.velocity, solver);
}

}  // namespace lcpbench
