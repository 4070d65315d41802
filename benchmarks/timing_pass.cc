#include "benchmarks/timing_pass.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "benchmarks/csv.h"
#include "benchmarks/environment.h"
#include "benchmarks/progress.h"
#include "benchmarks/solver_pool.h"
#include "model/assembly.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// Of a benchmark that is not timed, in units of one that is.
constexpr double kFailureWeight = 0.01;
// Where a repetition takes long, there are fewer of them, at least one [s].
constexpr double kMostTimePerCell = 0.15;

std::string TierName(double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tier);
  return text;
}

bool TimesItself(const SolverEntry& entry) { return entry.origin != SolverOrigin::kOwn; }

// A worker solves for a whole repetition at a call: asked for one short solve at a time it would meet cold caches,
// which solvers of this process do not, and Google Benchmark would count the solves alone, and go on for minutes.
std::int64_t RepetitionsInWorker(const LcpResult& result, double min_time_s) {
  constexpr double kMost = 100'000;
  if (result.own_solve_s <= 0) return 1;
  return static_cast<std::int64_t>(std::clamp(std::ceil(min_time_s / result.own_solve_s), 1.0, kMost));
}

// One cell: a solver prepared for a problem, and the answer that was verified before any timing.
struct Cell {
  std::string name;
  LcpProblem problem;
  LcpSolver* solver = nullptr;
  LcpOptions options;
  LcpResult result;
  Verdict verdict;
  bool times_itself = false;  ///< in a worker; registered with manual time
};

// Google Benchmark calls a benchmark's function several times in a row (calibration, repetitions), and the benchmarks
// of one problem one after the other. Only the current problem and cell are kept: all of them would not fit in memory.
class CurrentCell {
 public:
  const LcpProblem& Problem(const SuiteProblem& info) {
    if (!problem_.has_value() || problem_id_ != info.id) {
      cell_.reset();
      problem_ = AssembleContactLcp(GenerateScene(info.family, info.size, info.seed)).problem;
      problem_id_ = info.id;
    }
    return *problem_;
  }

  // `reference`: as in the accuracy pass, so that both judge alike.
  Cell& Get(const std::string& name, const SuiteProblem& info, const SolverEntry& entry, double tier,
            const LcpReference& reference, const Suite& suite) {
    if (cell_ == nullptr || cell_->name != name) {
      cell_.reset();
      const LcpProblem& given = Problem(info);
      cell_ = std::make_unique<Cell>(
          Cell{name, given.CopyOfGivenForm(), &pool_.Get(entry), {}, {}, {}, TimesItself(entry)});
      cell_->options.tolerance = tier;
      cell_->options.time_limit_s = TimeLimit(suite, info.size);
      cell_->solver->Prepare(cell_->problem);
      cell_->solver->Solve(cell_->problem, cell_->options, &cell_->result);
      cell_->verdict = Verify(cell_->problem, cell_->result, tier, &reference);
      cell_->options.repetitions = RepetitionsInWorker(cell_->result, suite.min_time_s);
    }
    return *cell_;
  }

  // A solver to set up. No cell is current then.
  LcpSolver& Solver(const SolverEntry& entry) {
    cell_.reset();
    return pool_.Get(entry);
  }

 private:
  std::optional<LcpProblem> problem_;
  std::string problem_id_;
  SolverPool pool_;
  std::unique_ptr<Cell> cell_;
};

void TimeSolve(benchmark::State& state, Cell& cell) {
  if (!cell.verdict.passes) {
    state.SkipWithError(cell.verdict.reason.c_str());
    return;
  }
  for (auto _ : state) {
    cell.solver->Solve(cell.problem, cell.options, &cell.result);
    benchmark::DoNotOptimize(cell.result.f.data());
    if (!cell.times_itself) continue;
    if (cell.result.own_solve_s < 0) {  // the worker died on what it had solved before
      state.SkipWithError(("while being timed: " + cell.result.detail).c_str());
      break;
    }
    state.SetIterationTime(cell.result.own_solve_s);
  }
  state.counters["rows"] = static_cast<double>(cell.problem.size());
  state.counters["rho"] = cell.verdict.metrics.rho;
  state.counters["solver_iterations"] = static_cast<double>(cell.result.iterations);
}

// Fresh copies each time: derived forms of A and a solver's workspace are part of the set-up.
void TimeSetup(benchmark::State& state, const SuiteProblem& info, const SolverEntry& entry, CurrentCell& current) {
  const LcpProblem& given = current.Problem(info);
  for (auto _ : state) {
    const LcpProblem problem = given.CopyOfGivenForm();
    LcpSolver& solver = current.Solver(entry);
    const double start = SteadyNow();
    solver.Prepare(problem);
    state.SetIterationTime(SteadyNow() - start);
  }
  state.counters["rows"] = static_cast<double>(given.size());
}

// Advances the bar; the numbers go to the file.
class ProgressReporter : public benchmark::BenchmarkReporter {
 public:
  explicit ProgressReporter(double total) : bar_("timing  ", total) {}
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    // A benchmark reports twice: its repetitions, then their aggregates. One that failed takes no time.
    if (runs.empty() || runs.front().run_type != Run::RT_Iteration) return;
    bar_.Advance(runs.front().error_occurred ? kFailureWeight : 1, runs.front().run_name.str());
  }

 private:
  ProgressBar bar_;
};

