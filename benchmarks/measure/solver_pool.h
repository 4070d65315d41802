#pragma once

#include <map>
#include <memory>
#include <string>

#include "solvers/lcp/solver.h"
#include "solvers/registry.h"

namespace lcpbench {

/// The solvers of a campaign, one at a time or kept.
///
/// A solver of this process is made anew for every cell, so that its set-up pays for all of its workspace. One that
/// runs in a worker is kept with its process, which lives through the campaign: to start a process is no part of
/// solving, and takes longer than most solves. A worker that ended is started again.
class SolverPool {
 public:
  /// Ready for Prepare. Valid until the next call.
  LcpSolver& Get(const SolverEntry& entry);

 private:
  std::unique_ptr<LcpSolver> fresh_;
  std::map<std::string, std::unique_ptr<LcpSolver>> workers_;
};

}  // namespace lcpbench
