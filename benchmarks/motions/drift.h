#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

// Problems that change little, for measuring warm starts.

/// The same contacts a moment later under slightly different masses and loads:
///     M_k -> M_k / (1 + size u),  b -> b + J da,
/// u uniform in [-1, 1], one for a body's mass and one for its inertia; da = s M^-1/2 g with g uniform in [-1, 1] and s
/// such that |D^-1/2 J da|_2 = size |D^-1/2 b|_2: b changes by `size` in the norm that rho is relative to, spread over
/// all bodies whatever their masses and units. J, which holds what is redundant, stays: A y = 0 holds for the same y,
/// and b.y with it (J^T y = 0 on all bodies that move), so a solvable problem stays solvable.
/// @param given  by factors; bounds and facts are kept, which such a drift does not change
/// @param size   relative drift, in [0, 1)
LcpProblem Drift(const LcpProblem& given, double size, std::uint64_t seed);

/// A problem of a motion, the one before it, and how rows belong together.
struct ConsecutiveProblems {
  LcpProblem before;
  LcpProblem after;
  std::vector<int> row_before;  ///< of every row of `after`; -1: it was not there
};

/// Contacts come and go: two problems of the given rows, each without a random `part` of the unilateral ones, drawn row
/// by row. A solvable problem stays solvable with fewer of them, but for rounding.
/// @param given  by factors
/// @param part   in [0, 1)
ConsecutiveProblems LoseContacts(const LcpProblem& given, double part, std::uint64_t seed);

/// Pairs of consecutive time steps (or accelerations) of a family's motion at its own step, `spacing` steps apart; the
/// first after as many. Fewer where the motion ends, and those without rows are passed over.
/// @throws InputError for an unknown family
std::vector<ConsecutiveProblems> PairsOfMotion(const std::string& family, int size, std::uint64_t seed, int pairs,
                                               int spacing);

}  // namespace lcpbench
