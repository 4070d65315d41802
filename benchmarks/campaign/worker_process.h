#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/campaign/sequences/sequence_cell.h"
#include "benchmarks/campaign/task_messages.h"

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
class WorkerProcess {
 public:
  explicit WorkerProcess(const WorkerOptions& options);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Never throws for what the solver does: the reply's claim is then crashed, killed or out_of_memory, with the reason
  /// in detail.
  /// @throws InputError where the worker refuses the request; std::runtime_error where the system gives no process
  JudgeReply Run(const JudgeRequest& request);
  /// A timed pass. The reply's outcome says how the worker ended.
  TimedReply Run(const TimedRequest& request);
  /// A pass over a sequence; every step has its own limit, and the reply's outcome says how the worker ended.
  SequenceReply Run(const SequenceRequest& request);

 private:
  // What may follow a mark: how long it may take [s], and its name in texts.
  struct Phase {
    double limit_s;
    std::string name;
  };
  // The reply to a request; none where the worker ended: then `how` is crashed, killed or out_of_memory.
  std::optional<std::string> Ask(const std::string& request,
                                 const std::function<Phase(const std::string& mark)>& phase_of, std::string* how,
                                 std::string* detail);
  void Start();
  void End();
  // A line, or none: then `how` says why.
  bool ReadLine(double limit_s, std::string* line, std::string* how);

  WorkerOptions options_;
  int pid_ = -1;
  int to_ = -1;
  int from_ = -1;
  std::string buffer_;
};

/// What the worker does: requests on standard input, one line each; replies on standard output. Lines that begin with
/// '#' say that a phase begins.
/// @return exit status
int ServeTasks();

}  // namespace lcpbench
