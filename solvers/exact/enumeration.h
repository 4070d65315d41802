#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/rational.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// w = A f + b without rounding, from the numbers of the given form; nothing where f, w do not solve the problem.
/// O(entries of A) rational operations
std::optional<std::vector<Rational>> GapsOfAnswer(const LcpProblem& problem, const std::vector<Rational>& f);

/// What is proved of a problem whose A need not be symmetric nor semidefinite.
struct EnumeratedAnswer {
  LcpReference::Status status = LcpReference::Status::kUnknown;
  std::vector<Rational> f;       ///< a solution
  std::vector<Rational> w;       ///< its gaps; other solutions may have others
  std::optional<bool> f_unique;  ///< where all active sets were tried
  std::string detail;            ///< why there is no solution, or why nothing is known
};

/// Up to this many rows all 2^n active sets are tried.
inline constexpr Index kMostEnumeratedRows = 12;
/// Up to this many rows the active set of a guess is tried.
inline constexpr Index kMostGuessedRows = 128;

/// Tries active sets F (bilateral rows are in all of them): A_FF f_F = -b_F in rationals, then signs. A problem has no
/// solution where no F has one and every A_FF is nonsingular; a singular A_FF proves nothing. Nor has it one where a
/// unilateral row has b_i < 0 and nothing above 0 in A, while no row is bilateral.
/// @param guesses  n values each, whose active rows are tried first; they are not trusted
EnumeratedAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses);

}  // namespace lcpbench
