#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/exact/modes/mode_answer.h"

namespace lcpbench {

/// w = A f + b without rounding, from the numbers of the given form; nothing where f, w do not solve the problem.
/// O(entries of A) rational operations
std::optional<std::vector<Rational>> GapsOfAnswer(const LcpProblem& problem, const std::vector<Rational>& f);

/// Up to this many rows the active set of a guess is tried.
inline constexpr Index kMostGuessedRows = 128;

/// What is proved of a plain problem whose A need not be symmetric nor semidefinite: the active sets of the guesses are
/// tried, then all of them where there are no more than ModeOptions::most_modes, those of 12 unilateral rows
/// (mode_search.h). Nor has a problem a solution where a unilateral row has b_i < 0 and nothing above 0 in A, while no
/// row is bilateral.
/// @param guesses  n values each; they are not trusted
ModeAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses);

}  // namespace lcpbench
