#include "benchmarks/campaign/sequence_runner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/measure/speed_probe.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

constexpr double kAllowedPart = 0.1;
constexpr double kAllowedLeast = 20e-6;
// A solve cannot be asked for no time at all.
constexpr double kLeastLimit = 1e-9;

}  // namespace

StepRecord::StepRecord(const std::vector<double>& judged, double tier) : tier_(tier) {
  for (const double at : judged) verdicts_.push_back({at, {}, 0});
  for (const char* field : {"latency_s", "iterations", "rho", "backward_error", "w_error"}) {
    values_[field] = Json::array();
  }
}

void StepRecord::AddTime(double latency_s, bool preempted) {
  if (preempted) preempted_.push_back(steps_);
  values_["latency_s"].push_back(Json(RoundedNumber(latency_s)));
}

void StepRecord::AddAnswer(const SequenceStep& step, const LcpResult& result) {
  const Metrics metrics = Verify(step.problem, result, tier_, &step.reference).metrics;
  for (TierCounts& counts : verdicts_) {
    if (PassesTier(metrics, counts.tier)) continue;
    counts.failed.push_back(steps_);
    if (result.status == LcpStatus::kSolved) ++counts.false_successes;
  }
  Add(result, RoundedNumber(metrics.rho), RoundedNumber(metrics.backward_error),
      metrics.w_error == -1 ? Json(nullptr) : Json(RoundedNumber(metrics.w_error)));
}

void StepRecord::AddLate(const LcpResult& result) {
  for (TierCounts& counts : verdicts_) counts.failed.push_back(steps_);
  late_.push_back(steps_);
  Add(result, nullptr, nullptr, nullptr);
}

void StepRecord::Add(const LcpResult& result, const Json& rho, const Json& backward_error, const Json& w_error) {
  values_["rho"].push_back(rho);
  values_["backward_error"].push_back(backward_error);
  values_["w_error"].push_back(w_error);
  values_["iterations"].push_back(result.iterations);
  ++claims_[std::string(ToString(result.status))];
  ++steps_;
}

Json StepRecord::Results(int all) const {
  Json results(values_);
  results["reached"] = steps_;
  results["claims"] = claims_;
  results["late"] = late_;
  results["preempted"] = preempted_;
  results["verdicts"] = Json::array();
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

SequenceReply SequenceRunner::Run(const SequenceRequest& request,
                                  const std::function<void(int step, double limit_s)>& begin) {
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
  StepRecord record(request.judged, request.tier);
  Eigen::VectorXd taken_on;  // by the rows of the step before; empty: nothing
  double spent = 0;
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
