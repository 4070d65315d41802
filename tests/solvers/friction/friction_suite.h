#pragma once

#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Time steps of bodies in the plane with friction, c >= 0, so that each has a solution (docs/friction.md section 2):
/// stacks and pulled stacks, discs in rows, on ramps and in piles, walls of bricks, arches, wedges, chains with pins
/// and rods, with mu of 0.1 to 1.
/// @param most_contacts  larger ones are left out
std::vector<LcpProblem> StructuredFrictionProblems(unsigned seed, Index most_contacts);

/// 1 to `most_contacts` contacts at random between bodies with masses over four decades, mu up to 5, at times joints;
/// c >= 0.
LcpProblem RandomFrictionProblem(unsigned seed, Index most_contacts);

}  // namespace lcpbench
