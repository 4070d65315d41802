#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/messages.h"
#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/measure/solver_pool.h"

namespace lcpbench {

/// What a pass found, step by step.
class StepRecord {
 public:
  /// @param tier  asked for
  StepRecord(const std::vector<double>& judged, double tier);

  void AddTime(double latency_s, bool preempted);
  void AddAnswer(const SequenceStep& step, const LcpResult& result);
  /// An answer that is late is none.
  void AddLate(const LcpResult& result);
  /// The members of steps.jsonl from `reached` on. Steps that were not reached count as failed.
  nlohmann::json Results(int all) const;

 private:
  struct TierCounts {
    double tier;
    std::vector<int> failed;
    int false_successes;
  };
  // Numbers of the step, which ends here; null for none.
  void Add(const LcpResult& result, const nlohmann::json& rho, const nlohmann::json& backward_error,
           const nlohmann::json& w_error);

  double tier_;
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
  /// @param begin  called before each step with its number and what its solve may take [s]
  /// @throws InputError for an unknown solver, or as ReadSequenceFile
  SequenceReply Run(const SequenceRequest& request, const std::function<void(int step, double limit_s)>& begin);

 private:
  double (*now_)();
  std::string sha256_;
  std::vector<SequenceStep> steps_;
  SolverPool pool_;
};

}  // namespace lcpbench
