#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/campaign/tuned_file.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/allocation_count.h"
#include "benchmarks/measure/data_file.h"
#include "solvers/registry.h"
#include "support/exit_status.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

std::string CampaignNames() {
  std::string names;
  for (const CampaignPlan& campaign : NamedCampaigns()) names += (names.empty() ? "" : ", ") + campaign.name;
  return names;
}

// A campaign by name, or of a manifest: with a '/' or ending in .json. It has solvers where the suite has a list of
// them.
CampaignPlan CampaignOf(const std::string& suite) {
  CampaignPlan plan;
  const auto named = std::find_if(NamedCampaigns().begin(), NamedCampaigns().end(),
                                  [&suite](const CampaignPlan& campaign) { return campaign.name == suite; });
  if (named != NamedCampaigns().end()) {
    plan = *named;
    for (std::string& manifest : plan.manifests) manifest = DataFile(manifest);
  } else if (suite.find('/') != std::string::npos || suite.ends_with(".json")) {
    plan.name = std::filesystem::path(suite).stem().string();
    plan.manifests = {suite};
  } else {
    throw InputError("unknown suite '" + suite + "', expected one of " + CampaignNames() + ", or a manifest's path");
  }
  plan.sealed = SealedSet::Read(DataFile("sealed"));
  plan.portfolio = ReadPortfolio(DataFile("portfolio"));
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

// Reads what `lcpbench tune` has chosen (tuned.json, RESULTS.md) and registers, for every solver of the plan with
// settings other than its defaults at some size, KEY-tuned, behind its base, and the variants KEY-tuned-ROWS that run
// in its place. Who names KEY-tuned needs no base for it, and has it whatever was chosen; solvers that are not in this
// build have none. `variants` gets the variants as --variant takes them.
// @param adds  false: only those that the plan names already
void AddTunedVariants(const std::string& path, bool adds, CampaignPlan* plan, std::vector<std::string>* variants) {
  const TunedFile tuned = ReadTunedFile(path);
  plan->tuning = tuned.source;
  for (const auto& [solver, choices] : tuned.chosen) {
    const std::string key = solver + "-tuned";
    const auto base = std::find(plan->solvers.begin(), plan->solvers.end(), solver);
    const bool is_named = std::find(plan->solvers.begin(), plan->solvers.end(), key) != plan->solvers.end();
    if (!FindSolver(solver).available) {
      std::erase(plan->solvers, key);
      continue;
    }
    if (!is_named && !(adds && base != plan->solvers.end())) continue;
    std::vector<std::string> added;
    std::map<Index, std::string> by_rows;
    for (const auto& [rows, settings] : choices) {
      by_rows[rows] = solver;
      if (settings.empty()) continue;
      by_rows[rows] = key + "-" + std::to_string(rows);
      added.push_back(by_rows[rows] + "=" + solver);
      for (const auto& [name, value] : settings) added.back() += "," + name + "=" + value;
    }
    if (added.empty() && !is_named) continue;
    RegisterVariants(added);
    RegisterSolverBySize(key, solver, by_rows);
    variants->insert(variants->end(), added.begin(), added.end());
    if (!is_named) plan->solvers.insert(base + 1, key);
  }
}

struct RunCampaigns {
  std::string suite = "quick";
  std::string filter;
  std::string shard = "1/1";
  std::string tuned;
  bool list = false;
  CampaignOptions options;
  NamedSolvers named;
  std::vector<std::function<void(CampaignPlan& plan)>> changes;  // of the campaign's plan, by options

  void Declare(CLI::App& app) {
    app.add_option("--suite", suite, CampaignNames() + ", or a manifest's path");
    app.add_option("-o,--output", options.folder, "The campaign's folder [default: build/results/NAME]");
    app.add_flag("--resume", options.resume, "Go on with the campaign that the folder has");
    AddChange(app, "--solvers", &CampaignPlan::solvers, "Only these solvers")->delimiter(',');
    AddChange(app, "--tiers", &CampaignPlan::tiers, "Tolerances [default: the campaign's]")
        ->delimiter(',')
        ->check(Tolerance());
    app.add_option("--filter,--benchmark_filter", filter,
                   "Only the problems solve/PROBLEM/ and the passes steps/SEQUENCE/SOLVER/TIER/MODE that match this "
                   "regular expression")
        ->take_last();
    app.add_option_function<double>(
           "--time-limit",
           [this](double limit_s) {
             changes.emplace_back(
                 [limit_s](CampaignPlan& plan) { plan.limits.least_s = plan.limits.most_s = limit_s; });
           },
           "Seconds per solve, whatever its size")
        ->check(PositiveSeconds());
    app.add_option_function<double>(
           "--class-limit",
           [this](double limit_s) {
             changes.emplace_back([limit_s](CampaignPlan& plan) { plan.limits.class_s = limit_s; });
           },
           "Seconds that a solver is judged for, at most, on a size class at a tier")
        ->check(PositiveSeconds());
    app.add_option_function<int>(
           "--launches,--benchmark_repetitions",
           [this](int count) {
             changes.emplace_back(
                 [count](CampaignPlan& plan) { plan.launches.near = plan.launches.others = plan.rounds = count; });
           },
           "Timed launches of every solver over a size class, and rounds over a sequence [default: more of those near "
           "the best, see docs/campaigns.md]")
        ->take_last()
        ->check(AtLeast(1));
    AddChange(app, "--most-rows", &CampaignPlan::most_rows, "No larger problems")->check(AtLeast(1));
    app.add_flag_callback(
        "--no-fills", [this] { changes.emplace_back([](CampaignPlan& plan) { plan.fills = false; }); },
        "Only the manifests' own problems, without further seeds");
    app.add_flag_callback(
        "--without-sealed", [this] { changes.emplace_back([](CampaignPlan& plan) { plan.without_sealed = true; }); },
        "Leaves out the families and engines that are for measuring only (data/sealed.json)");
    AddCpuOption(app, &options.cpu);
    app.add_option("--shard", shard, "k/N, the k-th of N parts, or k-m/N, the k-th to the m-th; see lcpbench merge");
    app.add_option(
        "--tuned", tuned,
        "Adds KEY-tuned for every solver that `lcpbench tune` chose settings for [default of core and standard: "
        "data/tuned.json]");
    app.add_flag("--benchmark_list_tests", list, "Prints the names of all that would be solved, and solves nothing");
    named.Declare(app);
  }

  int Run() {
    // What it has written is whole at any moment, and so is what it writes next.
    EndWithoutMemory([] {
      constexpr std::string_view kText = "lcpbench: not enough memory\n";
      [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText.data(), kText.size());
      _exit(kMisuse);
    });
    named.Register();
    CampaignPlan plan = CampaignOf(suite);
    const std::vector<std::string> of_the_suite = plan.solvers;
    plan.filter = Both(plan.filter, filter);
    for (const auto& change : changes) change(plan);
    const bool is_the_suites = !plan.solvers.empty() && plan.solvers == of_the_suite;
    if (is_the_suites || plan.solvers.empty()) {
      for (const SolverEntry& entry : AllSolvers()) {
        const bool is_named_here = entry.origin == SolverOrigin::kExternal || !entry.base.empty();
        if (!is_the_suites || is_named_here) plan.solvers.push_back(entry.key);
      }
    }
    if (tuned.empty() && !plan.tuning.file.empty()) tuned = DataFile(plan.tuning.file);
    if (!tuned.empty()) AddTunedVariants(tuned, !is_the_suites, &plan, &named.variants);
    if (options.folder.empty()) options.folder = "build/results/" + plan.name;
    options.solver_arguments = named.Words();
    ParseShard();
    if (list) {
      for (const std::string& name : CampaignCells(plan, options)) std::cout << name << '\n';
      return 0;
    }
    const int status = RunCampaign(plan, options);
    std::cout << "results: " << options.folder << (status == 0 ? "" : " (interrupted; --resume goes on)") << std::endl;
    return status;
  }

 private:
  // An option that replaces a member of the campaign's plan.
  template <typename Value>
  CLI::Option* AddChange(CLI::App& app, const std::string& names, Value CampaignPlan::*member,
                         const std::string& description) {
    const auto add = [this, member](const Value& value) {
      changes.emplace_back([member, value](CampaignPlan& plan) { plan.*member = value; });
    };
    return app.add_option_function<Value>(names, add, description);
  }

  // "k/N" or "k-m/N"
  void ParseShard() {
    std::smatch parts;
    if (std::regex_match(shard, parts, std::regex("([0-9]{1,6})(?:-([0-9]{1,6}))?/([0-9]{1,6})"))) {
      const int first = std::stoi(parts[1]);
      options.shard = {first, parts[2].matched ? std::stoi(parts[2]) : first, std::stoi(parts[3])};
      if (1 <= first && first <= options.shard.last && options.shard.last <= options.shard.parts) return;
    }
    throw InputError("--shard: expected k/N, or k-m/N, with 1 <= k <= m <= N, found '" + shard + "'");
  }
};

struct CampaignWorker {
  std::string served;
  NamedSolvers named;

  void Declare(CLI::App& app) {
    app.group("");  // of no use to people
    named.Declare(app);
    app.add_option("--serve", served, "Solver key: serves it, as a peer's worker does");
  }

  int Run() const {
    named.Register();
    if (!served.empty()) return ServeSolver(served, {});
    return ServeTasks(named.Words());
  }
};

struct Merge {
  std::vector<std::string> folders;
  std::string output;

  void Declare(CLI::App& app) {
    app.add_option("FOLDER", folders, "Written by lcpbench run --shard")->required();
    app.add_option("-o,--output", output, "A new folder")->required();
  }

  int Run() const {
    MergeCampaigns(folders, output);
    std::cout << "results: " << output << std::endl;
    return 0;
  }
};

}  // namespace

void AddRunCommands(CLI::App& app, CommandRun& run) {
  AddCommand<RunCampaigns>(
      app, run, "run", "Runs a campaign: solves and judges every problem, and times what passed, fresh, into a folder");
  AddCommand<Merge>(app, run, "merge", "Merges the folders of a campaign's shards");
  AddCommand<CampaignWorker>(app, run, "campaign-worker", "Solves and times for `lcpbench run`");
}

}  // namespace lcpbench
