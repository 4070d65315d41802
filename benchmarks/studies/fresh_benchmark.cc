// What a user pays from arrays to f for problems that the solver object has not seen: a front of Google Benchmark for
// the passes that a campaign's launches run (fresh_pass.h, PassKind::kFresh). Names are fresh/CLASS/ORIGIN/SOLVER. A
// repetition is one pass over the problems of a class and an origin, by a new solver object; its time is the weighted
// median over them, failures infinite.

#include <benchmark/benchmark.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/command/options.h"
#include "benchmarks/command/program.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/studies/fresh_contestant.h"
#include "benchmarks/studies/fresh_problems.h"
#include "benchmarks/studies/study.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr const char* kSuite = "core";
constexpr const char* kFromArrays = "arrays";
constexpr const char* kFromProblem = "problem";
constexpr const char* kFromRows = "rows";

TimedFrom BeginningOf(const std::string& from) {
  return from == kFromRows ? TimedFrom::kRows : from == kFromProblem ? TimedFrom::kProblem : TimedFrom::kArrays;
}

struct Options {
  FreshSources sources;
  std::vector<std::string> solvers = {"auto",        "dantzig",         "nncg",           "lemke",
                                      "ode-dantzig", "ode-dantzig-cfm", "bullet-dantzig", "bullet-dantzig-cfm"};
  bool solvers_are_chosen = false;
  NamedSolvers named;
  bool only_workers = false;
  std::string from = kFromArrays;
  int cpu = -1;
  double tier = 1e-6;
  CampaignPlan plan;
};

void Declare(CLI::App* app, Options* options) {
  FreshSources& from = options->sources;
  app->allow_extras();
  app->add_option("--manifests", from.manifests,
                  "Of the collection by name, or paths [default: those of the suite core, where nothing else is named]")
      ->delimiter(',');
  app->add_option("--files", from.files, "Problems, JSON lines (.gz as well) or another format")->delimiter(',');
  app->add_option("--scenes", from.scenes, "Scene families as they are placed; all, or friction: all of them")
      ->delimiter(',');
  app->add_option("--motions", from.motions, "Scene families, steps of whose motions are taken, or as --scenes")
      ->delimiter(',');
  app->add_option("--sizes", from.sizes, "Rows of scenes and motions")->delimiter(',')->check(AtLeast(1));
  app->add_option("--seeds", from.seeds, "Of scenes and motions [default: three that the collection does not have]")
      ->delimiter(',');
  app->add_option("--steps", from.steps, "Taken of a motion")->check(AtLeast(1))->capture_default_str();
  app->add_flag(
      "--relaxed", from.relaxed,
      "Besides, the relaxation of each problem with friction: plain, with as many rows, of the origin relaxed");
  options->plan.without_sealed = true;
  app->add_flag("--sealed{false}", options->plan.without_sealed,
                "Also the families and engines that are for measuring only (data/sealed.json)");
  app->add_option("--most-rows", options->plan.most_rows, "No larger problems")
      ->check(AtLeast(1))
      ->capture_default_str();
  app->add_option("--problems", from.most_problems, "Of a size class and origin at most [default: all]")
      ->check(AtLeast(1));
  app->add_option("--solvers", options->solvers, "Keys of lcpbench list solvers")
      ->delimiter(',')
      ->capture_default_str();
  app->add_flag("--only-workers", options->only_workers,
                "Peers that are linked in run in their workers, as the others");
  app->add_option("--from", options->from,
                  "What a solve begins at. arrays: J by compressed rows; problem: the same, made an LcpProblem for own "
                  "solvers; rows: two bodies and their numbers a row, as "
                  "engines have them, for auto (StepSolver) and the codes that are linked in")
      ->check(CLI::IsMember({kFromArrays, kFromProblem, kFromRows}))
      ->capture_default_str();
  app->add_option("--tier", options->tier, "Tolerance, asked for and judged at")
      ->check(Tolerance())
      ->capture_default_str();
  app->add_option("--order", options->plan.seed, "Seed of all orders")->capture_default_str();
  AddCpuOption(*app, &options->cpu);
  options->named.Declare(*app);
  app->footer(
      "Besides, the options of Google Benchmark: --benchmark_filter=fresh/7-12/, --benchmark_repetitions=5, "
      "--benchmark_enable_random_interleaving=true, --benchmark_format=json, ...");
}

void KeepOn(int cpu) {
  cpu_set_t only;
  CPU_ZERO(&only);
  if (cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &only);
  if (sched_setaffinity(0, sizeof only, &only) != 0) {
    throw InputError("--cpu: expected a processor that this process may use, found " + std::to_string(cpu));
  }
}

// Limits and the time to settle as the suite has them: that is what the numbers are compared with.
CampaignPlan PlanOfSuite() {
  for (const CampaignPlan& campaign : NamedCampaigns()) {
    if (campaign.name == kSuite) return campaign;
  }
  throw InputError(std::string("no suite ") + kSuite);
}

