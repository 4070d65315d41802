#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// campaign.json (RESULTS.md): what is run, where, and with which rules. It is written before the first solve.
nlohmann::ordered_json DescribeCampaign(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                                        const std::vector<PlannedProblem>& problems);

/// Two campaigns are one if all but the start's time and the environment is the same.
bool SameCampaign(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

/// @throws InputError naming the file
nlohmann::ordered_json ReadCampaignFile(const std::string& path);
void WriteCampaignFile(const std::string& path, const nlohmann::ordered_json& campaign);

}  // namespace lcpbench
