#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/campaign/sequences/sequence_cell.h"
#include "benchmarks/campaign/sequences/sequence_file.h"
#include "benchmarks/measure/solver_pool.h"

namespace lcpbench {

/// Runs passes over sequences, within a worker process. One solver lives through a pass, as it would in an engine, and
/// every step is timed in one interval from the caller's arrays to f, set-up inside. Answers are judged between the
/// steps, outside of what is timed. Keeps the last sequence.
///
/// With a deadline a step's set-up and solve share it: the solve's time limit is what set-up has left. An answer counts
/// that comes by the deadline plus 10 % or 20 us, whichever is more; of what is late nothing is taken on, and the next
/// step starts where this one did. Solvers in processes of their own time themselves there, from the same arrays;
/// transport between the processes, which no engine would pay, is outside.
class SequenceRunner {
 public:
  /// @param begin  called before each step with its number and what its solve may take [s]
  /// @throws InputError for an unknown solver, or as ReadSequenceFile
  SequenceReply Run(const SequenceRequest& request, const std::function<void(int step, double limit_s)>& begin);

 private:
  void Load(const SequenceRequest& request);

  std::string sha256_;
  std::vector<SequenceStep> steps_;
  SolverPool pool_;
};

}  // namespace lcpbench
