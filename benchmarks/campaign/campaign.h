#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"

namespace lcpbench {

struct CampaignOptions {
  std::string folder;
  bool resume = false;  ///< go on in a folder that has a campaign of the same plan
  int shard = 1;        ///< of `shards`, from 1
  int shards = 1;
  int cpu = -1;                               ///< the processor that solves are kept on; -1: any
  std::vector<std::string> solver_arguments;  ///< of the command line, by which the user named solvers
  std::function<void()> on_start;             ///< called before the first solve, when nothing is wrong with the plan
};

/// Runs a campaign, or its rest, into a folder (files: RESULTS.md). Rounds: in the first one every cell is solved,
/// judged, and timed where it passed; in the others passed cells are timed again in another order, so that what the
/// machine does meanwhile is spread over all solvers; cells whose median time is still uncertain get more rounds.
/// @return exit status: 0, or 128 + signal where it was interrupted
/// @throws InputError where the plan cannot be run, the folder has another campaign, or has one and `resume` is not set
int RunCampaign(const CampaignPlan& plan, const CampaignOptions& options);

/// The names of all its cells, CellName, by problem, solver, tier and mode; of the shard. Nothing is run.
/// @throws InputError as RunCampaign
std::vector<std::string> CampaignCells(const CampaignPlan& plan, const CampaignOptions& options);

/// Merges folders of shards of one campaign into a new folder: the same files, whatever the order of the folders.
/// @throws InputError where they are not of one campaign, or one has a cell of another
void MergeCampaigns(const std::vector<std::string>& folders, const std::string& output);

}  // namespace lcpbench
