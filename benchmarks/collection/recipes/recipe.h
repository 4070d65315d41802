#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/collection/recipes/changes.h"

namespace lcpbench {

/// One change of a generated problem, by name (kChanges in recipe.cc), with its one number.
struct Change {
  std::string name;
  double amount = 0;
  bool operator==(const Change&) const = default;
};

/// How a problem is made: a scene family or hard case, its size and seed, and changes in their order, of the same seed;
/// or a time step of a scene's motion (motion_steps.h). Everything that a problem's bits depend on.
struct Recipe {
  std::string scene;
  int rows = 0;
  std::uint64_t seed = 1;
  std::vector<Change> changes;
  /// From 1: the LCP of this time step. 0: the scene as it is placed. Problems of motions have no changes.
  int motion_step = 0;
  bool operator==(const Recipe&) const = default;
};

std::vector<std::string> AllChanges();

/// "<scene>-n<rows>-s<seed>", "-<change>-<amount>" for every change, "-motion-step<k>" for a step of a motion.
std::string RecipeId(const Recipe& recipe);

/// What problems that are no independent samples have in common: the id without changes, "<scene>-n<rows>-s<seed>", or,
/// of all steps of one motion, "<scene>-n<rows>-s<seed>-motion".
std::string BaseOf(const Recipe& recipe);

/// A problem of the recipe's id. A step of a motion costs all steps up to it.
/// @throws InputError naming the recipe, for an unknown scene or change, numbers that it refuses, singular geometry
Instance MakeInstance(const Recipe& recipe);

/// How many constraints are of which kind: contacts by their two features' kinds ("arc on straight", concave edges as
/// "concave arc"), in alphabetical order, others by type ("pin").
std::map<std::string, int> CountKinds(const ContactSystem& system);

}  // namespace lcpbench
