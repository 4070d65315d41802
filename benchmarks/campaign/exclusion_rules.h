#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "solvers/registry.h"

namespace lcpbench {

// The rules by which problems of a campaign are not given to a solver. They are written down before the first solve,
// and everything that they leave out is recorded with its rule. There is one rule for each class of methods, whoever
// wrote the solver; everything else is ended by the time limit.

/// The largest problem that a solver is given, and why.
struct SizeLimit {
  std::string solver;  ///< key
  int largest;         ///< rows
  std::string_view reason;
};

/// Of all registered solvers whose class has a limit. The others are given everything.
std::vector<SizeLimit> SizeLimits();

/// "" where problems of this size are given to the solver, else the rule by which they are not.
std::string SizeRefusal(const SolverEntry& solver, Index size);

/// What the cells of a solver at stricter tiers are excluded by after it ran out of time at `tier` on the same problem.
std::string OutOfTimeRule(double tier);

}  // namespace lcpbench
