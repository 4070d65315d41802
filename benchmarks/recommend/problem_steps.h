#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/collection/problem_formats.h"

namespace lcpbench {

/// What a recommendation is asked for: one problem or several, in order.
struct ProblemSteps {
  std::string name;
  std::vector<SequenceStep> steps;  ///< one or more
  bool rows_are_known = false;      ///< which rows stay from step to step, so that answers can be carried over
};

/// Reads a problem file of any format (problem_formats.h; - is standard input), or a recorded sequence: JSON lines that
/// say which rows stay, by a member "previous" (sequence_file.h) or by "motion" (`lcpbench sequence`, RESULTS.md; rows
/// that stay keep their order).
/// @throws InputError naming file and line, also where there is no problem at all
ProblemSteps ReadProblemSteps(const std::string& path, const ReadingOptions& options = {});

/// One instant of a scene, or with `steps` > 1 the problems that it meets as it moves, driven by
/// kDrivingSolver at 1e-9.
/// @param scene  family or scene file, LoadScene
/// @throws InputError as LoadInstant, LoadScene, and where the motion meets no problem
ProblemSteps MakeProblemSteps(const std::string& scene, int size, std::uint64_t seed, int steps);

}  // namespace lcpbench
