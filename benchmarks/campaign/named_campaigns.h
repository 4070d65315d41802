#pragma once

#include <vector>

#include "benchmarks/campaign/campaign_plan.h"

namespace lcpbench {

/// The campaigns that `lcpbench run --suite` knows by name. Manifests are by their names in the collection (DataFile);
/// there are no solvers. With "tuned" as tuning file the campaign has KEY-tuned besides, where `lcpbench tune` chose
/// other settings than the default.
const std::vector<CampaignPlan>& NamedCampaigns();

}  // namespace lcpbench
