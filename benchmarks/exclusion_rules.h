#pragma once

#include <span>
#include <string>
#include <string_view>

#include "solvers/registry.h"

namespace lcpbench {

// The rules by which cells of a campaign are not run. They are written down before the first solve, and every such cell
// is recorded with its rule.

/// The largest problem that a solver is given, and why.
struct SizeLimit {
  std::string_view solver;  ///< the key, or its beginning up to a '-'
  int largest;              ///< rows
  std::string_view reason;
};

/// All of them. Solvers that are not listed are given everything.
std::span<const SizeLimit> SizeLimits();

/// "" where problems of this size are given to the solver, else the rule by which they are not (SizeLimits).
std::string SizeRefusal(const SolverEntry& solver, Index size);

/// What the cells of a solver at stricter tiers are excluded by after it ran out of time at `tier` on the same problem.
std::string OutOfTimeRule(double tier);

}  // namespace lcpbench
