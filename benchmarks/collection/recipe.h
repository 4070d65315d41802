#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/collection/instance.h"

namespace lcpbench {

/// One change of a generated problem, by name (AllChanges), with its one number.
struct Change {
  std::string name;
  double amount = 0;
  bool operator==(const Change&) const = default;
};

/// How a problem is made: a scene family or hard case, its size and seed, and changes in their order, of the same seed.
/// Everything that a problem's bits depend on.
struct Recipe {
  std::string scene;
  int rows = 0;
  std::uint64_t seed = 1;
  std::vector<Change> changes;
  bool operator==(const Recipe&) const = default;
};

/// What a change does, and what its number means.
struct ChangeKind {
  const char* name;
  const char* meaning;
};
const std::vector<ChangeKind>& AllChanges();

/// "<scene>-n<rows>-s<seed>", and "-<change>-<amount>" for every change.
std::string RecipeId(const Recipe& recipe);

/// A problem of the recipe's id.
/// @throws InputError naming the recipe, for an unknown scene or change, numbers that it refuses, singular geometry
Instance MakeInstance(const Recipe& recipe);

/// How many constraints are of which kind: contacts by their two features' kinds ("arc on straight", concave edges as
/// "concave arc"), in alphabetical order, others by type ("pin").
std::map<std::string, int> CountKinds(const ContactSystem& system);

}  // namespace lcpbench