void Complete(Options* options) {
  constexpr std::uint64_t kSeeds[] = {900'001, 900'002, 900'003};
  FreshSources& from = options->sources;
  if (from.manifests.empty() && from.files.empty() && from.scenes.empty() && from.motions.empty()) {
    from.manifests = PlanOfSuite().manifests;
    // Its problems have A itself, or rows on more bodies.
    if (options->from == kFromRows) std::erase(from.manifests, "literature");
  }
  for (std::string& manifest : from.manifests) {
    const bool is_path = manifest.find('/') != std::string::npos || manifest.ends_with(".json");
    if (!is_path) manifest = DataFile(manifest);
  }
  options->plan.sealed = SealedSet::Read(DataFile("sealed"));
  if (from.seeds.empty()) from.seeds.assign(std::begin(kSeeds), std::end(kSeeds));
  if (from.sizes.empty() && !(from.scenes.empty() && from.motions.empty())) {
    throw InputError("--scenes and --motions: expected --sizes");
  }
  if (options->solvers_are_chosen) return;
  std::erase_if(options->solvers, [&](const std::string& key) {
    const SolverEntry& entry = FindSolver(key);
    const bool takes_rows = key == "auto" || entry.origin != SolverOrigin::kOwn;
    return !entry.available || (options->from == kFromRows && !takes_rows);
  });
}

// One benchmark.
struct Cell {
  const Contestant* contestant;
  FreshStream* stream;
  std::vector<bool> right = {};  // problems that it solves; empty before the first pass
  int passes = 0;
};

class Study {
 public:
  explicit Study(const Options& options)
      : plan_(options.plan),
        tier_(options.tier),
        contestants_(MakeContestants(options.solvers, options.only_workers, BeginningOf(options.from))),
        problems_(options.sources, plan_) {
    for (FreshStream* stream : problems_.streams()) {
      for (const Contestant& contestant : contestants_) Register(stream, contestant);
    }
    benchmark::AddCustomContext("from", options.from);
    std::ostringstream tier;
    tier << tier_;
    benchmark::AddCustomContext("tier", tier.str());
    for (const Contestant& contestant : contestants_) {
      benchmark::AddCustomContext(contestant.entry.key, contestant.place);
    }
  }

 private:
  void Register(FreshStream* stream, const Contestant& contestant) {
    const auto cell = std::make_shared<Cell>(Cell{&contestant, stream});
    const std::string name = "fresh/" + stream->name + "/" + contestant.entry.key;
    benchmark::RegisterBenchmark(name.c_str(), [this, cell](benchmark::State& state) { Measure(cell.get(), state); })
        ->Iterations(1)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }

  void Measure(Cell* cell, benchmark::State& state) {
    const FreshStream& stream = *cell->stream;
    problems_.Load(cell->stream);
    if (cell->right.empty()) cell->right = Judge(*cell->contestant, stream, tier_, plan_.limits);
    const PassRequest request = Plan(cell);
    PassReply reply;
    try {
      if (!request.order.empty()) reply = RunPass(*cell->contestant, stream, request);
    } catch (const WorkerFailure& failure) {
      state.SkipWithError(failure.what());
      return;
    }
    for (std::size_t k = 0; k < reply.entries.size(); ++k) {
      const std::size_t place = request.order[k];
      if (!IsRight(stream, place, reply.entries[k].f, tier_)) cell->right[place] = false;
    }
    Report(*cell, request, reply, state);
  }

  // The next pass over what it solves.
  PassRequest Plan(Cell* cell) const {
    std::vector<std::size_t> places;
    Index most_rows = 0;
    for (std::size_t place = 0; place < cell->right.size(); ++place) {
      if (!cell->right[place]) continue;
      places.push_back(place);
      most_rows = std::max(most_rows, cell->stream->problems[place].size());
    }
    PassRequest request = PlanPass(places, PassKind::kFresh, plan_.seed, ++cell->passes);
    request.tolerance = tier_;
    request.time_limit_s = plan_.limits.Of(most_rows);
    request.settle_s = plan_.launches.settle_s;
    return request;
  }

  static void Report(const Cell& cell, const PassRequest& request, const PassReply& reply, benchmark::State& state) {
    const std::vector<PlannedProblem>& planned = cell.stream->planned;
    double all = 0;
    double right = 0;
    for (std::size_t place = 0; place < planned.size(); ++place) {
      all += planned[place].weight;
      if (cell.right[place]) right += planned[place].weight;
    }
    std::vector<std::pair<double, double>> times;  // with weights
    double timed = 0;
    for (std::size_t k = 0; k < reply.entries.size(); ++k) {
      const std::size_t place = request.order[k];
      if (!cell.right[place]) continue;
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
    // Below, less than one problem is beyond the 99th percentile. Infinity is no number of JSON's.
    constexpr std::size_t kLeastForP99 = 100;
    const double p90 = WeightedQuantile(times, 0.9);
    const double p99 = WeightedQuantile(times, 0.99);
    if (std::isfinite(p90)) state.counters["p90"] = p90;
    if (std::isfinite(p99) && planned.size() >= kLeastForP99) state.counters["p99"] = p99;
  }

  CampaignPlan plan_;
  double tier_;
  std::vector<Contestant> contestants_;
  FreshProblems problems_;
};

int Main(int argc, char** argv) {
  Options options;
  options.plan = PlanOfSuite();
  options.plan.filter.clear();
  options.plan.most_rows = 1000;
  CLI::App app{"Fresh times of solvers, by size class and origin", "fresh_benchmark"};
  Declare(&app, &options);
  if (const auto status = ParseCommandLine(app, argc, argv)) return *status;
  options.solvers_are_chosen = app.count("--solvers") > 0;

  // Its own options are Google Benchmark's to read.
  std::vector<std::string> rest = app.remaining();
  std::vector<char*> words = {argv[0]};
  for (std::string& word : rest) words.push_back(word.data());
  int count = static_cast<int>(words.size());
  words.push_back(nullptr);
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data())) return kMisuse;

  options.named.Register();
  if (options.cpu >= 0) KeepOn(options.cpu);
  Complete(&options);
  const Study study(options);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunProgram("fresh_benchmark", [&] { return lcpbench::Main(argc, argv); });
}
