#pragma once

#include <memory>
#include <string_view>

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

/// "acceleration" or "velocity".
std::string_view ToString(MotionLevel level);
/// @throws InputError naming the known levels
MotionLevel MotionLevelFromString(std::string_view key);

/// "acceleration", "impact" or "time_step".
std::string_view ToString(MotionProblemKind kind);

}  // namespace lcpbench
