#pragma once

#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// Writes problems.jsonl (RESULTS.md): what is known of every problem of a campaign, and what an oracle would have to
/// pay for it that is told the active set (oracle.h), measured here. Problems that the file has already are passed
/// over.
/// Lines have the order of `problems`, which is what the arrays of streams.jsonl refer to. The k problems of the
/// campaign that have one base weigh 1/k each.
/// @param paths  of the manifests, in the same order
void WriteProblems(const std::string& path, const std::vector<Manifest>& manifests,
                   const std::vector<std::string>& paths, const std::vector<PlannedProblem>& problems);

}  // namespace lcpbench
