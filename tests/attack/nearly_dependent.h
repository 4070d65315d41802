#pragma once

#include "tests/attack/attack_problem.h"

namespace lcpbench {

/// Rows of which two or three are dependent but for an angle of 1e-3 to 1e-16, beside up to two others: contacts,
/// joints or both, by factors or as A, with the status from SolveExactly. Above an angle of kClearAngle the rows of J
/// tell by themselves that there is a solution. The same seed gives the same problem, with one standard library.
/// @throws std::runtime_error where the exact answer has a fault
AttackProblem MakeNearlyDependentProblem(unsigned seed);

/// [rad]
inline constexpr double kClearAngle = 1e-13;

}  // namespace lcpbench
