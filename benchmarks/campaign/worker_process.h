#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/campaign/messages.h"
#include "support/subprocess.h"

namespace lcpbench {

struct WorkerOptions {
  std::string program = "/proc/self/exe";     ///< this one: a program whose command campaign-worker is ServeTasks
  std::vector<std::string> solver_arguments;  ///< of the command line, by which the user named solvers
  std::uint64_t memory_bytes = 0;             ///< address space; 0 for none; not kept under sanitizers
  int cpu = -1;                               ///< the processor it is kept on; -1: any
  double make_s = 300;                        ///< for making a problem
  /// What a solve may take beyond its limit, by the limit and besides [s]. Solvers that keep their limits need less.
  double grace_share = 0.5;
  double grace_s = 2;
};

/// This program run again as a worker that runs one request after the other, so that a solver that crashes, hangs or
/// takes all memory is an outcome. It lives on from request to request; one that ended is started anew.
///
/// Run never throws for what the solver does: the reply's outcome is then crashed, killed or out_of_memory, with the
/// reason in detail. A worker that was killed by SIGKILL or SIGTERM which was not sent from here says nothing of the
/// solver: the request is tried once more by a new one, and Reply::retried says so; a second time it is crashed.
/// @throws InputError where the worker refuses the request; std::runtime_error where the system gives no process
class WorkerProcess {
 public:
  explicit WorkerProcess(WorkerOptions options) : options_(std::move(options)) {}

  JudgeReply Run(const JudgeRequest& request);
  TimedReply Run(const TimedRequest& request);
  SequenceReply Run(const SequenceRequest& request);

 private:
  template <typename Answer, typename Message>
  Answer Request(const Message& request);
  /// @param by_others  whether something else killed the worker
  template <typename Answer, typename Message>
  Answer RequestOnce(const Message& request, bool* by_others);

  WorkerOptions options_;
  std::unique_ptr<Subprocess> process_;
};

/// What the worker does: requests on standard input, one line each; replies on standard output. Lines that begin with
/// '#' say that a phase begins, as BeginPhase: "# LIMIT NAME".
/// @param solver_arguments  WorkerOptions::solver_arguments, as this process got them
/// @return exit status
int ServeTasks(const std::vector<std::string>& solver_arguments);

}  // namespace lcpbench
