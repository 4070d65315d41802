// Benchmarks of parts (studies.h), with the options of Google Benchmark. Without --benchmark_filter those of fresh
// times run.

#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/command/options.h"
#include "benchmarks/command/program.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/studies/studies.h"
#include "solvers/registry.h"
#include "support/exit_status.h"

namespace lcpbench {
namespace {

struct Options {
  FreshSources sources;
  CampaignPlan plan;
  NamedSolvers named;
  double tier = 1e-6;
  int cpu = -1;
  int largest = 100'000;
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
  CLI::Option* sizes = app->add_option("--sizes", from.sizes, "Rows of scenes")->delimiter(',')->check(AtLeast(1));
  app->get_option("--scenes")->needs(sizes);
  app->add_option("--seeds", from.seeds, "Of scenes [default: three that the collection does not have]")
      ->delimiter(',');
  app->add_flag(
      "--relaxed", from.relaxed,
      "Besides, the relaxation of each problem with friction: plain, with as many rows, of the origin relaxed");
  app->add_flag("--sealed{false}", options->plan.without_sealed,
                "Also the families and engines that are for measuring only (data/sealed.json)");
  app->add_option("--most-rows", options->plan.most_rows, "No larger problems")
      ->check(AtLeast(1))
      ->capture_default_str();
  app->add_option("--problems", from.most_problems, "Of a size class and origin at most [default: all]")
      ->check(AtLeast(1));
  app->add_option(
         "--solvers", options->plan.solvers,
         "Of fresh: keys of lcpbench list solvers, step-solver, auto-from-problem [default: ours, ODE, Bullet]")
      ->delimiter(',');
  app->add_option("--tier", options->tier, "Of fresh: the tolerance, asked for and judged at")
      ->check(Tolerance())
      ->capture_default_str();
  app->add_option("--largest", options->largest, "Rows of scene")
      ->check(CLI::Range(1'000, 1'000'000))
      ->capture_default_str();
  AddCpuOption(*app, &options->cpu);
  options->named.Declare(*app);
  app->footer(
      "Besides, the options of Google Benchmark: --benchmark_filter=batch/7-12/, --benchmark_repetitions=5, "
      "--benchmark_enable_random_interleaving=true, --benchmark_format=json, ...");
}

// Limits and the time to settle as the suite has them: that is what the numbers are compared with.
CampaignPlan PlanOfSuite() {
  CampaignPlan plan = *std::ranges::find(NamedCampaigns(), "core", &CampaignPlan::name);
  plan.filter.clear();
  plan.most_rows = 1000;
  plan.solvers.clear();
  plan.without_sealed = true;
  return plan;
}

void Complete(Options* options) {
  FreshSources& from = options->sources;
  CampaignPlan& plan = options->plan;
  plan.sealed = SealedSet::Read(DataFile("sealed"));
  plan.tiers = {options->tier};
  if (from.manifests.empty() && from.files.empty() && from.scenes.empty()) from.manifests = plan.manifests;
  for (std::string& manifest : from.manifests) {
    const bool is_path = manifest.find('/') != std::string::npos || manifest.ends_with(".json");
    if (!is_path) manifest = DataFile(manifest);
  }
  if (from.seeds.empty()) from.seeds = {900'001, 900'002, 900'003};
  if (plan.solvers.empty()) {
    for (const char* key : {"auto", "dantzig", "nncg", "lemke", "ode-dantzig", "ode-dantzig-cfm", "bullet-dantzig",
                            "bullet-dantzig-cfm"}) {
      if (FindSolver(key).available) plan.solvers.emplace_back(key);
    }
  }
}

int Main(int argc, char** argv) {
  Options options;
  options.plan = PlanOfSuite();
  CLI::App app{"Times of parts: fresh solves, batches, derivatives, scenes", "lcpbench_benchmark"};
  Declare(&app, &options);
  if (const auto status = ParseCommandLine(app, argc, argv)) return *status;

  // Its own options are Google Benchmark's to read.
  std::vector<std::string> rest = app.remaining();
  rest.insert(rest.begin(), {argv[0], "--benchmark_filter=^fresh/"});
  std::vector<char*> words;
  for (std::string& word : rest) words.push_back(word.data());
  int count = static_cast<int>(words.size());
  words.push_back(nullptr);
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data())) return kMisuse;

  options.named.Register();
  if (options.cpu >= 0) {
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(static_cast<std::size_t>(options.cpu), &only);
    sched_setaffinity(0, sizeof only, &only);
  }
  Complete(&options);
  FreshProblems problems(options.sources, options.plan);
  RegisterFresh(options.plan, &problems);
  RegisterBatch(&problems);
  RegisterDerivatives(&problems);
  RegisterScenes(options.largest);
  std::ostringstream tier;
  tier << options.tier;
  benchmark::AddCustomContext("tier", tier.str());
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunProgram("lcpbench_benchmark", [&] { return lcpbench::Main(argc, argv); });
}
