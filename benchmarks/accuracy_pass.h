#pragma once

#include <map>
#include <string>
#include <tuple>

#include "benchmarks/suite.h"

namespace lcpbench {

/// problem id, solver, tier.
using CellKey = std::tuple<std::string, std::string, double>;

/// What the accuracy pass found out about each cell: "" where it passed its tier, else why not.
using CellOutcomes = std::map<CellKey, std::string>;

/// Solves every cell of the suite once, judges it, and writes problems.csv and accuracy.csv into `folder` (RESULTS.md),
/// row by row. Set-up and solve are timed apart.
CellOutcomes RunAccuracyPass(const Suite& suite, const std::string& folder);

}  // namespace lcpbench
