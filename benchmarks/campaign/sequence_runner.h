#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/messages.h"
#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/measure/solver_pool.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

/// What a pass found, step by step.
class StepRecord {
 public:
  /// @param judged  tiers
  explicit StepRecord(const std::vector<double>& judged);

  /// The next step. An accepted proof that it has no solution is a right answer, without a residual.
  /// @param verdict  null: the answer was late, and does not count
  void Add(const LcpResult& result, double latency_s, bool preempted, const Verdict* verdict);
  /// The members of steps.jsonl from `reached` on. Steps that were not reached count as failed.
  nlohmann::json Results(int all) const;

 private:
  struct TierCounts {
    double tier;
    std::vector<int> failed;
    int false_successes;
  };
  int steps_ = 0;
  std::map<std::string, int> claims_;
  std::vector<TierCounts> verdicts_;
  std::vector<int> late_, preempted_;
  std::map<std::string, nlohmann::json> values_;  // lists, by field
};

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
  /// @param now  the clock that steps are timed with [s]
  explicit SequenceRunner(double (*now)() = &SteadyNow) : now_(now) {}
  /// @param begin  called before steps. Not before every one: who is told wakes up, on the same processor perhaps, and
  ///               would be timed
  /// @throws InputError for an unknown solver, or as ReadSequenceFile
  SequenceReply Run(const SequenceRequest& request, const BeginPhase& begin);

 private:
  double (*now_)();
  std::string sha256_;
  std::vector<SequenceStep> steps_;
  SolverPool pool_;
};

}  // namespace lcpbench
