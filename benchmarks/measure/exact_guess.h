#pragma once

#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where SolveExactly starts: the answer of `dantzig`, whose active rows are independent, else of `auto`.
ExactGuess GuessBySolvers(const LcpProblem& problem);

/// Where RefineReference starts: the answer of `auto`.
LcpResult SolveNearly(const LcpProblem& problem);

}  // namespace lcpbench
