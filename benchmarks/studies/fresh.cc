#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/measure/quantile.h"
#include "benchmarks/studies/step_arrays.h"
#include "benchmarks/studies/studies.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "solvers/step/step_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// StepSolver on an engine's arrays, which are made off the clock. Which problem is wanted is known by the address of
// its arrays in the stream.
class SolverOfSteps final : public LcpSolver {
 public:
  SolverOfSteps(const FreshStream& stream, const PassRequest& request)
      : first_(stream.arrays.data()),
        solver_(StepOptions{.tolerance = request.tolerance, .time_limit_s = request.time_limit_s}) {
    for (const LcpProblem& problem : stream.problems) {
      if (!problem.has_factors() || !problem.has_two_body_rows()) {
        throw InputError("problem '" + problem.id() + "' has rows on more than two bodies, or A itself");
      }
      steps_.push_back(StepArrays::Of(problem));
    }
    for (const StepArrays& step : steps_) rows_.push_back(step.View());
  }

  bool TakesFriction() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* /*result*/) override {
    throw std::logic_error("steps are solved from arrays");
  }
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& /*options*/, LcpResult* result) override {
    const StepRows& rows = rows_[static_cast<std::size_t>(&arrays - first_)];
    result->f.resize(rows.rows);
    result->status = solver_.Solve(rows, nullptr, result->f.data()).status;
    return true;
  }

 private:
  const ProblemArrays* first_;
  StepSolver solver_;
  std::vector<StepArrays> steps_;
  std::vector<StepRows> rows_;  // views of steps_
};

// `auto` on an LcpProblem that is made of the arrays, on the clock.
class SolverOfProblems final : public LcpSolver {
 public:
  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    solver_->Solve(problem, options, result);
  }
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override {
    DoSolve(LcpProblem::FromArrays(arrays), options, result);
    return true;
  }

 private:
  std::unique_ptr<LcpSolver> solver_ = MakeSolver("auto");
};

// A solver on a stream.
class FreshBenchmark {
 public:
  FreshBenchmark(const CampaignPlan& plan, FreshProblems* problems, FreshStream* stream, const std::string& solver)
      : plan_(plan),
        problems_(problems),
        stream_(stream),
        solver_(solver),
        entry_(FindSolver(solver == kStepSolver || solver == kFromProblem ? "auto" : solver)) {
    if (!entry_.available) throw InputError("solver '" + solver + "' is not in this build");
  }

  void Run(benchmark::State& state) {
    problems_->Load(stream_);
    try {
      if (right_.empty()) Judge();
      const PassRequest request = PlanNext();
      const PassReply reply = request.order.empty() ? PassReply() : Time(request);
      for (std::size_t k = 0; k < reply.entries.size(); ++k) {
        const std::size_t place = request.order[k];
        if (!IsRight(place, reply.entries[k].f)) right_[place] = false;
      }
      Report(request, reply, state);
    } catch (const WorkerFailure& failure) {
      state.SkipWithError(failure.what());
    } catch (const InputError& error) {
      state.SkipWithError(error.what());
    }
  }

 private:
  double tier() const { return plan_.tiers.front(); }

  bool IsRight(std::size_t place, const Eigen::VectorXd& f) const {
    return PassesTier(ComputeMetrics(stream_->problems[place], f, &stream_->references[place]), tier());
  }

  // Which problems it solves, each by itself and within its limit.
  void Judge() {
    const std::unique_ptr<LcpSolver> solver = entry_.make({});
    if (auto* external = dynamic_cast<ExternalSolver*>(solver.get())) external->Greet();
    LcpOptions options;
    options.tolerance = tier();
    LcpResult result;
    right_.assign(stream_->problems.size(), false);
    for (std::size_t place = 0; place < right_.size(); ++place) {
      const LcpProblem& problem = stream_->problems[place];
      if (!SizeRefusal(entry_, problem.size()).empty()) continue;
      options.time_limit_s = plan_.limits.Of(problem.size());
      solver->Solve(problem, options, &result);
      right_[place] = IsRight(place, result.f);
    }
  }

  // The next pass over what it solves.
  PassRequest PlanNext() {
    std::vector<std::size_t> places;
    Index most_rows = 0;
    for (std::size_t place = 0; place < right_.size(); ++place) {
      if (!right_[place]) continue;
      places.push_back(place);
      most_rows = std::max(most_rows, stream_->problems[place].size());
    }
    PassRequest request = PlanPass(places, PassKind::kFresh, plan_.seed, ++passes_);
    request.tolerance = tier();
    request.time_limit_s = plan_.limits.Of(most_rows);
    request.settle_s = plan_.launches.settle_s;
    return request;
  }

  // Own solvers in this process, peers in a worker that is started for it.
  PassReply Time(const PassRequest& request) const {
    const auto make = [&]() -> std::unique_ptr<LcpSolver> {
      if (solver_ == kStepSolver) return std::make_unique<SolverOfSteps>(*stream_, request);
      if (solver_ == kFromProblem) return std::make_unique<SolverOfProblems>();
      return entry_.make({});
    };
    if (entry_.origin == SolverOrigin::kOwn) return RunPass(make, stream_->arrays, request);
    const std::unique_ptr<LcpSolver> solver = make();
    auto& external = dynamic_cast<ExternalSolver&>(*solver);
    external.LoadStream(stream_->arrays);
    return external.RunPass(request, PassLimit(request));
  }

  void Report(const PassRequest& request, const PassReply& reply, benchmark::State& state) const {
    const std::vector<PlannedProblem>& planned = stream_->planned;
    double all = 0;
    double right = 0;
    for (std::size_t place = 0; place < planned.size(); ++place) {
      all += planned[place].weight;
      if (right_[place]) right += planned[place].weight;
    }
    std::vector<std::pair<double, double>> times;  // with weights
    double timed = 0;
    for (std::size_t k = 0; k < reply.entries.size(); ++k) {
      const std::size_t place = request.order[k];
      if (!right_[place]) continue;
      times.emplace_back(reply.entries[k].seconds, planned[place].weight);
      timed += planned[place].weight;
    }
    // What warmed up is right and has no time: the others that are right stand for it.
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (!times.empty() && right < all) times.emplace_back(kInfinity, (all - right) * timed / right);
    const double median = times.empty() ? kInfinity : WeightedQuantile(times, 0.5);
    if (std::isinf(median)) {
      state.SkipWithError("not right on half");
      return;
    }
    for (auto _ : state) state.SetIterationTime(median);
    state.counters["right"] = right / all;
    state.counters["problems"] = static_cast<double>(planned.size());
    if (reply.disturbance) state.counters["cpu_share"] = reply.disturbance->cpu_share;
  }

  const CampaignPlan& plan_;
  FreshProblems* problems_;
  FreshStream* stream_;
  std::string solver_;
  SolverEntry entry_;
  std::vector<bool> right_;  // problems that it solves; empty before the first pass
  int passes_ = 0;
};

}  // namespace

void RegisterFresh(const CampaignPlan& plan, FreshProblems* problems) {
  for (FreshStream* stream : problems->streams()) {
    for (const std::string& solver : plan.solvers) {
      const auto fresh = std::make_shared<FreshBenchmark>(plan, problems, stream, solver);
      const std::string name = "fresh/" + stream->name + "/" + solver;
      benchmark::RegisterBenchmark(name.c_str(), [fresh](benchmark::State& state) { fresh->Run(state); })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace lcpbench
