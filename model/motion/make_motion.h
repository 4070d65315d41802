#pragma once

#include <memory>
#include <utility>

#include "model/contact/world.h"
#include "model/motion/acceleration_motion.h"
#include "model/motion/motion.h"
#include "model/motion/velocity_motion.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The options of every level; each motion reads its own.
struct MotionOptions {
  AccelerationOptions acceleration;
  VelocityOptions velocity;
};

/// A motion at `level`.  @throws InputError as MakeAccelerationMotion and MakeVelocityMotion
inline std::unique_ptr<Motion> MakeMotion(MotionLevel level, World world, const MotionOptions& options,
                                          LcpSolver& solver) {
  return level == MotionLevel::kAcceleration ? MakeAccelerationMotion(std::move(world), options.acceleration, solver)
                                             : MakeVelocityMotion(std::move(world), options.velocity, solver);
}

}  // namespace lcpbench
