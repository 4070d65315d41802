#include "benchmarks/campaign/sequences/sequence_runner.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "benchmarks/campaign/task_messages.h"
#include "benchmarks/measure/speed_probe.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAllowedPart = 0.1;
constexpr double kAllowedLeast = 20e-6;
// A solve cannot be asked for no time at all.
constexpr double kLeastLimit = 1e-9;

Json KnownOrNull(double value) { return value == -1 ? Json(nullptr) : RoundedNumber(value); }

// What a pass found, step by step.
class Record {
 public:
  explicit Record(const SequenceRequest& request) : request_(request) {
    for (const double tier : request.judged) verdicts_.push_back({tier, {}, 0});
  }

  void AddTime(double latency_s, bool preempted) {
    if (preempted) preempted_.push_back(steps_);
    latency_.push_back(RoundedNumber(latency_s));
  }

  void AddAnswer(const SequenceStep& step, const LcpResult& result) {
    const Verdict verdict = Verify(step.problem, result, request_.tier, &step.reference);
    for (TierCounts& counts : verdicts_) {
      if (PassesTier(verdict.metrics, counts.tier)) continue;
      counts.failed.push_back(steps_);
      if (result.status == LcpStatus::kSolved) ++counts.false_successes;
    }
    rho_.push_back(RoundedNumber(verdict.metrics.rho));
    backward_error_.push_back(RoundedNumber(verdict.metrics.backward_error));
    w_error_.push_back(KnownOrNull(verdict.metrics.w_error));
    EndStep(result);
  }

  // An answer that is late is none.
  void AddLate(const LcpResult& result) {
    for (TierCounts& counts : verdicts_) counts.failed.push_back(steps_);
    for (Json* values : {&rho_, &backward_error_, &w_error_}) values->push_back(nullptr);
    late_.push_back(steps_);
    EndStep(result);
  }

  Json Results(int all) {
    Json results;
    results["reached"] = steps_;
    results["claims"] = claims_;
    results["verdicts"] = Json::array();
    for (TierCounts& counts : verdicts_) {
      for (int k = steps_; k < all; ++k) counts.failed.push_back(k);
      const int failed = static_cast<int>(counts.failed.size());
      results["verdicts"].push_back({{"tier", counts.tier},
                                     {"passed", all - failed},
                                     {"failed", failed},
                                     {"false_successes", counts.false_successes},
                                     {"failed_steps", counts.failed}});
    }
    results["late"] = late_;
    results["preempted"] = preempted_;
    results["latency_s"] = latency_;
    results["iterations"] = iterations_;
    results["rho"] = rho_;
    results["backward_error"] = backward_error_;
    results["w_error"] = w_error_;
    return results;
  }

 private:
  struct TierCounts {
    double tier;
    std::vector<int> failed;
    int false_successes;
  };

  void EndStep(const LcpResult& result) {
    ++claims_[std::string(ToString(result.status))];
    iterations_.push_back(result.iterations);
    ++steps_;
  }

  const SequenceRequest& request_;
  int steps_ = 0;
  std::map<std::string, int> claims_;
  std::vector<TierCounts> verdicts_;
  std::vector<int> late_;
  std::vector<int> preempted_;
  Json latency_ = Json::array();
  Json iterations_ = Json::array();
  Json rho_ = Json::array();
  Json backward_error_ = Json::array();
  Json w_error_ = Json::array();
};

}  // namespace

void SequenceRunner::Load(const SequenceRequest& request) {
  if (!steps_.empty() && sha256_ == request.sha256) return;
  steps_.clear();
  steps_ = ReadSequenceFile(request.file, request.sha256);
  sha256_ = request.sha256;
}

SequenceReply SequenceRunner::Run(const SequenceRequest& request,
                                  const std::function<void(int step, double limit_s)>& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  Load(request);
  const int all = static_cast<int>(steps_.size());
  const bool times_itself = entry.origin != SolverOrigin::kOwn;
  LcpSolver& solver = pool_.Get(entry);
  solver.SetInSequence(true);
  Record record(request);
  Eigen::VectorXd taken_on;  // by the rows of the step before; empty: nothing
  double spent = 0;
  LcpResult result;
  SequenceReply reply;
  reply.outcome = "completed";
  for (int k = 0; k < all; ++k) {
    const SequenceStep& step = steps_[static_cast<std::size_t>(k)];
    if (spent > request.budget_s) {
      reply.outcome = "budget";
      reply.detail = "the pass was ended before step " + std::to_string(k) + " of " + std::to_string(all);
      break;
    }
    const ProblemArrays arrays = ProblemArrays::Of(step.problem);
    const double limit =
        std::clamp(request.time_per_row_s * static_cast<double>(arrays.rows), request.least_s, request.most_s);
    begin(k, limit);
    LcpOptions options;
    options.tolerance = request.tier;
    options.time_limit_s = limit;
    Eigen::VectorXd start;
    if (request.warm && taken_on.size() > 0) {
      start = CarryOver(taken_on, step.previous);
      options.initial_f = &start;
    }

    // From the caller's arrays to f, set-up inside; of another process what it takes itself.
    const long long switches = InvoluntarySwitches();
    const double begun = SteadyNow();
    double latency = 0;
    if (times_itself) {
      if (request.deadline_s > 0) options.time_limit_s = request.deadline_s;
      solver.Solve(step.problem, options, &result);
      latency = result.own_fresh_s >= 0 ? result.own_fresh_s : SteadyNow() - begun;
    } else {
      const LcpProblem problem = LcpProblem::FromArrays(arrays);
      solver.Prepare(problem);
      if (request.deadline_s > 0) {
        options.time_limit_s = std::max(request.deadline_s - (SteadyNow() - begun), kLeastLimit);
      }
      solver.Solve(problem, options, &result);
      latency = SteadyNow() - begun;
    }
    const bool preempted = !times_itself && InvoluntarySwitches() != switches;
    record.AddTime(latency, preempted);
    spent += latency;
    const double allowed = request.deadline_s + std::max(kAllowedPart * request.deadline_s, kAllowedLeast);
    if (request.deadline_s > 0 && latency > allowed) {
      record.AddLate(result);
      taken_on = std::move(start);
      continue;
    }
    record.AddAnswer(step, result);
    taken_on = result.f.allFinite() ? result.f : Eigen::VectorXd();
  }
  reply.results = record.Results(all);
  return reply;
}

}  // namespace lcpbench
