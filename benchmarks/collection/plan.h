#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/collection/size_classes.h"

namespace lcpbench {

/// A problem that the collection is meant to have.
struct Candidate {
  Recipe recipe;
  std::string family;
  std::string grid;     ///< the property that its neighbours differ in; "" outside grids
  std::string purpose;  ///< of pathological ones: what it is meant to break
};

/// A motion that the collection is meant to have some steps of (TakeSteps).
struct MotionCandidate {
  Recipe start;
  int steps = 0;  ///< taken
};

/// Fill-ups of one size class: problems of all scene families at some sizes.
struct FillPlan {
  SizeClass size_class;
  std::vector<int> rows;
};

/// A sequence that the collection is meant to have: a scene that moves `steps` steps of its own length.
struct SequenceCandidate {
  Recipe start;
  int steps = 0;
};

/// One tier of the collection.
struct Tier {
  std::string name;
  std::string purpose;
  /// Trivial problems and problems without a solution are refused, and the next seed is tried.
  bool refuses = false;
  /// Proved answers are written.
  bool has_references = false;
  /// The problems themselves are written as well.
  bool has_files = false;
  std::vector<Candidate> problems;
  std::vector<MotionCandidate> motions;
  std::vector<FillPlan> fill;
  std::vector<SequenceCandidate> sequences;
};

/// smoke, engine, standard, large, sequences, pathological.  @throws InputError naming them
Tier PlanTier(std::string_view name);
const std::vector<std::string>& AllTiers();

/// Of all that the plan holds. Raised with every change of what a manifest's problems are.
inline constexpr const char* kCollectionVersion = "2.0.0";

}  // namespace lcpbench
