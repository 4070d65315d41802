#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "model/motion/make_motion.h"
#include "model/system.h"
#include "model/world.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// What the command line means by a scene: a family's key with size and seed, or a scene file.
struct SceneSource {
  World world;  ///< what starts moving
  /// Of a family: the problem that the benchmark solves, with its contacts listed.
  std::optional<ContactSystem> problem;
  MotionLevel level = MotionLevel::kVelocity;  ///< what suits the scene
  double step = 1e-3;                          ///< time step at the velocity level [s]
  double restitution = 0;                      ///< of impacts, in [0, 1]
};

/// @param name_or_file  a key of AllScenes(), or a path (with a '/' or ending in .json)
/// @param size          rows of a family, >= 1; files know their own size
/// @throws InputError naming the known keys, or the file and what is wrong with it
SceneSource LoadScene(const std::string& name_or_file, int size, std::uint64_t seed);

/// One instant of a world: its joints, and the contacts found between its outlines within kFoundGap.
/// @throws InputError as DetectContacts
ContactSystem InstantWithContacts(const World& world);

/// The world, ready to move as the source says under `solver`, which must outlive it.
/// @throws InputError as MakeMotion
std::unique_ptr<Motion> StartMotion(const SceneSource& source, LcpSolver& solver);

// In units of the median extent of the movable bodies: what counts as touching, and the deepest overlap that a motion
// may have left.
inline constexpr double kFoundGap = 1e-5;
inline constexpr double kFoundDepth = 0.02;

}  // namespace lcpbench
