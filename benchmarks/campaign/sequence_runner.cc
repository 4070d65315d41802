#include "benchmarks/campaign/sequence_runner.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>

#include "benchmarks/speed_probe.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAllowedPart = 0.1;
constexpr double kAllowedLeast = 20e-6;
// A solve cannot be asked for no time at all.
constexpr double kLeastLimit = 1e-9;

// A campaign has some 10^7 of these numbers; a clock knows no more digits of a time, and nobody asks for more of an
// error.
Json Rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[24];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

Json KnownOrNull(double value) { return value == -1 ? Json(nullptr) : Rounded(value); }

// What a pass found, step by step.
class Record {
 public:
  Record(const SequenceRequest& request, bool times_itself) : request_(request), times_itself_(times_itself) {
    for (const double tier : request.judged) verdicts_.push_back({tier, {}, 0});
  }

  void AddTimes(double setup_s, double solve_s, double convert_s, bool preempted) {
    if (preempted) preempted_.push_back(steps_);
    setup_.push_back(Rounded(setup_s));
    solve_.push_back(Rounded(solve_s));
    convert_.push_back(Rounded(convert_s));
  }

  void AddAnswer(const SequenceStep& step, const LcpResult& result) {
    const Verdict verdict = Verify(step.problem, result, request_.tier, &step.reference);
    for (TierCounts& counts : verdicts_) {
      if (PassesTier(verdict.metrics, counts.tier)) continue;
      counts.failed.push_back(steps_);
      if (result.status == LcpStatus::kSolved) ++counts.false_successes;
    }
    rho_.push_back(Rounded(verdict.metrics.rho));
    backward_error_.push_back(Rounded(verdict.metrics.backward_error));
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
    results["setup_s"] = setup_;
    results["solve_s"] = solve_;
    results["convert_s"] = times_itself_ ? convert_ : Json(nullptr);
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
  bool times_itself_;
  int steps_ = 0;
  std::map<std::string, int> claims_;
  std::vector<TierCounts> verdicts_;
  std::vector<int> late_;
  std::vector<int> preempted_;
  Json setup_ = Json::array();
  Json solve_ = Json::array();
  Json convert_ = Json::array();
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
  Record record(request, times_itself);
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
    // Of its own copy: set-up pays for every form of A that the solver reads.
    const LcpProblem problem = step.problem.CopyOfGivenForm();
    const double limit =
        std::clamp(request.time_per_row_s * static_cast<double>(problem.size()), request.least_s, request.most_s);
    begin(k, limit);
    LcpOptions options;
    options.tolerance = request.tier;
    options.time_limit_s = limit;
    Eigen::VectorXd start;
    if (request.warm && taken_on.size() > 0) {
      start = CarryOver(taken_on, step.previous);
      options.initial_f = &start;
    }

    const long long switches = InvoluntarySwitches();
    const double begun = SteadyNow();
    solver.Prepare(problem);
    const double prepared = SteadyNow();
    if (request.deadline_s > 0) {
      options.time_limit_s = std::max(request.deadline_s - (times_itself ? 0 : prepared - begun), kLeastLimit);
    }
    solver.Solve(problem, options, &result);
    const double solved = SteadyNow();
    const bool preempted = !times_itself && InvoluntarySwitches() != switches;

    const bool has_own = times_itself && result.own_solve_s >= 0;
    const double solve_s = has_own ? result.own_solve_s : solved - prepared;
    const double convert_s = has_own ? std::max(0.0, result.own_convert_s) : 0;
    const double latency = solve_s + convert_s + (times_itself ? 0 : prepared - begun);
    record.AddTimes(prepared - begun, solve_s, convert_s, preempted);
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
