#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"

namespace lcpbench {

// What `lcpbench run` does where its suite is a campaign: a set of manifests.

struct CampaignArguments {
  bool resume = false;
  std::string shard = "1/1";
  std::string filter;
  int rounds = 0;       ///< 0: the plan's
  int most_rounds = 0;  ///< 0: twice the rounds
  int cpu = -1;
  std::vector<std::string> modes;      ///< empty: the plan's
  std::vector<std::string> externals;  ///< KEY=COMMAND
  std::vector<std::string> variants;   ///< KEY=SOLVER[,NAME=VALUE]...
  std::string tuned;                   ///< path of a tuned_file.h; "": no tuned variants
};

/// --resume, --shard, --filter, --rounds, --most-rounds, --cpu, --modes, --tuned
void AddCampaignOptions(CLI::App& command, CampaignArguments* arguments);

/// Flags of Google Benchmark that have a meaning for campaigns: --benchmark_filter, --benchmark_repetitions,
/// --benchmark_min_time, --benchmark_out and --benchmark_list_tests.
struct BenchmarkFlags {
  std::string out;
  bool list = false;
};
/// Takes them over into the plan and the arguments. @throws InputError for any other flag
BenchmarkFlags TakeBenchmarkFlags(const std::vector<std::string>& flags, CampaignPlan* plan,
                                  CampaignArguments* arguments);

/// Whether a suite is one of CampaignNames, or a path of a manifest (with a '/' or ending in .json).
bool IsCampaign(const std::string& suite);
std::string CampaignNames();

/// The campaign's plan with all solvers of the build. @throws InputError for an unknown one
CampaignPlan CampaignOf(const std::string& suite);

/// @return exit status
int RunCampaignCommand(CampaignPlan plan, CampaignArguments arguments, const BenchmarkFlags& flags,
                       const std::string& folder);

}  // namespace lcpbench
