#include "model/motion/make_motion.h"

#include <string>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {

std::unique_ptr<Motion> MakeMotion(MotionLevel level, World world, const MotionOptions& options, LcpSolver& solver) {
  if (level == MotionLevel::kAcceleration) {
    return std::make_unique<AccelerationMotion>(std::move(world), options.acceleration, solver);
  }
  return std::make_unique<VelocityMotion>(std::move(world), options.velocity, solver);
}

std::string_view ToString(MotionLevel level) {
  return level == MotionLevel::kAcceleration ? "acceleration" : "velocity";
}

MotionLevel MotionLevelFromString(std::string_view key) {
  for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
    if (key == ToString(level)) return level;
  }
  throw InputError("unknown level '" + std::string(key) + "', expected acceleration or velocity");
}

std::string_view ToString(MotionProblemKind kind) {
  switch (kind) {
    case MotionProblemKind::kAcceleration:
      return "acceleration";
    case MotionProblemKind::kImpact:
      return "impact";
    case MotionProblemKind::kTimeStep:
      break;
  }
  return "time_step";
}

}  // namespace lcpbench
