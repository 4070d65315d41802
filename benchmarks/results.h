#pragma once

#include <string>

#include "benchmarks/suite.h"

namespace lcpbench {

/// Writes run.json (see RESULTS.md): what is run, where, and with which rules.
/// @param started  ISO 8601, UTC
/// @param wall_s   seconds of the whole run; negative while it is still going on
/// @throws InputError when the file cannot be written
void WriteRunFile(const std::string& folder, const Suite& suite, const std::string& started, double wall_s);

/// Solves a small problem of every family and writes <folder>/<family>.svg.
void WritePictures(const std::string& folder, const Suite& suite);

/// "own", "peer" or "external".
const char* OriginKey(SolverOrigin origin);

/// Now, as ISO 8601 in UTC.
std::string UtcNow();

}  // namespace lcpbench
