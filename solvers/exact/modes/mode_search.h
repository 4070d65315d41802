#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/exact/exact_lcp.h"

namespace lcpbench {

/// All solutions, where there are no more modes than options.most_modes: linear systems in rationals, mode by mode,
/// polyhedra of the singular ones by their vertices; without those that doubles prove to have no solution
/// (mode_proof.h). Above, one solution: the modes of the guesses, where these are right, else those at the end of
/// Lemke's path (lemke_path.h). The path takes one friction row a contact, no sliding and no bounded rows (`detail`
/// says so); its end in a ray or at a limit proves nothing.
ExactAnswer SolveByModes(const ExactLcp& problem, const ExactOptions& options);

/// By SolveExactly a plain problem, by SolveByModes any other one; its answer is checked from the definitions.
ExactAnswer Certify(const ExactLcp& problem, const ExactOptions& options);

/// w = A f + b without rounding, from the numbers of the given form; nothing where f, w do not solve the problem.
/// O(entries of A) rational operations
std::optional<RationalVector> GapsOfAnswer(const LcpProblem& problem, const RationalVector& f);

/// Up to this many rows the active set of a guess is tried.
inline constexpr Index kMostGuessedRows = 128;

/// What is proved of a plain problem whose A need not be symmetric nor semidefinite: the active sets of the guesses are
/// tried, then all of them where there are no more than ExactOptions::most_modes, those of 12 unilateral rows.
/// No problem has a solution where a unilateral row has b_i < 0 and nothing above 0 in A, while no row is bilateral.
/// @param guesses  n values each; they are not trusted
ExactAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses);

}  // namespace lcpbench
