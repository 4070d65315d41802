#pragma once

#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"

namespace lcpbench {

/// Reads what `lcpbench tune` has chosen (tuned.json, RESULTS.md) and registers, for every solver of the plan with
/// settings other than its defaults, the variant KEY-tuned. Solvers that are not in this build have none.
///
/// @param path      the file
/// @param plan      its solvers get the variants, each behind its base; its tuning names the file
/// @param variants  get them as --variant takes them, for worker processes
/// @throws InputError naming the file for what is no such file, and as RegisterVariants
void AddTunedVariants(const std::string& path, CampaignPlan* plan, std::vector<std::string>* variants);

}  // namespace lcpbench
