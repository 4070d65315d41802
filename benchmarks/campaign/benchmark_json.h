#pragma once

#include <string>

namespace lcpbench {

/// Writes the times of a campaign's folder in Google Benchmark's JSON, for the tools that read it: a benchmark per
/// cell, named by CellName, with a run per pass; cells that failed are errors with their reason. The context is the
/// environment of campaign.json.
/// @throws InputError where a file cannot be read or written
void WriteBenchmarkJson(const std::string& folder, const std::string& path);

}  // namespace lcpbench
