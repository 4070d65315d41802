#pragma once

#include <string>

#include "benchmarks/recommend/ranking.h"

namespace lcpbench {

/// The C++ by which an engine uses a solver as it was measured: a class that compiles as it is against the installed
/// headers.
/// @param solver  registry key; of a variant its base and settings are written
std::string EmbeddingCode(const std::string& solver, bool warm, const RecommendationRequest& request);

/// What the engine's CMakeLists.txt needs for it.
std::string EmbeddingCMake();

}  // namespace lcpbench
