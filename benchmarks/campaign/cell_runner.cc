#include "benchmarks/campaign/cell_runner.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

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

CellVerdict Describe(const Verdict& verdict, double tier) {
  CellVerdict described;
  described.tier = tier;
  described.passes = verdict.passes;
  if (verdict.best_tier > 0) described.best_tier = verdict.best_tier;
  described.at_floor = verdict.at_floor;
  described.false_success = verdict.false_success;
  described.false_infeasible = verdict.false_infeasible;
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

// Every repetition is a run of Google Benchmark of at least min_time_s, so that short solves are many.
void Repeat(LcpSolver& solver, const LcpProblem& problem, LcpOptions options, bool times_itself, int repetitions,
            double min_time_s, LcpResult* result, CellReply* reply) {
  if (times_itself) options.repetitions = RepetitionsInWorker(result->own_solve_s, min_time_s);
  benchmark::ClearRegisteredBenchmarks();
  auto* registered = benchmark::RegisterBenchmark("solve", [&](benchmark::State& state) {
    for (auto _ : state) {
      solver.Solve(problem, options, result);
      benchmark::DoNotOptimize(result->f.data());
      if (!times_itself) continue;
      if (result->own_solve_s < 0) {
        state.SkipWithError("the solver's process ended");
        break;
      }
      state.SetIterationTime(result->own_solve_s);
      if (result->own_convert_s >= 0) reply->convert_s.push_back(result->own_convert_s);
    }
  });
  registered->Unit(benchmark::kSecond)->Repetitions(repetitions)->ReportAggregatesOnly(false);
  if (times_itself) {
    registered->UseManualTime()->Iterations(1);
  } else {
    registered->UseRealTime()->MinTime(min_time_s);
  }
  TimeCollector collector(&reply->solve_s);
  benchmark::RunSpecifiedBenchmarks(&collector, "solve");
  benchmark::ClearRegisteredBenchmarks();
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

  CellReply reply;
  begin(Phase::kSolve);
  // Of its own copy: set-up pays for every form of A that the solver reads.
  const LcpProblem problem = given.CopyOfGivenForm();
  LcpSolver& solver = pool_.Get(entry);
  ResetPeak();
  const double start = SteadyNow();
  solver.Prepare(problem);
  const double prepared = SteadyNow();
  LcpResult result;
  solver.Solve(problem, options, &result);
  const double solved = SteadyNow();
  if (!times_itself) reply.peak_bytes = PeakBytes();
  const double first_s = times_itself && result.own_solve_s >= 0 ? result.own_solve_s : solved - prepared;
  reply.setup_s.push_back(prepared - start);
  begin(Phase::kRepeat);

  reply.claim = ToString(result.status);
  reply.iterations = result.iterations;
  reply.detail = result.detail;
  bool passes = false;
  for (const double tier : request.judged) {
    const Verdict verdict = Verify(given, result, tier, &reference_);
    passes = passes || verdict.passes;
    reply.verdicts.push_back(Describe(verdict, tier));
    reply.metrics = Describe(verdict.metrics);
  }
  // Nothing wrong is timed again: a failure counts by what it is.
  const int affordable = static_cast<int>(request.budget_s / std::max(first_s, request.min_time_s));
  const int repetitions = std::min(request.repetitions, affordable);
  if (passes && repetitions > 1) {
    Repeat(solver, problem, options, times_itself, repetitions, request.min_time_s, &result, &reply);
  }
  if (reply.solve_s.empty()) {
    reply.solve_s.push_back(first_s);
    if (result.own_convert_s >= 0) reply.convert_s.push_back(result.own_convert_s);
  }
  return reply;
}

}  // namespace lcpbench
