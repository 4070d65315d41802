#include "benchmarks/scene_motion.h"

#include "solvers/lcp/input_error.h"

namespace lcpbench {

MotionLevel MotionLevelOf(const std::string& name) {
  for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
    if (name == ToString(level)) return level;
  }
  throw InputError("--level: expected acceleration or velocity, found '" + name + "'");
}

std::string ToString(MotionLevel level) { return level == MotionLevel::kAcceleration ? "acceleration" : "velocity"; }

std::unique_ptr<Motion> StartMotion(const SceneSource& source, MotionLevel level, LcpSolver& /*solver*/) {
  throw InputError("scene '" + source.world.name + "': this build has no motion at the " + ToString(level) + " level");
}

}  // namespace lcpbench
