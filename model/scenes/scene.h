#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "model/contact/system.h"
#include "model/contact/world.h"

namespace lcpbench {

class SceneBuilder;

/// A named, seeded family of scenes: for every number of rows and seed one problem, and a world in motion that meets a
/// sequence of them.
struct SceneFamily {
  std::string_view key;      ///< [a-z0-9-]+
  std::string_view title;    ///< a few words
  std::string_view purpose;  ///< what the family tells apart, one or two sentences
  /// The system with exactly `rows` rows (>= 1) (of FrictionScenes: about as many); the same seed gives the same bits
  /// on every x86-64 machine.
  ContactSystem generate(int rows, std::uint64_t seed) const;
  /// The sequence form: the world that starts moving, its size meant as in `generate` (as many rows where all bodies
  /// touch). The same bits for the same seed.
  World start(int rows, std::uint64_t seed) const;
  std::unique_ptr<SceneBuilder> (*make)(std::string_view key, int rows, std::uint64_t seed);
  /// The level that suits the scene: kVelocity for piles, where event location would stall.
  MotionLevel level = MotionLevel::kVelocity;
  /// Time between two problems of its sequence, and the time step at the velocity level [s].
  double step = 1e-3;
  /// Restitution of impacts in its sequence, in [0, 1].
  double restitution = 0;
};

/// Those without friction, in the report's order: what the tiers of plain problems are made of.
std::span<const SceneFamily> AllScenes();

/// Those whose contacts have friction; each is near a threshold between two ways to answer [docs/friction.md section
/// 8]. Their systems have `rows` rows at most, tangents among them, or the least number that the family can have, and
/// stand for time steps (AssembleInstant).
std::span<const SceneFamily> FrictionScenes();

/// @throws InputError naming the known keys
const SceneFamily& FindScene(std::string_view key);

/// FindScene(key).generate(rows, seed).  @throws InputError for an unknown key or rows < 1
ContactSystem GenerateScene(std::string_view key, int rows, std::uint64_t seed);

/// FindScene(key).start(rows, seed).  @throws InputError as GenerateScene
World StartScene(std::string_view key, int rows, std::uint64_t seed);

}  // namespace lcpbench
