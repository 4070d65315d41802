#pragma once

#include "solvers/lcp/step_rows.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {

// Peers that may also be linked into a program beside ours or others, for they live in one process with it and their
// licences let them (BSD or LGPL, Zlib; ALGLIB's is the GPL, which is then that of the program). Each is a library of
// its own, lcpbench_linked_<folder>, of which the peer's worker is made, too: both run the same code. A solver of
// theirs that does not end takes the program with it, which a worker does not: let the worker solve a problem first.
// Not for several threads.

/// What a solver of theirs may be besides an LcpSolver: one that begins at an engine's arrays.
class SolverOfRows {
 public:
  virtual ~SolverOfRows() = default;
  /// LcpSolver::SolveArrays. @param rows  checked already
  virtual void SolveRows(const StepRows& rows, const LcpOptions& options, LcpResult* result) = 0;
};

/// Where lcpbench_linked_ode is linked.
PeerLibrary OdeLibrary();
/// Where lcpbench_linked_bullet is linked.
PeerLibrary BulletLibrary();
/// Where lcpbench_linked_alglib is linked.
PeerLibrary AlglibLibrary();

}  // namespace lcpbench
