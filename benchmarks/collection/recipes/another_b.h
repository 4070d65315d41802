#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Another right-hand side for the same matrix, as the next step of a driver with constant geometry has it:
///     b' = b - A d,   d_i = 0.1 |D^-1/2 b|_inf D_ii^-1/2 u_i,   D = diag A,
/// u_i uniform in [0, 1) on unilateral rows and in [-1, 1) on bilateral ones, 0 where A_ii = 0. Where f is feasible for
/// b, f + d is for b', so that the problem stays solvable (but for roundings where rows depend on each other).
/// Deterministic by seed.  O(entries of the given form)
Eigen::VectorXd AnotherB(const LcpProblem& problem, std::uint64_t seed);

}  // namespace lcpbench
