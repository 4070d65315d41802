#pragma once

#include <memory>
#include <string>

#include "solvers/lcp/solver.h"
#include "solvers/registry.h"

namespace lcpbench {

/// The solver that a campaign has at work: one at a time, so that no other process takes memory meanwhile.
///
/// A solver of this process is made anew for every cell, so that its set-up pays for all of its workspace. One that
/// runs in a worker is kept with its process until another solver is wanted: to start a process is no part of solving,
/// and takes longer than most solves. A worker that ended is started again.
class SolverPool {
 public:
  /// Ready for Prepare. Valid until the next call.
  LcpSolver& Get(const SolverEntry& entry);
  /// Ends the solver, and its process.
  void Clear() { solver_.reset(); }

 private:
  std::string key_;
  std::unique_ptr<LcpSolver> solver_;
};

}  // namespace lcpbench
