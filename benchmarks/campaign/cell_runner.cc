#include "benchmarks/campaign/cell_runner.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "benchmarks/allocation_count.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/peak_memory.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/metric_table.h"

namespace lcpbench {

struct CellRunner::Set {
  explicit Set(const std::string& path)
      : manifest(ReadManifest(path)), source(FolderOf(path)), references(manifest, FolderOf(path)) {
    for (const ManifestEntry& entry : manifest.problems) entries[entry.id] = &entry;
  }
  static std::string FolderOf(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

  Manifest manifest;
  ProblemSource source;
  References references;
  std::map<std::string, const ManifestEntry*> entries;
};

namespace {

using Json = nlohmann::json;

CellVerdict Describe(const Verdict& verdict, LcpStatus claim, double tier) {
  CellVerdict described;
  described.tier = tier;
  described.passes = verdict.passes;
  if (verdict.best_tier > 0) described.best_tier = verdict.best_tier;
  described.at_floor = verdict.at_floor;
  described.false_success = verdict.false_success;
  described.false_infeasible = verdict.false_infeasible;
  described.proved_infeasible = claim == LcpStatus::kInfeasible && verdict.farkas && verdict.farkas->accepted;
  described.reason = verdict.reason;
  return described;
}

Json Describe(const Metrics& metrics) {
  Json json = Json::object();
  for (const MetricEntry& entry : AllMetrics()) {
    const double value = metrics.*entry.value;
    json[std::string(entry.key)] = std::isfinite(value) && value != -1 ? Json(value) : Json(nullptr);
  }
  return json;
}

// Takes the time of every repetition.
class TimeCollector : public benchmark::BenchmarkReporter {
 public:
  explicit TimeCollector(std::vector<double>* times) : times_(times) {}
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred || run.iterations == 0) continue;
      times_->push_back(run.real_accumulated_time / static_cast<double>(run.iterations));
    }
  }

 private:
  std::vector<double>* times_;
};

// A worker solves for a whole repetition at a call: asked for one short solve at a time it would meet cold caches.
std::int64_t RepetitionsInWorker(double solve_s, double min_time_s) {
  constexpr double kMost = 100'000;
  if (solve_s <= 0) return 1;
  return static_cast<std::int64_t>(std::clamp(std::ceil(min_time_s / solve_s), 1.0, kMost));
}

// Every repetition is a run of Google Benchmark of at least min_time_s, so that short solves are many; with cold caches
// it is a single solve.
class Repeater {
 public:
  Repeater(LcpSolver& solver, const LcpProblem& problem, const LcpOptions& options, bool times_itself,
           CacheFlush* flush)
      : solver_(solver), problem_(problem), options_(options), times_itself_(times_itself), flush_(flush) {}

  void Run(int repetitions, double min_time_s, LcpResult* result, CellReply* reply) {
    const bool single = flush_ != nullptr;
    if (times_itself_ && !single) options_.repetitions = RepetitionsInWorker(result->own_solve_s, min_time_s);
    benchmark::ClearRegisteredBenchmarks();
    auto* registered = benchmark::RegisterBenchmark("solve", [&](benchmark::State& state) {
      for (auto _ : state) {
        const double solve_s = Solve(result);
        if (!times_itself_ && !single) continue;
        if (solve_s < 0) {
          state.SkipWithError("the solver's process ended");
          break;
        }
        state.SetIterationTime(solve_s);
        if (result->own_convert_s >= 0) reply->convert_s.push_back(result->own_convert_s);
      }
    });
    registered->Unit(benchmark::kSecond)->Repetitions(repetitions)->ReportAggregatesOnly(false);
    if (times_itself_ || single) {
      registered->UseManualTime()->Iterations(1);
    } else {
      registered->UseRealTime()->MinTime(min_time_s);
    }
    TimeCollector collector(&reply->solve_s);
    benchmark::RunSpecifiedBenchmarks(&collector, "solve");
    benchmark::ClearRegisteredBenchmarks();
  }

 private:
  // Returns the solve's time where Google Benchmark does not take it.
  double Solve(LcpResult* result) {
    if (flush_ == nullptr) {
      solver_.Solve(problem_, options_, result);
      benchmark::DoNotOptimize(result->f.data());
      return result->own_solve_s;
    }
    flush_->Run();
    const double start = SteadyNow();
    solver_.Solve(problem_, options_, result);
    const double solve_s = SteadyNow() - start;
    return times_itself_ ? result->own_solve_s : solve_s;
  }

  LcpSolver& solver_;
  const LcpProblem& problem_;
  LcpOptions options_;
  bool times_itself_;
  CacheFlush* flush_;
};

// Counts allocations while it lives.
class AllocationWatch {
 public:
  AllocationWatch() {
    CountAllocations(true);
    count_ = AllocationCount();
    bytes_ = AllocatedBytes();
  }
  ~AllocationWatch() { CountAllocations(false); }
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;
  std::int64_t count() const { return AllocationCount() - count_; }
  std::int64_t bytes() const { return AllocatedBytes() - bytes_; }

 private:
  long count_ = 0;
  long bytes_ = 0;
};