class TimingPass {
 public:
  TimingPass(const Suite& suite, const CellOutcomes& outcomes) : suite_(suite), outcomes_(outcomes) {}

  void RegisterAll() {
    for (const SuiteProblem& info : ProblemsOf(suite_)) {
      if (info.seed != suite_.seeds.front()) continue;
      for (const std::string& key : suite_.solvers) {
        const SolverEntry& entry = FindSolver(key);
        if (entry.available) RegisterSolver(info, entry);
      }
    }
  }

  double total_weight() const { return total_weight_; }

 private:
  void RegisterSolver(const SuiteProblem& info, const SolverEntry& entry) {
    const std::string stem = info.family + "/" + std::to_string(info.size) + "/" + std::string(entry.key);
    std::vector<double> tiers = suite_.tiers;
    std::sort(tiers.begin(), tiers.end());
    bool any_passed = false;
    for (const double tier : tiers) {
      const std::string name = "solve/" + stem + "/" + TierName(tier);
      const auto outcome = outcomes_.find({info.id, std::string(entry.key), tier});
      const bool passed = outcome != outcomes_.end() && outcome->second.failure.empty();
      if (!passed) {
        RegisterFailure(name, outcome == outcomes_.end() ? "not run" : outcome->second.failure);
        continue;
      }
      // A direct method's time at its strictest passed tier stands for the looser ones.
      if (any_passed && !entry.uses_tolerance) break;
      if (outcome->second.solve_s > suite_.repeat_below_s) {
        if (entry.uses_tolerance) continue;
        break;
      }
      any_passed = true;
      const auto function = [this, name, info, &entry, tier, outcome](benchmark::State& state) {
        TimeSolve(state, current_.Get(name, info, entry, tier, outcome->second.reference, suite_));
      };
      const TimeSource source = TimesItself(entry) ? TimeSource::kWorker : TimeSource::kCall;
      Register(name, source, function, Repetitions(outcome->second.solve_s));
    }
    if (any_passed) {
      const auto function = [this, info, &entry](benchmark::State& state) { TimeSetup(state, info, entry, current_); };
      Register("setup/" + stem, TimeSource::kPart, function, 1);
    }
  }

  void RegisterFailure(const std::string& name, const std::string& reason) {
    Register(
        name, TimeSource::kCall, [reason](benchmark::State& state) { state.SkipWithError(reason.c_str()); }, 1,
        kFailureWeight);
  }

  int Repetitions(double solve_s) const {
    const double affordable = kMostTimePerCell / std::max(solve_s, suite_.min_time_s);
    return static_cast<int>(std::clamp(affordable, 1.0, static_cast<double>(suite_.repetitions)));
  }

  enum class TimeSource {
    kCall,    // the loop's body
    kPart,    // what the body says of itself
    kWorker,  // the same, of as many solves as fill a repetition
  };

  template <typename Function>
  void Register(const std::string& name, TimeSource source, Function function, int repetitions, double weight = 1) {
    auto* registered = benchmark::RegisterBenchmark(name.c_str(), std::move(function));
    registered->Unit(benchmark::kMicrosecond)->Repetitions(repetitions);
    if (source == TimeSource::kCall) {
      registered->UseRealTime();
    } else {
      registered->UseManualTime();
    }
    if (source == TimeSource::kWorker) {
      registered->Iterations(1);
    } else {
      registered->MinTime(suite_.min_time_s);
    }
    total_weight_ += weight;
  }

  const Suite& suite_;
  const CellOutcomes& outcomes_;
  CurrentCell current_;
  double total_weight_ = 0;
};

void AddContext(const Environment& environment) {
  benchmark::AddCustomContext("git_commit", environment.git_commit + (environment.git_dirty ? " (dirty)" : ""));
  benchmark::AddCustomContext("compiler", environment.compiler);
  benchmark::AddCustomContext("flags", environment.flags + " | solvers: " + environment.solver_flags);
  benchmark::AddCustomContext("cpu", environment.cpu);
  for (const auto& [name, version] : environment.libraries) benchmark::AddCustomContext(name, version);
}

}  // namespace

void RunTimingPass(const Suite& suite, const CellOutcomes& outcomes, const std::string& folder,
                   const std::vector<std::string>& extra_flags) {
  std::vector<std::string> flags = {"lcpbench", "--benchmark_out=" + folder + "/timing.json",
                                    "--benchmark_out_format=json"};
  flags.insert(flags.end(), extra_flags.begin(), extra_flags.end());
  std::vector<char*> argv;
  argv.reserve(flags.size());
  for (std::string& flag : flags) argv.push_back(flag.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw InputError(std::string("unknown Google Benchmark flag '") + argv[1] + "'");

  AddContext(DescribeEnvironment());
  TimingPass pass(suite, outcomes);
  pass.RegisterAll();
  ProgressReporter reporter(pass.total_weight());
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
}

}  // namespace lcpbench
