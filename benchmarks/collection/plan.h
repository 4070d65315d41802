#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/collection/recording.h"

namespace lcpbench {

/// A problem that the collection is meant to have, of the family that its scene is.
struct Candidate {
  Recipe recipe;
  std::string grid;     ///< the property that its neighbours differ in; "" outside grids
  std::string purpose;  ///< of pathological ones: what it is meant to break
};

/// A scene that moves: `steps` are what is taken of it (TakeSteps), or the length of a sequence in steps of its own.
struct MotionCandidate {
  Recipe start;
  int steps = 0;
};

/// Fill-ups of one size class: problems of all scene families at some sizes.
struct FillPlan {
  SizeClass size_class;
  std::vector<int> rows;
};

/// How much a tier takes of the recordings (build.h).
struct RecordedShare {
  RecordedLevel level = RecordedLevel::kVelocity;  ///< of islands and whole scenes
  int steps = 8;                                   ///< of each recording, whose whole scenes are taken
  std::size_t islands = 200;                       ///< of a size class
};

/// The version of the tiers whose problems are scenes of ours; raised with every change of a manifest's problems.
inline constexpr const char* kCollectionVersion = "2.0.0";

/// One tier of the collection.
struct Tier {
  std::string name;
  std::string purpose;
  bool refuses = false;    ///< trivial problems and problems without a solution, and tries the next seed
  bool has_files = false;  ///< of its problems and proved answers
  /// Its problems have friction. Those by recipes are made on demand: they have no file.
  bool has_friction = false;
  std::vector<Candidate> problems = {};
  std::vector<MotionCandidate> motions = {};
  std::vector<FillPlan> fill = {};
  std::vector<MotionCandidate> sequences = {};
  /// The manifest's version.
  std::string version = kCollectionVersion;
  /// Its file of problems is written by hand (data/literals.py) and read by the build; problems by formulas, which come
  /// first in the manifest, are made when they are wanted.
  bool has_literals = false;
  /// Its problems are made of the recordings in the folder kRecordings, by a rule that looks at no solver (build.h).
  std::optional<RecordedShare> recordings = {};
};

/// The tier whose problems are in no mean of a report: "unsupported" is a right answer to them.
inline constexpr const char* kNonsymmetricTier = "nonsymmetric";
/// The tier of textbook and formula problems: a table of their own, in no mean either. They are few, and what they test
/// is not what bodies in contact ask of a solver.
inline constexpr const char* kLiteratureTier = "literature";

/// smoke, engine, standard, large, sequences, pathological, literature, recorded, nonsymmetric, friction-engine,
/// friction, friction-recorded, friction-literature, friction-pathological, painleve, friction-sequences.
/// @throws InputError naming them
Tier PlanTier(std::string_view name);
const std::vector<std::string>& AllTiers();

}  // namespace lcpbench
