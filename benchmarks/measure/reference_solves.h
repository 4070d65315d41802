#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/modes/mode_proof.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where SolveExactly starts: the answer of `dantzig`, whose active rows are independent, else of `auto`.
ExactGuess GuessBySolvers(const LcpProblem& problem);

/// Where RefineReference starts: the answer of `auto`.
LcpResult SolveNearly(const LcpProblem& problem);

/// What is known in doubles of a problem with friction, sliding or bounded rows.
struct ModeGuess {
  ModeProof proof;                 ///< the best one
  std::vector<std::string> modes;  ///< that may have a solution, the most likely ones first
};

/// From the answers of solvers that take the rows, one after the other, until modes are proved.
ModeGuess GuessModes(const LcpProblem& problem);

/// Options of Certify that start from both guesses.
/// @param problem  not owned; must outlive the options
ExactOptions FromSolvers(const LcpProblem& problem, double time_limit_s);

/// Whether f, which passes `tolerance`, is the only solution: by ranks (unique_forces.h); where those leave it open, a
/// solution of least norm that is clearly another one says no, up to 300 rows.
std::optional<bool> IsOnlyAnswer(const LcpProblem& problem, const Eigen::VectorXd& f, double tolerance);

/// The floor that all verdicts on one problem are relative to, found without any of the judged answers: where f is not
/// unique, a solver that returns a huge self-stress must not loosen its own verdict.
///
/// Own solvers with their default options are asked one by one, with `tolerance` and a time limit for each. An answer
/// counts where it passes tier `tolerance` relative to *its own* floor, and the least floor of those wins. The first
/// answer settles it unless its floor exceeds `tolerance`: a smaller floor changes no verdict.
/// Sizes at which a solver is not run in a campaign (SizeRefusal) hold here, too. Solvers that are not in the build are
/// passed over. Costs a solve, up to four where the first one's floor matters or nothing is verified.
///
/// @param tolerance     the strictest tier that will be judged, in (0, 1)
/// @param time_limit_s  of each solve, > 0
/// @return nothing where no answer was verified
std::optional<double> FindReferenceFloor(const LcpProblem& problem, double tolerance, double time_limit_s);

}  // namespace lcpbench
