#include "benchmarks/campaign/sequence_runner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "support/process_watch.h"

namespace lcpbench {
namespace {

constexpr double kAllowedPart = 0.1;
constexpr double kAllowedLeast = 20e-6;
// A solve cannot be asked for no time at all.
constexpr double kLeastLimit = 1e-9;
constexpr double kSecondsBetweenSteps = 0.2;  // that are told of

bool ShowsThereIsNoSolution(const LcpResult& result, const Verdict& verdict) {
  return result.status == LcpStatus::kInfeasible && verdict.farkas && verdict.farkas->accepted &&
         !verdict.false_infeasible;
}

}  // namespace

StepRecord::StepRecord(const std::vector<double>& judged) {
  for (const double tier : judged) verdicts_.push_back({tier, {}, 0});
  for (const char* field : {"latency_s", "iterations", "rho", "backward_error", "w_error"}) {
    values_[field] = nlohmann::json::array();
  }
}

void StepRecord::Add(const LcpResult& result, double latency_s, bool preempted, const Verdict* verdict) {
  const bool has_none = verdict != nullptr && ShowsThereIsNoSolution(result, *verdict);
  const Metrics* metrics = verdict == nullptr || has_none ? nullptr : &verdict->metrics;
  for (TierCounts& counts : verdicts_) {
    if (has_none || (metrics != nullptr && PassesTier(*metrics, counts.tier))) continue;
    counts.failed.push_back(steps_);
    if (metrics != nullptr && result.status == LcpStatus::kSolved) ++counts.false_successes;
  }
  if (verdict == nullptr) late_.push_back(steps_);
  if (preempted) preempted_.push_back(steps_);
  const auto add = [&](const char* field, double Metrics::*number) {
    const bool known = metrics != nullptr && metrics->*number != -1;
    values_[field].push_back(known ? nlohmann::json(RoundedNumber(metrics->*number)) : nlohmann::json(nullptr));
  };
  add("rho", &Metrics::rho);
  add("backward_error", &Metrics::backward_error);
  add("w_error", &Metrics::w_error);
  values_["latency_s"].push_back(nlohmann::json(RoundedNumber(latency_s)));
  values_["iterations"].push_back(result.iterations);
  ++claims_[std::string(ToString(result.status))];
  ++steps_;
}

nlohmann::json StepRecord::Results(int all) const {
  nlohmann::json results(values_);
  results["reached"] = steps_;
  results["claims"] = claims_;
  results["late"] = late_;
  results["preempted"] = preempted_;
  results["verdicts"] = nlohmann::json::array();
  for (const TierCounts& counts : verdicts_) {
    std::vector<int> failed = counts.failed;
    for (int k = steps_; k < all; ++k) failed.push_back(k);
    results["verdicts"].push_back({{"tier", counts.tier},
                                   {"passed", all - static_cast<int>(failed.size())},
                                   {"failed", failed.size()},
                                   {"false_successes", counts.false_successes},
                                   {"failed_steps", failed}});
  }
  return results;
}

SequenceReply SequenceRunner::Run(const SequenceRequest& request, const BeginPhase& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  if (steps_.empty() || sha256_ != request.sha256) {
    steps_.clear();
    steps_ = ReadSequenceFile(request.file, request.sha256);
    sha256_ = request.sha256;
  }
  const int all = static_cast<int>(steps_.size());
  const bool times_itself = entry.origin != SolverOrigin::kOwn;
  LcpSolver& solver = pool_.Get(entry);
  solver.SetInSequence(true);
  StepRecord record(request.judged);
  Eigen::VectorXd taken_on;  // by the rows of the step before; empty: nothing
  double spent = 0;
  double told = -kSecondsBetweenSteps;
  LcpResult result;
  SequenceReply reply;
  for (int k = 0; k < all; ++k) {
    const SequenceStep& step = steps_[static_cast<std::size_t>(k)];
    if (spent > request.budget_s) {
      reply.outcome = "budget";
      reply.detail = "the pass was ended before step " + std::to_string(k) + " of " + std::to_string(all);
      break;
    }
    const ProblemArrays arrays = ProblemArrays::Of(step.problem);
    const double limit = request.limits.Of(arrays.rows);
    if (const double now = SteadyNow(); now - told >= kSecondsBetweenSteps) {
      told = now;
      begin((times_itself ? 2 : 1) * limit + kSecondsBetweenSteps, "in step " + std::to_string(k) + " or soon after");
    }
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
    const double begun = now_();
    double latency = 0;
    if (times_itself) {
      if (request.deadline_s > 0) options.time_limit_s = request.deadline_s;
      solver.Solve(step.problem, options, &result);
      latency = result.own_fresh_s >= 0 ? result.own_fresh_s : now_() - begun;
    } else {
      const LcpProblem problem = LcpProblem::FromArrays(arrays);
      solver.Prepare(problem);
      if (request.deadline_s > 0) {
        options.time_limit_s = std::max(request.deadline_s - (now_() - begun), kLeastLimit);
      }
      solver.Solve(problem, options, &result);
      latency = now_() - begun;
    }
    const bool preempted = !times_itself && InvoluntarySwitches() != switches;
    spent += latency;
    const double allowed = request.deadline_s + std::max(kAllowedPart * request.deadline_s, kAllowedLeast);
    if (request.deadline_s > 0 && latency > allowed) {
      record.Add(result, latency, preempted, nullptr);
      taken_on = std::move(start);
      continue;
    }
    const Verdict verdict = Verify(step.problem, result, request.tier, &step.reference);
    record.Add(result, latency, preempted, &verdict);
    taken_on = result.f.allFinite() ? result.f : Eigen::VectorXd();
  }
  reply.results = record.Results(all);
  if (auto* external = dynamic_cast<ExternalSolver*>(&solver)) reply.retried = external->TakeRetried();
  return reply;
}

}  // namespace lcpbench
