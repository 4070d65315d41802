#pragma once

#include <cstdint>
#include <string>

#include "model/motion/make_motion.h"
#include "model/world.h"

namespace lcpbench {

/// A world that is about to move, and how it is meant to.
struct MovingScene {
  std::string name;
  World world;
  MotionLevel level = MotionLevel::kVelocity;
  double step = 1e-3;  ///< time between two problems of its sequence, and the velocity level's time step [s]
};

/// The sequence form of a scene family.
/// @throws InputError for an unknown name, and size < 1
MovingScene StartMovingScene(const std::string& name, int size, std::uint64_t seed);

/// MakeMotion with `scene.step` and the options of every solve.
std::unique_ptr<Motion> MakeMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver);

}  // namespace lcpbench
