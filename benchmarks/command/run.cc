#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/benchmark_json.h"
#include "benchmarks/campaign/campaign.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/solver_options.h"
#include "build_info.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// What `lcpbench run` is asked for: a campaign by name, or a manifest, and what is different from its plan.
struct CampaignArguments {
  std::string suite = "quick";  ///< of CampaignNames, or a manifest's path (with a '/' or ending in .json)
  std::string output;           ///< folder; "": build/results/NAME
  std::vector<std::string> solvers;
  std::vector<double> tiers;
  double time_limit_s = 0;
  int passes = 0;
  double task_budget_s = 0;
  Index most_rows = 0;
  bool no_fills = false;
  bool ablations = false;  ///< adds the solvers of RegisterAblations
  std::string filter;      ///< narrows the plan's own
  int cpu = -1;
  bool resume = false;
  std::string shard = "1/1";
  std::string tuned;           ///< path of a what `lcpbench tune` wrote; "": no tuned variants
  std::string benchmark_json;  ///< file for the times as Google Benchmark writes them; "": none
  bool list = false;           ///< the cells' names only
};

struct NamedCampaign {
  const char* name;
  std::vector<const char*> manifests;  // of the collection
  const char* filter = "";             // as CampaignPlan's, as is all that follows
  Index most_rows = 0;
  bool fills = true;
  std::vector<double> tiers = CampaignPlan{}.tiers;
  int passes = CampaignPlan{}.passes;
  TaskBudgets budgets = {};
  double most_s = CampaignPlan{}.most_s;
  bool tuned = false;  // KEY-tuned besides, where `lcpbench tune` chose other settings than the default
};

// A first look, in about a minute with our solvers: one seed of all families from 2 to 160 rows, of some up to 1000,
// problems of every kind that is meant to break something, and four short motions. In these Ipopt is left out: its
// milliseconds a step are most of the time that all would take.
constexpr const char* kQuickProblems =
    "^solve/[a-z-]+-n(2|10|25|64|160)-s1/|"
    "^solve/(disc-pile|tall-stacks|chain-of-links|ovals-in-bowl)-n(400|1000)-s1/|"
    "^solve/(squeezed-row|barely-squeezed-row|idle-line|fixed-pairs|overpinned-beam)-n40-s1/|"
    "^solve/(tall-stacks-n40-s1-mass-ratio-1e[+]08|disc-track-n40-s1-conformal-1e-06|gear-train-n60-s1-scale-rows-60|"
    "disc-pile-n30-s1-duplicate-rows-1|disc-pile-n30-s1-oppose-rows-0.2|ovals-in-bowl-n60-s1-crowd-contacts-1e-07)/|"
    "^steps/((disc-track|gear-train|boxes-and-discs)-n12|disc-pile-n40)-s1-motion/(?!ipopt)";

const std::vector<NamedCampaign>& Campaigns() {
  static const std::vector<NamedCampaign> campaigns{
      {.name = "quick",
       .manifests = {"engine", "standard", "pathological", "sequences"},
       .filter = kQuickProblems,
       .fills = false,
       .passes = 3,
       .budgets = {.judge_s = 1.5, .timed_s = 0.5, .parts_s = 0.1, .again_s = 0.1},
       .most_s = 0.5},
      // The numbers in README.md and docs/, and comparisons between commits: every class to 10^4 rows, with all
      // problems of the collection and all that fill up its streams, at the one tier that every solver is meant for.
      {.name = "core",
       .manifests = {"engine", "standard"},
       .most_rows = 10'000,
       .tiers = {1e-6},
       .budgets = {.judge_s = 2, .timed_s = 1, .parts_s = 0.2, .again_s = 0.2},
       .most_s = 1,
       .tuned = true},
      // What checks and instruction sets are worth: with --ablations and --external KEY-baseline=...
      {.name = "ablation",
       .manifests = {"engine", "standard"},
       .most_rows = 1000,
       .fills = false,
       .tiers = {1e-6},
       .passes = 3,
       .budgets = {.judge_s = 1, .timed_s = 0.5, .parts_s = 0, .again_s = 0},
       .most_s = 0.5},
      {.name = "engine", .manifests = {"engine"}, .most_s = 0.5},
      {.name = "smoke", .manifests = {"smoke"}, .most_s = 0.5},
      {.name = "standard",
       .manifests = {"engine", "standard"},
       .budgets = {.judge_s = 3, .timed_s = 1.5, .parts_s = 0.3, .again_s = 0.3},
       .tuned = true},
      {.name = "pathological", .manifests = {"pathological"}},
      {.name = "large",
       .manifests = {"large"},
       .passes = 3,
       .budgets = {.judge_s = 600, .timed_s = 600, .parts_s = 120, .again_s = 120},
       .most_s = 60},
      // What every decade of precision costs.
      {.name = "precision",
       .manifests = {"standard"},
       .filter = "-n(40|250|1000)-s1/",
       .fills = false,
       .tiers = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12}},
      {.name = "sequences", .manifests = {"sequences"}, .passes = 6, .most_s = 0.5},
  };
  return campaigns;
}

