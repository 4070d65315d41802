#pragma once

#include <memory>
#include <optional>
#include <string>

#include "benchmarks/scene_source.h"
#include "model/motion/motion.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// "acceleration" or "velocity". @throws InputError naming the two
MotionLevel MotionLevelOf(const std::string& name);
std::string ToString(MotionLevel level);

/// The scene's world, ready to move under `solver`, which must outlive it.
/// @throws InputError as the motions
std::unique_ptr<Motion> StartMotion(const SceneSource& source, MotionLevel level, LcpSolver& solver);

}  // namespace lcpbench
