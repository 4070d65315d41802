#pragma once

#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/references.h"

namespace lcpbench {

/// A manifest, its problems and their known answers.
struct ProblemSet {
  /// @throws InputError as ReadManifest and References
  explicit ProblemSet(const std::string& path);

  Manifest manifest;
  ProblemSource source;
  References references;
};

/// Writes problems.jsonl (RESULTS.md): what is known of every problem of a campaign, and what an oracle would have to
/// pay for it that is told the active set (oracle.h), measured here. Problems that the file has already are passed
/// over. Lines have the order of `problems`, which is what the arrays of streams.jsonl refer to. The k problems of the
/// campaign that have one base weigh 1/k each.
/// @param manifests  paths, in the order that PlannedProblem::manifest refers to
void WriteProblems(const std::string& path, const std::vector<std::string>& manifests,
                   const std::vector<PlannedProblem>& problems);

}  // namespace lcpbench
