#pragma once

#include <Eigen/Core>
#include <optional>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Above this many rows UniqueForces gives no answer, and where an elimination in a full matrix would take more than so
/// many operations: some tenths of a second.
inline constexpr Index kMostRowsOfUniqueForces = 1000;
inline constexpr double kMostWorkOfUniqueForces = 1e8;

/// Whether f is the only solution, as far as an approximate one tells. The solutions of a PSD problem share w; their
/// forces act on rows with w_i = 0 only, and differ by d with A d = 0 there [docs/model.md section 8, property 5]. So
///   - no:  rows that carry force clearly, and bilateral ones, are dependent: f + t d is another solution;
///   - yes: all rows but those that are clearly open (w_i > 0) are independent.
/// Ranks are those of the numbers given, by elimination modulo two primes (sparse_rank.h). "Clearly": by more than
/// 1e-6 of the largest D_ii^1/2 f_i or D_ii^-1/2 w_i, D = diag A. Nothing where neither holds, where there are friction
/// or bounded rows, A is not known to be symmetric and PSD, f does not pass 1e-6, or the problem is beyond the limits
/// above.
std::optional<bool> UniqueForces(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
