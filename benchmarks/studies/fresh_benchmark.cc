// Streams problems that no solver object has seen through chosen solvers, all in one process, and prints what a user
// pays from arrays to f (fresh_pass.h, PassKind::kFresh): medians and percentiles by size class and origin, and our
// times over the peers'. Names are fresh/CLASS/ORIGIN/SOLVER; the options of Google Benchmark work, and a repetition is
// as many passes as --passes says. A stream has the problems of all origins of its class, whichever names are chosen.

#include <benchmark/benchmark.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/command/options.h"
#include "benchmarks/command/program.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/studies/fresh_contestant.h"
#include "benchmarks/studies/fresh_problems.h"
#include "benchmarks/studies/fresh_stream.h"
#include "benchmarks/studies/fresh_table.h"
#include "solvers/registry.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

constexpr const char* kSuite = "core";
constexpr const char* kAllOrigins = "all";
constexpr const char* kFromArrays = "arrays";
constexpr const char* kFromRows = "rows";

// What a table's group of origins is called.
std::string OriginGroup(const std::string& origin) {
  return origin == "motion" || origin == "recorded" ? "motions" : origin;
}

struct Options {
  FreshSources sources;
  std::vector<std::string> solvers = {"auto",        "dantzig",         "nncg",           "lemke",
                                      "ode-dantzig", "ode-dantzig-cfm", "bullet-dantzig", "bullet-dantzig-cfm"};
  bool solvers_are_chosen = false;
  NamedSolvers named;
  bool only_workers = false;
  std::string from = kFromArrays;
  std::string table;
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
  app->add_option("--scenes", from.scenes, "Scene families as they are placed, or all")->delimiter(',');
  app->add_option("--motions", from.motions, "Scene families, steps of whose motions are taken, or all")
      ->delimiter(',');
  app->add_option("--sizes", from.sizes, "Rows of scenes and motions")->delimiter(',')->check(AtLeast(1));
  app->add_option("--seeds", from.seeds, "Of scenes and motions [default: three that the collection does not have]")
      ->delimiter(',');
  app->add_option("--steps", from.steps, "Taken of a motion")->check(AtLeast(1))->capture_default_str();
  app->add_option("--most-rows", options->plan.most_rows, "No larger problems")
      ->check(AtLeast(1))
      ->capture_default_str();
  app->add_option("--problems", from.most_problems, "Of a size class at most [default: all]")->check(AtLeast(1));
  app->add_option("--solvers", options->solvers, "Keys of lcpbench list solvers")
      ->delimiter(',')
      ->capture_default_str();
  app->add_flag("--only-workers", options->only_workers,
                "Peers that are linked in run in their workers, as the others");
  app->add_option("--from", options->from,
                  "What a solve begins at. arrays: J by compressed rows; rows: two bodies and their numbers a row, as "
                  "engines have them, for auto (StepSolver) and the codes that are linked in")
      ->check(CLI::IsMember({kFromArrays, kFromRows}))
      ->capture_default_str();
  app->add_option("--passes", options->plan.passes, "Over every stream")->check(AtLeast(1))->capture_default_str();
  app->add_option("--tier", options->tier, "Tolerance, asked for and judged at")
      ->check(Tolerance())
      ->capture_default_str();
  app->add_option_function<double>(
         "--task-budget",
         [options](double budget_s) {
           options->plan.budgets.judge_s = budget_s;
           options->plan.budgets.timed_s = budget_s;
         },
         "Seconds that a solver has for judging a size class, and as many for timing it [default: those of core]")
      ->check(PositiveSeconds());
  app->add_option("--order", options->plan.seed, "Seed of all orders")->capture_default_str();
  AddCpuOption(*app, &options->cpu);
  options->named.Declare(*app);
  app->add_option("--table", options->table, "File for the tables, instead of standard output");
  app->footer("Besides, the options of Google Benchmark: --benchmark_filter=fresh/7-12/, --benchmark_out=FILE, ...");
}

