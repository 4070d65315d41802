#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/messages.h"
#include "benchmarks/measure/solver_pool.h"
#include "solvers/lcp/fresh_pass.h"
#include "solvers/lcp/problem.h"
#include "solvers/peers/protocol/external_solver.h"

namespace lcpbench {

/// Runs what a campaign asks for, within a worker process: makes the problems, solves, judges, times passes. Keeps
/// manifests, their references, and the problems of streams.
class TaskRunner {
 public:
  /// @param serve  command that serves the solver whose key is its next word
  explicit TaskRunner(std::vector<std::string> serve) : serve_(std::move(serve)) {}
  /// @param begin  called when the problem is made, and the solve begins
  /// @throws InputError for an unknown manifest, problem or solver
  JudgeReply Run(const JudgeRequest& request, const BeginPhase& begin);
  /// The same for a pass. Every solver is timed in a process of its own that has met nothing but this stream, and ends
  /// with the launch: what a process did before shows in times of microseconds.
  TimedReply Run(const TimedRequest& request, const BeginPhase& begin);

 private:
  struct Problem {
    LcpProblem problem;
    LcpReference reference;
  };
  const Problem& Get(const ProblemName& name);
  ExternalSolver& ProcessOf(const TimedRequest& request);

  std::map<std::string, std::unique_ptr<ProblemSet>> sets_;
  std::map<std::string, Problem> problems_;  // by id
  SolverPool pool_;
  std::vector<std::string> serve_;
  // The stream that arrays_ hold, by its names joined.
  std::string stream_;
  std::vector<ProblemArrays> arrays_;
  // The process that times passes, and what it was started for: solver, launch, run and stream.
  std::string launch_;
  std::unique_ptr<LcpSolver> timed_;
};

}  // namespace lcpbench
