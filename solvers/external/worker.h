#pragma once

#include <string>

#include "solvers/external/protocol.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Serves `solver` to the host at the other end of standard input and output (protocol.h) until the host closes it or
/// says so. What the solver's library prints goes to standard error. Times around Solve are taken here, in the process
/// that solves; a solver that reports own_solve_s itself is believed, so that adapters can leave conversions out.
/// @return exit status: 0 after an orderly end, 1 after a breach of the protocol
int RunWorker(const Hello& hello, LcpSolver& solver);

}  // namespace lcpbench