std::string CampaignNames() {
  std::string names;
  for (const NamedCampaign& campaign : Campaigns()) names += (names.empty() ? "" : ", ") + std::string(campaign.name);
  return names;
}

bool IsPath(const std::string& suite) { return suite.find('/') != std::string::npos || suite.ends_with(".json"); }

// A file of data/.
std::string DataFile(const std::string& name) {
  for (const std::string& folder : {std::string("data"), std::string(kDataFolder)}) {
    std::string path = folder + "/" + name + ".json";
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError("data/" + name + ".json: not there, nor in " + kDataFolder);
}

// "k/N"
std::pair<int, int> ParseShard(const std::string& text) {
  const size_t slash = text.find('/');
  const auto number = [&text](size_t begin, size_t end, int* value) {
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, *value);
    return error == std::errc() && stop == text.data() + end && *value >= 1;
  };
  std::pair<int, int> shard;
  if (slash == std::string::npos || !number(0, slash, &shard.first) || !number(slash + 1, text.size(), &shard.second) ||
      shard.first > shard.second) {
    throw InputError("--shard: expected k/N with k from 1 to N, found '" + text + "'");
  }
  return shard;
}

CampaignPlan CampaignOf(const std::string& suite) {
  CampaignPlan plan;
  plan.name = suite;
  for (const SolverEntry& entry : AllSolvers()) plan.solvers.push_back(entry.key);
  for (const NamedCampaign& campaign : Campaigns()) {
    if (suite != campaign.name) continue;
    for (const char* manifest : campaign.manifests) plan.manifests.push_back(DataFile(manifest));
    plan.filter = campaign.filter;
    plan.most_rows = campaign.most_rows;
    plan.fills = campaign.fills;
    plan.tiers = campaign.tiers;
    plan.passes = campaign.passes;
    plan.budgets = campaign.budgets;
    plan.most_s = campaign.most_s;
    return plan;
  }
  if (!IsPath(suite)) {
    throw InputError("unknown suite '" + suite + "', expected one of " + CampaignNames() + ", or a manifest's path");
  }
  plan.name = std::filesystem::path(suite).stem().string();
  plan.manifests = {suite};
  return plan;
}

// Names that match both. Checked apart, because two broken expressions may make a whole one.
std::string Both(const std::string& plans, const std::string& users) {
  try {
    const std::regex check(users);
  } catch (const std::regex_error&) {
    throw InputError("--filter: expected a regular expression, found '" + users + "'");
  }
  if (plans.empty() || users.empty()) return plans + users;
  return "^(?=.*(?:" + plans + "))(?=.*(?:" + users + "))";
}

CampaignPlan PlanOf(const CampaignArguments& arguments) {
  CampaignPlan plan = CampaignOf(arguments.suite);
  plan.filter = Both(plan.filter, arguments.filter);
  if (!arguments.solvers.empty()) plan.solvers = arguments.solvers;
  if (!arguments.tiers.empty()) plan.tiers = arguments.tiers;
  if (arguments.time_limit_s != 0) plan.least_s = plan.most_s = arguments.time_limit_s;
  if (arguments.passes != 0) plan.passes = arguments.passes;
  if (arguments.task_budget_s != 0) {
    // Parts and "again" explain; the other two decide.
    constexpr double kLess = 0.25;
    const double budget = arguments.task_budget_s;
    plan.budgets = {budget, budget, kLess * budget, kLess * budget};
  }
  if (arguments.most_rows != 0) plan.most_rows = arguments.most_rows;
  if (arguments.no_fills) plan.fills = false;
  return plan;
}

