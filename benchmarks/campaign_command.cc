#include "benchmarks/campaign_command.h"

#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/benchmark_json.h"
#include "benchmarks/campaign/campaign.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/commands.h"
#include "benchmarks/external_option.h"
#include "benchmarks/tuned_file.h"
#include "benchmarks/variant_option.h"
#include "build_info.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

struct NamedCampaign {
  const char* name;
  std::vector<const char*> tiers;  // of the collection
  double most_s;                   // the longest time limit of a solve
  std::vector<double> tolerances;  // empty: the plan's tiers
  const char* filter = "";
};

const std::vector<NamedCampaign>& Campaigns() {
  static const std::vector<NamedCampaign> campaigns{
      {"smoke", {"smoke"}, 0.5, {}},
      {"engine", {"engine"}, 0.5, {}},
      {"standard", {"engine", "standard"}, 2, {}},
      {"pathological", {"pathological"}, 2, {}},
      {"large", {"large"}, 60, {}},
      // What every decade of precision costs.
      {"precision",
       {"standard"},
       2,
       {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12},
       "-n(40|250|1000)-s1/"},
      {"sequences", {"sequences"}, 0.5, {}},
  };
  return campaigns;
}

bool IsPath(const std::string& suite) { return suite.find('/') != std::string::npos || suite.ends_with(".json"); }

std::string ManifestOf(const char* tier) {
  for (const std::string& folder : {std::string("data"), std::string(kDataFolder)}) {
    std::string path = folder + "/" + tier + ".json";
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError(std::string("data/") + tier + ".json: not there, nor in " + kDataFolder);
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

}  // namespace

void AddCampaignOptions(CLI::App& command, CampaignArguments* arguments) {
  command.add_flag("--resume", arguments->resume, "Campaigns: go on with the one that the folder has");
  command.add_option("--shard", arguments->shard, "Campaigns: k/N, the k-th of N parts; see lcpbench merge")
      ->capture_default_str();
  command.add_option(
      "--filter", arguments->filter,
      "Campaigns: only cells solve/PROBLEM/SOLVER/TIER, or steps/SEQUENCE/SOLVER/TIER/MODE, that match this "
      "regular expression");
  command.add_option("--rounds", arguments->rounds, "Campaigns: how often every cell is visited");
  command.add_option(
      "--most-rounds", arguments->most_rounds,
      "Campaigns: how often at most, while its time is uncertain by more than 5 % [default: a third more]");
  command.add_option("--cpu", arguments->cpu, "Campaigns: the processor that solves are kept on");
  command
      .add_option("--modes", arguments->modes,
                  "Campaigns: cold (with warm caches), cold-cache (caches emptied before every solve) [default: cold]")
      ->delimiter(',');
  command.add_option(
      "--tuned", arguments->tuned,
      "Campaigns: adds KEY-tuned for every solver that `lcpbench tune` chose settings for, data/tuned.json");
}

BenchmarkFlags TakeBenchmarkFlags(const std::vector<std::string>& flags, CampaignPlan* plan,
                                  CampaignArguments* arguments) {
  BenchmarkFlags taken;
  for (const std::string& flag : flags) {
    const size_t equals = flag.find('=');
    const std::string name = flag.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : flag.substr(equals + 1);
    const auto number = [&](auto* into) {
      const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), *into);
      if (error != std::errc() || stop != value.data() + value.size()) {
        throw InputError(name + ": expected a number, found '" + value + "'");
      }
    };
    if (name == "--benchmark_filter") {
      arguments->filter = value;
    } else if (name == "--benchmark_repetitions") {
      number(&plan->repetitions);
    } else if (name == "--benchmark_min_time") {
      number(&plan->min_time_s);
    } else if (name == "--benchmark_out") {
      taken.out = value;
    } else if (name == "--benchmark_list_tests") {
      taken.list = value != "false";
    } else if (flag != "--benchmark_out_format=json") {
      throw InputError("run: unexpected argument '" + flag + "'");
    }
  }
  return taken;
}

bool IsCampaign(const std::string& suite) {
  for (const NamedCampaign& campaign : Campaigns()) {
    if (suite == campaign.name) return true;
  }
  return IsPath(suite);
}

std::string CampaignNames() {
  std::string names;
  for (const NamedCampaign& campaign : Campaigns()) names += (names.empty() ? "" : ", ") + std::string(campaign.name);
  return names;
}

CampaignPlan CampaignOf(const std::string& suite) {
  CampaignPlan plan;
  plan.name = suite;
  for (const SolverEntry& entry : AllSolvers()) plan.solvers.push_back(entry.key);
  for (const NamedCampaign& campaign : Campaigns()) {
    if (suite != campaign.name) continue;
    for (const char* tier : campaign.tiers) plan.manifests.push_back(ManifestOf(tier));
    plan.most_s = campaign.most_s;
    if (!campaign.tolerances.empty()) plan.tiers = campaign.tolerances;
    plan.filter = campaign.filter;
    return plan;
  }
  plan.name = std::filesystem::path(suite).stem().string();
  plan.manifests = {suite};
  return plan;
}

int RunCampaignCommand(CampaignPlan plan, CampaignArguments arguments, const BenchmarkFlags& flags,
                       const std::string& folder) {
  if (!arguments.filter.empty()) plan.filter = arguments.filter;
  if (arguments.rounds != 0) plan.rounds = arguments.rounds;
  plan.most_rounds = arguments.most_rounds != 0 ? arguments.most_rounds : plan.rounds + plan.rounds / 3;
  CampaignOptions options;
  options.folder = folder;
  options.resume = arguments.resume;
  options.cpu = arguments.cpu;
  if (!arguments.modes.empty()) plan.modes = arguments.modes;
  if (!arguments.tuned.empty()) AddTunedVariants(arguments.tuned, &plan, &arguments.variants);
  for (const std::string& external : arguments.externals) {
    options.solver_arguments.insert(options.solver_arguments.end(), {"--external", external});
  }
  for (const std::string& variant : arguments.variants) {
    options.solver_arguments.insert(options.solver_arguments.end(), {"--variant", variant});
  }
  std::tie(options.shard, options.shards) = ParseShard(arguments.shard);
  if (flags.list) {
    for (const std::string& name : CampaignCells(plan, options)) std::cout << name << '\n';
    return 0;
  }
  const int status = RunCampaign(plan, options);
  if (!flags.out.empty()) WriteBenchmarkJson(folder, flags.out);
  std::cout << "results: " << folder << (status == 0 ? "" : " (interrupted; --resume goes on)") << std::endl;
  return status;
}

void AddCampaignWorkerCommand(CLI::App& app, CommandRun& run) {
  CLI::App* worker = app.add_subcommand("campaign-worker", "Runs cells for `lcpbench run`");
  worker->group("");  // of no use to people
  const auto externals = AddExternalOption(*worker);
  const auto variants = AddVariantOption(*worker);
  worker->callback([externals, variants, &run] {
    run = [externals, variants] {
      RegisterExternals(*externals);
      RegisterVariants(*variants);
      return ServeCells();
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