void KeepOn(int cpu) {
  cpu_set_t only;
  CPU_ZERO(&only);
  if (cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &only);
  if (sched_setaffinity(0, sizeof only, &only) != 0) {
    throw InputError("--cpu: expected a processor that this process may use, found " + std::to_string(cpu));
  }
}

// Limits, budgets and passes as the suite has them: that is what the numbers are compared with.
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

// All size classes, their streams and their benchmarks.
class Study {
 public:
  Study(const Options& options, std::vector<std::unique_ptr<Contestant>> contestants)
      : plan_(options.plan),
        tier_(options.tier),
        from_(options.from),
        contestants_(std::move(contestants)),
        problems_(options.sources, plan_) {
    const std::vector<PlannedProblem>& planned = problems_.planned();
    if (planned.empty()) throw InputError("expected problems of at most --most-rows rows, found none");
    for (std::size_t begin = 0; begin < planned.size();) {
      std::size_t end = begin;
      while (end < planned.size() && planned[end].size_class == planned[begin].size_class) ++end;
      classes_.push_back(std::make_unique<Class>(
          Class{planned[begin].size_class, begin, end, FreshStream(&problems_, begin, end, plan_, tier_)}));
      begin = end;
    }
    for (const auto& one : classes_) {
      for (const std::string& origin : Origins()) AddGroup(one.get(), origin);
    }
  }

  // Asks Google Benchmark which names are chosen, then runs them. @return whether there were any
  bool Run() {
    Silence silence;
    is_rehearsal_ = true;
    benchmark::RunSpecifiedBenchmarks(&silence);
    is_rehearsal_ = false;
    benchmark::RunSpecifiedBenchmarks();
    return !chosen_.empty();
  }

  // What was run, by origin.
  std::vector<FreshGroup> Measured() const {
    std::vector<FreshGroup> measured;
    for (const std::string& origin : Origins()) {
      for (const Group& group : groups_) {
        if (group.origin != origin || !group.of->is_measured) continue;
        FreshGroup& one = measured.emplace_back(FreshGroup{origin, std::string(group.of->size_class->key), {}, {}});
        one.weights = group.weights;
        for (const auto& contestant : contestants_) {
          if (IsChosen(*group.of, *contestant)) one.solvers.push_back(TimesOf(group, *contestant));
        }
      }
    }
    return measured;
  }

  void TellContestants(std::ostream& out) const {
    out << "\nFrom " << from_ << ", tier " << tier_ << ", " << plan_.passes << " passes; solvers:";
    for (const auto& contestant : contestants_) {
      out << "\n- " << contestant->key() << ": " << contestant->place();
    }
    out << '\n';
  }

 private:
  struct Class {
    const SizeClass* size_class;
    std::size_t begin;
    std::size_t end;
    FreshStream stream;
    int rounds = 0;  // of Measure
    bool is_measured = false;
  };

  // The problems of a class and an origin, by their places in the class's stream.
  struct Group {
    Class* of;
    std::string origin;
    std::vector<std::size_t> places;
    std::vector<double> weights;
  };

  // Sees which benchmarks would run.
  class Silence : public benchmark::BenchmarkReporter {
   public:
    Silence() {
      SetOutputStream(&nowhere_);
      SetErrorStream(&nowhere_);
    }
    bool ReportContext(const Context& /*context*/) override { return true; }
    void ReportRuns(const std::vector<Run>& /*runs*/) override {}

   private:
    std::ostringstream nowhere_;
  };

  // Those of the tables: each, and where there are several all together, as README's headline has them.
  std::vector<std::string> Origins() const {
    std::vector<std::string> origins;
    for (const char* origin : {"placed", "motions", "literature", "given"}) {
      const bool is_there = std::any_of(problems_.planned().begin(), problems_.planned().end(),
                                        [&](const auto& one) { return OriginGroup(one.entry->origin) == origin; });
      if (is_there) origins.emplace_back(origin);
    }
    if (origins.size() > 1) origins.emplace_back(kAllOrigins);
    return origins;
  }

  static FreshTimes TimesOf(const Group& group, const Contestant& contestant) {
    FreshTimes times{contestant.key(), contestant.is_own(), {}};
    const std::vector<double> all = group.of->stream.Seconds(contestant);
    for (const std::size_t place : group.places) times.seconds.push_back(all[place]);
    return times;
  }

