#pragma once

#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// Writes problems.jsonl (RESULTS.md): what is known of every problem of a campaign, and what an oracle would have to
/// pay for it that is told the active set (oracle.h), measured here. Problems that the file has already are passed
/// over.
/// @param paths   of the manifests, in the same order
/// @param wanted  by manifest and problem
void WriteProblems(const std::string& path, const std::vector<Manifest>& manifests,
                   const std::vector<std::string>& paths, const std::vector<std::vector<bool>>& wanted);

}  // namespace lcpbench
