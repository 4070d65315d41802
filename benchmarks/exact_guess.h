#pragma once

#include "solvers/exact/exact_lcp.h"

namespace lcpbench {

/// Where SolveExactly starts: the answer of `dantzig`, whose active rows are independent, else of `auto`.
ExactGuess GuessBySolvers(const LcpProblem& problem);

}  // namespace lcpbench
