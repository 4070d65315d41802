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
  std::vector<std::string> externals;  ///< KEY=COMMAND
};

/// --resume, --shard, --filter, --rounds, --most-rounds, --cpu
void AddCampaignOptions(CLI::App& command, CampaignArguments* arguments);

/// Whether a suite is one of CampaignNames, or a path of a manifest (with a '/' or ending in .json).
bool IsCampaign(const std::string& suite);
std::string CampaignNames();

/// The campaign's plan with all solvers of the build. @throws InputError for an unknown one
CampaignPlan CampaignOf(const std::string& suite);

/// @return exit status
int RunCampaignCommand(CampaignPlan plan, const CampaignArguments& arguments, const std::string& folder);

}  // namespace lcpbench