// One line for all of them: they have no cells.
void TellWhatIsMissing(const CampaignPlan& plan) {
  std::string missing;
  for (const std::string& key : plan.solvers) {
    if (!FindSolver(key).available) missing += (missing.empty() ? "" : ", ") + key;
  }
  if (!missing.empty()) std::cerr << "not in this build: " << missing << std::endl;
}

// ----- tuned settings

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "lcpbench-tuned/1";

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  return std::string(std::istreambuf_iterator<char>(file), {});
}

struct Chosen {
  std::string solver;
  Settings settings;  // other than its defaults
};

struct TunedFile {
  int budget = 0;
  std::vector<Chosen> solvers;
};

TunedFile Parse(const std::string& text, const std::string& path) {
  TunedFile tuned;
  try {
    const Json json = Json::parse(text);
    if (json.at("schema") != kSchema) throw InputError(path + ": expected schema " + std::string(kSchema));
    tuned.budget = json.at("budget").get<int>();
    for (const Json& solver : json.at("solvers")) {
      tuned.solvers.push_back({solver.at("solver").get<std::string>(), solver.at("chosen").get<Settings>()});
    }
  } catch (const Json::exception&) {
    throw InputError(path + ": expected the JSON object that lcpbench tune writes, of schema " + kSchema);
  }
  return tuned;
}

// Reads what `lcpbench tune` has chosen (tuned.json, RESULTS.md) and registers, for every solver of the plan with
// settings other than its defaults, the variant KEY-tuned, behind its base; solvers that are not in this build have
// none. `variants` gets them as --variant takes them.
void AddTunedVariants(const std::string& path, CampaignPlan* plan, std::vector<std::string>* variants) {
  const std::string text = ReadText(path);
  const TunedFile tuned = Parse(text, path);
  std::vector<std::string> added;
  for (const Chosen& chosen : tuned.solvers) {
    const bool available = FindSolver(chosen.solver).available;
    const auto base = std::find(plan->solvers.begin(), plan->solvers.end(), chosen.solver);
    if (chosen.settings.empty() || !available || base == plan->solvers.end()) continue;
    const std::string key = chosen.solver + "-tuned";
    std::string variant = key;
    variant += "=" + chosen.solver;
    for (const auto& [name, value] : chosen.settings) variant += "," + name + "=" + value;
    added.push_back(variant);
    // Who names it among the solvers gets it once.
    if (std::find(plan->solvers.begin(), plan->solvers.end(), key) == plan->solvers.end()) {
      plan->solvers.insert(base + 1, key);
    }
  }
  RegisterVariants(added);
  variants->insert(variants->end(), added.begin(), added.end());
  plan->tuning = {std::filesystem::path(path).filename().string(), TextHash(text), tuned.budget};
}

// ----- the command

int RunCampaignCommand(CampaignArguments arguments, NamedSolvers named) {
  CampaignPlan plan = PlanOf(arguments);
  for (const NamedCampaign& campaign : Campaigns()) {
    if (campaign.tuned && arguments.suite == campaign.name && arguments.tuned.empty()) {
      arguments.tuned = DataFile("tuned");
    }
  }
  CampaignOptions options;
  options.folder = arguments.output.empty() ? "build/results/" + plan.name : arguments.output;
  options.resume = arguments.resume;
  options.cpu = arguments.cpu;
  if (!arguments.tuned.empty()) AddTunedVariants(arguments.tuned, &plan, &named.variants);
  options.solver_arguments = named.Words();
  if (arguments.ablations) options.solver_arguments.emplace_back("--ablations");
  std::tie(options.shard, options.shards) = ParseShard(arguments.shard);
  if (arguments.list) {
    for (const std::string& name : CampaignCells(plan, options)) std::cout << name << '\n';
    return 0;
  }
  // Not before: of a user's mistake there is one line only.
  options.on_start = [&plan] { TellWhatIsMissing(plan); };
  const int status = RunCampaign(plan, options);
  if (!arguments.benchmark_json.empty()) WriteBenchmarkJson(options.folder, arguments.benchmark_json);
  std::cout << "results: " << options.folder << (status == 0 ? "" : " (interrupted; --resume goes on)") << std::endl;
  return status;
}

}  // namespace

void AddRunCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<CampaignArguments>();
  CLI::App* command = app.add_subcommand(
      "run", "Runs a campaign: solves and judges every problem, and times what passed, fresh, into a folder");
  command->add_option("--suite", arguments->suite, CampaignNames() + ", or a manifest's path");
  command->add_option("-o,--output", arguments->output, "The campaign's folder [default: build/results/NAME]");
  command->add_flag("--resume", arguments->resume, "Go on with the campaign that the folder has");
  command->add_option("--solvers", arguments->solvers, "Only these solvers")->delimiter(',');
  command->add_option("--tiers", arguments->tiers, "Tolerances [default: the campaign's]")->delimiter(',');
  command
      ->add_option("--filter,--benchmark_filter", arguments->filter,
                   "Of the campaign's problems solve/PROBLEM/ and passes steps/SEQUENCE/SOLVER/TIER/MODE only those "
                   "that match this regular expression")
      ->take_last();
  command->add_option("--time-limit", arguments->time_limit_s, "Seconds per solve, whatever its size");
  command
      ->add_option("--passes,--benchmark_repetitions", arguments->passes,
                   "Timed passes over every stream of problems, at most [default: the campaign's]")
      ->take_last();
  command->add_option("--task-budget", arguments->task_budget_s,
                      "Seconds that a solver has for judging a size class at a tier, and as many for timing it");
  command->add_option("--most-rows", arguments->most_rows, "No larger problems");
  command->add_flag("--ablations", arguments->ablations,
                    "Adds our solvers without their own check, and peers with one: for the ablation table");
  command->add_flag("--no-fills", arguments->no_fills, "Only the manifests' own problems, without further seeds");
  command->add_option("--cpu", arguments->cpu, "The processor that solves are kept on");
  command->add_option("--shard", arguments->shard, "k/N, the k-th of N parts; see lcpbench merge");
  command->add_option(
      "--tuned", arguments->tuned,
      "Adds KEY-tuned for every solver that `lcpbench tune` chose settings for [default of core and standard: "
      "data/tuned.json]");
  command->add_flag("--benchmark_list_tests", arguments->list,
                    "Prints the names of all that would be solved, and solves nothing");
  command->add_option("--benchmark_out", arguments->benchmark_json, "File for the times in Google Benchmark's JSON");
  // The only one; taken so that calls of Google Benchmark's tools are.
  command->add_option("--benchmark_out_format")->check(CLI::IsMember({"json"}))->group("");
  const auto named = AddNamedSolverOptions(*command);
  command->callback([arguments, named, &run] {
    run = [arguments, named] {
      named->Register();
      if (arguments->ablations) RegisterAblations();
      return RunCampaignCommand(*arguments, *named);
    };
  });
}

void AddCampaignWorkerCommand(CLI::App& app, CommandRun& run) {
  CLI::App* worker = app.add_subcommand("campaign-worker", "Solves and times for `lcpbench run`");
  worker->group("");  // of no use to people
  const auto named = AddNamedSolverOptions(*worker);
  const auto ablations = std::make_shared<bool>(false);
  worker->add_flag("--ablations", *ablations);
  worker->callback([named, ablations, &run] {
    run = [named, ablations] {
      named->Register();
      if (*ablations) RegisterAblations();
      return ServeTasks();
    };
  });
}

void AddMergeCommand(CLI::App& app, CommandRun& run) {
  auto folders = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<std::string>();
  CLI::App* merge = app.add_subcommand("merge", "Merges the folders of a campaign's shards");
  merge->add_option("FOLDER", *folders, "Written by lcpbench run --shard")->required();
  merge->add_option("-o,--output", *output, "A new folder")->required();
  merge->callback([folders, output, &run] {
    run = [folders, output] {
      MergeCampaigns(*folders, *output);
      std::cout << "results: " << *output << std::endl;
      return 0;
    };
  });
}

}  // namespace lcpbench
