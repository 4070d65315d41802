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
  double restitution = 0;
};

/// The sequence form of a scene family, or a scene file: a name with a slash or ending in .json. Files that wish for no
/// level get the velocity level, for it copes with any scene, and those that wish for no step 1 ms.
/// @param size, seed  of families; files have neither
/// @throws InputError for an unknown family, size < 1, and as ReadSceneFile
MovingScene StartMovingScene(const std::string& name, int size, std::uint64_t seed);

/// MakeMotion with the scene's step and restitution. Of `lcp` the acceleration level takes the tolerance alone.
std::unique_ptr<Motion> MakeMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver);

}  // namespace lcpbench
