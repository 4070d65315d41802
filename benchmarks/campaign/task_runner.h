#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "benchmarks/campaign/messages.h"
#include "benchmarks/measure/solver_pool.h"
#include "solvers/lcp/fresh_pass.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Runs what a campaign asks for, within a worker process: makes the problems, solves, judges, times passes. Keeps
/// manifests, their references, and the problems of streams.
class TaskRunner {
 public:
  TaskRunner();
  ~TaskRunner();

  /// @param begin  called when the problem is made, and the solve begins: its length is what the caller limits
  /// @throws InputError for an unknown manifest, problem or solver
  JudgeReply Run(const JudgeRequest& request, const std::function<void()>& begin);
  /// The same for a pass.
  TimedReply Run(const TimedRequest& request, const std::function<void()>& begin);

 private:
  struct Set;
  struct Problem;
  const Problem& Get(const ProblemName& name);
  Set& Load(const std::string& manifest);
  // By tier of `judged`, whether f is verified. An answer that was judged before is known by a hash of its bits: a
  // solver that gives the same bits in every pass is judged once.
  const std::vector<bool>& Passes(const Problem& given, const Eigen::VectorXd& f, const std::vector<double>& judged);
  PassReply RunOwnOrForeign(const TimedRequest& request, const std::function<void()>& begin);

  std::map<std::string, std::unique_ptr<Set>> sets_;
  std::map<std::string, std::unique_ptr<Problem>> kept_;  // of streams, by id
  std::unique_ptr<Problem> large_;                        // the last one that is too large to be kept
  std::unordered_map<std::size_t, std::vector<bool>> judged_;
  SolverPool pool_;
  // The stream that arrays_ hold, by its names joined, and the one that a worker of another process was given last.
  std::string stream_;
  std::vector<ProblemArrays> arrays_;
  std::map<std::string, std::string> loaded_;
};

}  // namespace lcpbench
