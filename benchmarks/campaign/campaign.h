#pragma once

#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"

namespace lcpbench {

struct CampaignOptions {
  std::string folder;
  bool resume = false;  ///< go on in a folder that has a campaign of the same plan
  Shard shard = {};
  int cpu = -1;                               ///< the processor that solves are kept on; -1: any
  std::vector<std::string> solver_arguments;  ///< of the command line, by which the user named solvers
};

/// Runs a campaign, or its rest, into a folder (files: RESULTS.md). First every task is judged: its problems are solved
/// one by one, with limits. Then come the timed passes over what was verified (fresh_pass.h), tasks in another order
/// each time, so that what the machine does meanwhile is spread over all solvers.
/// @return exit status: 0, or 128 + signal where it was interrupted
/// @throws InputError where the plan cannot be run, the folder has another campaign, or has one and `resume` is not set
int RunCampaign(const CampaignPlan& plan, const CampaignOptions& options);

/// The names of all that it solves, CellName and PassName; of the shard. Nothing is run.
/// @throws InputError as RunCampaign
std::vector<std::string> CampaignCells(const CampaignPlan& plan, const CampaignOptions& options);

/// Merges folders of shards of one campaign into a new folder: the same files, whatever the order of the folders.
/// @throws InputError where they are not of one campaign, or one has a cell of another
void MergeCampaigns(const std::vector<std::string>& folders, const std::string& output);

}  // namespace lcpbench