  bool IsChosen(const Class& of, const Contestant& contestant) const { return chosen_.count({&of, &contestant}) > 0; }

  // With a benchmark for each contestant, where it is not all origins together.
  void AddGroup(Class* of, const std::string& origin) {
    Group group{of, origin, {}, {}};
    for (std::size_t k = of->begin; k < of->end; ++k) {
      const PlannedProblem& problem = problems_.planned()[k];
      if (origin != kAllOrigins && OriginGroup(problem.entry->origin) != origin) continue;
      group.places.push_back(k - of->begin);
      group.weights.push_back(problem.weight);
    }
    if (group.places.empty()) return;
    groups_.push_back(group);
    if (origin == kAllOrigins) return;
    for (const auto& contestant : contestants_) {
      const std::string name = "fresh/" + std::string(of->size_class->key) + "/" + origin + "/" + contestant->key();
      const auto run = [this, group, who = contestant.get(), calls = 0](benchmark::State& state) mutable {
        Report(group, *who, &calls, state);
      };
      benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(1)->UseManualTime()->Unit(benchmark::kMicrosecond);
    }
  }

  // @param calls  of this benchmark, one a repetition
  void Report(const Group& group, const Contestant& contestant, int* calls, benchmark::State& state) {
    if (is_rehearsal_) {
      chosen_.insert({group.of, &contestant});
      state.SkipWithError("not run yet");
      return;
    }
    if (++*calls > group.of->rounds) Measure(group.of);
    const FreshSummary summary = Summarize(TimesOf(group, contestant), group.weights);
    if (!std::isfinite(summary.median_s)) {
      state.SkipWithError(summary.problems == 0 ? "had no turn" : "not right on half");
      return;
    }
    for (auto _ : state) state.SetIterationTime(summary.median_s);
    state.counters["right"] = summary.right;
    state.counters["p90"] = summary.p90_s;
    if (!std::isnan(summary.p99_s)) state.counters["p99"] = summary.p99_s;
    state.counters["problems"] = static_cast<double>(summary.problems);
  }

  // All that are chosen, in turns: what the machine does meanwhile is spread over all of them.
  void Measure(Class* of) {
    for (const auto& other : classes_) {
      if (other.get() != of) other->stream.DropProblems();
    }
    std::vector<Contestant*> chosen;
    for (const auto& contestant : contestants_) {
      if (IsChosen(*of, *contestant)) chosen.push_back(contestant.get());
    }
    of->stream.Measure(chosen);
    of->is_measured = true;
    ++of->rounds;
  }

  CampaignPlan plan_;
  double tier_;
  std::string from_;
  std::vector<std::unique_ptr<Contestant>> contestants_;
  FreshProblems problems_;
  std::vector<std::unique_ptr<Class>> classes_;
  std::vector<Group> groups_;  // by class
  bool is_rehearsal_ = false;
  std::set<std::pair<const Class*, const Contestant*>> chosen_;
};

int Main(int argc, char** argv) {
  Options options;
  options.plan = PlanOfSuite();
  options.plan.filter.clear();
  options.plan.most_rows = 1000;
  CLI::App app{"Fresh times of solvers in one process, by size class and origin", "fresh_benchmark"};
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
  Study study(options, MakeContestants(options.solvers, options.only_workers, options.from == kFromRows));
  if (!study.Run()) return 0;
  std::ostringstream text;
  study.TellContestants(text);
  WriteFreshTables(study.Measured(), text);
  if (!options.table.empty()) {
    WriteTextFile(options.table, text.str());
    return 0;
  }
  const bool is_for_programs = std::any_of(rest.begin(), rest.end(), [](const std::string& word) {
    return word.starts_with("--benchmark_format=") && !word.ends_with("=console");
  });
  (is_for_programs ? std::cerr : std::cout) << text.str() << std::flush;
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunProgram("fresh_benchmark", [&] { return lcpbench::Main(argc, argv); });
}
