#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"

namespace lcpbench {

/// A solver that was not measured, and why.
struct UntriedSolver {
  std::string solver;
  std::string reason;
};

/// What StepSolver has to be told of problems that it takes.
struct StepSizes {
  Index rows = 0;    ///< of the largest
  Index bodies = 0;  ///< of the largest
  int columns_per_body = 3;
};

/// StepSolver is recommended up to so many rows; beyond, large islands decide, and it asks the same solvers as `auto`.
inline constexpr Index kMostStepRows = 1000;

/// Their sizes, if StepSolver takes all of these problems, whose rows then act on two bodies at most, and they are of
/// kMostStepRows rows at most.
std::optional<StepSizes> FindStepSizes(const std::vector<SequenceStep>& steps);

/// All that `lcpbench recommend` has to say.
struct Recommendation {
  std::string input;
  int problems = 0;
  double least_rows = 0;
  double most_rows = 0;
  bool rows_are_known = false;  ///< so that solvers also ran from warm starts
  bool has_friction = false;    ///< so that it matters which law a solver answers for (SolverEntry::law)
  int samples = 0;              ///< solves of a pass
  int rounds = 0;
  double budget_s = 0;
  double spent_s = 0;
  RecommendationRequest request;
  std::optional<StepSizes> step_sizes;  ///< FindStepSizes: `auto` is then embedded as StepSolver
  std::vector<Assessment> ranked;       ///< best first, one or more
  std::vector<UntriedSolver> untried;
  std::string note = {};  ///< what of the problem leaves solvers out, and which take it; "" for most problems
};

/// As text: table, the recommendation with its evidence, what was not tried and why, C++ and CMake lines.
std::string FormatRecommendation(const Recommendation& recommendation);

/// The same as one JSON object (RESULTS.md).
nlohmann::ordered_json DescribeRecommendation(const Recommendation& recommendation);

/// The C++ by which an engine uses a solver as it was measured: a class that compiles as it is against the installed
/// headers.
/// @param solver  registry key; of a variant its base and settings are written
std::string EmbeddingCode(const std::string& solver, bool warm, const RecommendationRequest& request);

/// The same for `auto` as StepSolver, which reads the engine's arrays.
std::string StepEmbeddingCode(const StepSizes& sizes, bool warm, const RecommendationRequest& request);

}  // namespace lcpbench
