#pragma once

#include <memory>

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

/// A motion at `level`, as its own constructor makes it.
/// @throws InputError as that constructor
std::unique_ptr<Motion> MakeMotion(MotionLevel level, World world, const MotionOptions& options, LcpSolver& solver);

}  // namespace lcpbench