void NoteFactorisations(const LcpResult& result, double solve_s, CellReply* reply) {
  if (result.factor_s < 0) return;
  reply->factor_s = result.factor_s;
  reply->factor_of_s = solve_s;
}

// Of a solver that has settled, as those that were timed, but observed.
void SolveLast(LcpSolver& solver, const LcpProblem& problem, LcpOptions options, LcpResult* result, CellReply* reply) {
  options.time_factorisations = true;
  const AllocationWatch allocations;
  const double start = SteadyNow();
  solver.Solve(problem, options, result);
  NoteFactorisations(*result, SteadyNow() - start, reply);
  if (reply->allocations) reply->allocations->later = allocations.count();
}

}  // namespace

CellRunner::CellRunner() = default;
CellRunner::~CellRunner() = default;

CellRunner::Set& CellRunner::Load(const std::string& manifest) {
  std::unique_ptr<Set>& set = sets_[manifest];
  if (!set) set = std::make_unique<Set>(manifest);
  return *set;
}

const LcpProblem& CellRunner::Make(const CellRequest& request) {
  if (problem_.has_value() && problem_id_ == request.problem) return *problem_;
  problem_.reset();
  Set& set = Load(request.manifest);
  const auto entry = set.entries.find(request.problem);
  if (entry == set.entries.end()) {
    throw InputError(request.manifest + ": expected a problem '" + request.problem + "', found none");
  }
  problem_ = set.source.Get(*entry->second);
  problem_id_ = request.problem;
  const std::optional<KnownAnswer> known = set.references.Find(*problem_);
  reference_ = known ? known->reference : LcpReference{};
  return *problem_;
}

CellReply CellRunner::Run(const CellRequest& request, const std::function<void(Phase)>& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  const LcpProblem& given = Make(request);
  LcpOptions options;
  options.tolerance = request.tier;
  options.time_limit_s = request.time_limit_s;
  const bool times_itself = entry.origin != SolverOrigin::kOwn;
  if (request.mode == kColdCache && !flush_) flush_.emplace();
  CacheFlush* const flush = request.mode == kColdCache ? &*flush_ : nullptr;

  CellReply reply;
  begin(Phase::kSolve);
  // Of its own copy: set-up pays for every form of A that the solver reads.
  const LcpProblem problem = given.CopyOfGivenForm();
  LcpSolver& solver = pool_.Get(entry);
  const DisturbanceWatch watch;
  ResetPeak();
  const double start = SteadyNow();
  solver.Prepare(problem);
  reply.setup_s.push_back(SteadyNow() - start);
  LcpResult result;
  const double first_s = SolveFirst(solver, problem, options, times_itself, flush, &result, &reply);
  reply.first_s = first_s;
  // Without what was walked to empty the caches.
  if (!times_itself) reply.peak_bytes = PeakBytes() - static_cast<double>(flush_ ? flush_->bytes() : 0);
  begin(Phase::kRepeat);

  reply.claim = ToString(result.status);
  reply.iterations = result.iterations;
  reply.detail = result.detail;
  bool passes = false;
  for (const double tier : request.judged) {
    const Verdict verdict = Verify(given, result, tier, &reference_);
    passes = passes || verdict.passes;
    reply.verdicts.push_back(Describe(verdict, result.status, tier));
    reply.metrics = Describe(verdict.metrics);
  }
  // Nothing wrong is timed again: a failure counts by what it is.
  const int affordable = static_cast<int>(request.budget_s / std::max(first_s, request.min_time_s));
  const int repetitions = std::min(request.repetitions, affordable);
  if (passes && repetitions > 1) {
    Repeater(solver, problem, options, times_itself, flush).Run(repetitions, request.min_time_s, &result, &reply);
    if (!times_itself) SolveLast(solver, problem, options, &result, &reply);
  }
  if (reply.solve_s.empty()) {
    reply.solve_s.push_back(first_s);
    if (result.own_convert_s >= 0) reply.convert_s.push_back(result.own_convert_s);
  }
  reply.disturbance = watch.Finish();
  // This thread waits while another process solves.
  if (times_itself) reply.disturbance->cpu_share = 1;
  return reply;
}

double CellRunner::SolveFirst(LcpSolver& solver, const LcpProblem& problem, const LcpOptions& options,
                              bool times_itself, CacheFlush* flush, LcpResult* result, CellReply* reply) {
  LcpOptions observed = options;
  observed.time_factorisations = true;
  if (flush != nullptr) flush->Run();
  const AllocationWatch allocations;
  counters_.Start();
  const double start = SteadyNow();
  solver.Solve(problem, observed, result);
  const double solve_s = SteadyNow() - start;
  const CellAllocations made{allocations.count(), allocations.bytes(), std::nullopt};
  const auto counts = counters_.Stop();
  if (times_itself) return result->own_solve_s >= 0 ? result->own_solve_s : solve_s;
  NoteFactorisations(*result, solve_s, reply);
  if (AllocationsAreCounted()) reply->allocations = made;
  for (const auto& [name, count] : counts) reply->counters[name] = count;
  return solve_s;
}

}  // namespace lcpbench
