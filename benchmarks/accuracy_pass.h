#pragma once

#include <map>
#include <string>
#include <tuple>

#include "benchmarks/suite.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// problem id, solver, tier.
using CellKey = std::tuple<std::string, std::string, double>;

/// What the accuracy pass found out about a cell.
struct CellOutcome {
  std::string failure;     ///< "" where it passed its tier, else why not
  double solve_s = 0;      ///< how long its solve takes, roughly; 0 where it was not run
  LcpReference reference;  ///< what its verdict was relative to: the problem's rounding floor (reference_floor.h)
};

using CellOutcomes = std::map<CellKey, CellOutcome>;

/// Solves every cell of the suite once, judges it, and writes problems.csv and accuracy.csv into `folder` (RESULTS.md),
/// row by row. Set-up and solve are timed apart. A reference solve finds each problem's rounding floor first, and all
/// verdicts on the problem are relative to it (reference_floor.h). A solve that crashes, hangs or runs out of memory in
/// its worker is a failure with its reason like any other; solvers that are not in the build have no rows.
CellOutcomes RunAccuracyPass(const Suite& suite, const std::string& folder);

}  // namespace lcpbench
