#pragma once

#include <string>

#include "solvers/lcp/fresh_pass.h"
#include "solvers/peers/protocol/protocol.h"

namespace lcpbench {

/// Serves the solvers that `make` makes to the host at the other end of standard input and output (protocol.h) until
/// the host closes it or says so: one for all single solves, and one for each pass over a stream. What the solver's
/// library prints goes to standard error. Times are taken here, in the process that solves, from the arrays on.
/// @return exit status: 0 after an orderly end, 1 after a breach of the protocol
int RunWorker(const Hello& hello, const SolverFactory& make);

/// The same between two files, without taking standard output away from what a library prints.
/// @throws std::exception where a message or a problem is malformed; in words
int ServeFrames(int in, int out, const Hello& hello, const SolverFactory& make);

/// Tells the host why this worker does not start, in the place of RunWorker. False where nobody listens.
bool RefuseToStart(const std::string& why);

}  // namespace lcpbench
