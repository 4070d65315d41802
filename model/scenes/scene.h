#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "model/system.h"

namespace lcpbench {

/// A named, seeded family of contact systems: one acceleration-level problem for every number of rows and seed.
struct SceneFamily {
  std::string_view key;      ///< [a-z0-9-]+
  std::string_view title;    ///< a few words
  std::string_view purpose;  ///< what the family tells apart, one or two sentences
  /// The system with exactly `rows` rows (>= 1); the same seed gives the same bits on every x86-64 machine.
  ContactSystem (*generate)(int rows, std::uint64_t seed);
};

/// In the report's order.
std::span<const SceneFamily> AllScenes();

/// @throws InputError naming the known keys
const SceneFamily& FindScene(std::string_view key);

/// FindScene(key).generate(rows, seed).  @throws InputError for an unknown key or rows < 1
ContactSystem GenerateScene(std::string_view key, int rows, std::uint64_t seed);

}  // namespace lcpbench
