#pragma once

#include <cstdint>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The same contacts between bodies of very different masses: mass and inertia of every body that can move are
/// multiplied by ratio^u, u uniform in [0, 1] and stretched so that the least factor is 1 and the largest is `ratio`
/// where two bodies can move.
///
/// b stays: b = J M^-1 F + gamma holds for the new masses under loads that grow with them, as gravity does. J and b
/// stay, so a solvable problem stays solvable (J^T y = 0 and b.y are the same), and deterministic by seed.
/// @param given  by factors, columns of J in blocks of three per body
/// @param ratio  >= 1
/// @throws InputError for ratio < 1 or not finite
LcpProblem SpreadMasses(const LcpProblem& given, double ratio, std::uint64_t seed);

}  // namespace lcpbench
