#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/motion/make_motion.h"
#include "model/scene_file/scene_file.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

// What the command line means by a scene: a family's key with size and seed, or a scene file (a name with a '/', or
// ending in .json).

/// The solver that drives a motion unless the user names another one.
inline constexpr const char* kDrivingSolver = "auto";

/// A world that is about to move, and how it is meant to.
struct MovingScene {
  std::string name;  ///< of the family or world
  World world;
  MotionLevel level = MotionLevel::kVelocity;  ///< copes with any scene
  double step = 1e-3;      ///< time between two problems of its sequence, and the velocity level's time step [s]
  double restitution = 0;  ///< of impacts, in [0, 1]
  std::optional<ImpactLaw> impact_law = {};  ///< Newton's if none
  std::optional<double> resting_speed = {};  ///< [m/s]; each level has its own default
};

/// The sequence form of a family, or a scene file with what it wishes for.
/// @param size, seed  of families, size >= 1; files have neither
/// @throws InputError naming the known families, or the file and what is wrong with it
MovingScene LoadScene(const std::string& name_or_file, int size, std::uint64_t seed);

/// A scene file's world, with what the file wishes for.
MovingScene ToMovingScene(SceneFile file);

/// Gives every contact this friction, whatever its bodies'.
void SetFriction(double mu, MovingScene* scene);
/// The same of the contacts of one instant.
void SetFriction(double mu, ContactSystem* system);

/// What counts as touching at the start, in units of the median extent of the movable bodies.
inline constexpr double kFoundGap = 1e-5;

/// One instant: a family's problem as the benchmark solves it, its contacts listed; of a file its joints and the
/// contacts found (InstantWithContacts).
/// @param level  of files; their own where none is given
/// @throws InputError as LoadScene, InstantWithContacts
ContactSystem LoadInstant(const std::string& name_or_file, int size, std::uint64_t seed,
                          std::optional<MotionLevel> level = {});

/// One instant of a world: its joints without slack ropes, and the contacts found between its outlines, within
/// `found_gap` [median extents of the movable bodies] and down to the depth that a motion at `level` treats.
/// @throws InputError as DetectContacts, and where a motion at `level` would refuse bodies that overlap
ContactSystem InstantWithContacts(const World& world, MotionLevel level, double found_gap);

/// A solver that drives the scene. Steps in which no contact has friction are `auto`'s where the solver is made for
/// friction.
/// @throws InputError as MakeSolver, and for such a solver where the scene has no friction at all
std::unique_ptr<LcpSolver> MakeMotionSolver(const MovingScene& scene, const std::string& key,
                                            const Settings& settings = {});

/// The scene's world, ready to move as the scene says under `solver`, which must outlive it.
/// @param warm_start  VelocityOptions::warm_start
/// @throws InputError as MakeMotion
std::unique_ptr<Motion> StartMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver,
                                    bool warm_start = true);

/// The scene as a file that LoadScene reads back as the same scene (FormatScene).
/// @throws InputError as FormatScene
std::string FormatMovingScene(const MovingScene& scene);

}  // namespace lcpbench
