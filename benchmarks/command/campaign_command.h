#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

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
  std::vector<std::string> externals;  ///< KEY=COMMAND
  std::vector<std::string> variants;   ///< KEY=SOLVER[,NAME=VALUE]...
  std::string tuned;                   ///< path of a tuned_file.h; "": no tuned variants
  std::string benchmark_json;          ///< file for the times as Google Benchmark writes them; "": none
  bool list = false;                   ///< the cells' names only
};

/// The names of all campaigns that have one, for messages.
std::string CampaignNames();

/// @return exit status
/// @throws InputError for an unknown campaign, and as RunCampaign
int RunCampaignCommand(CampaignArguments arguments);

}  // namespace lcpbench
