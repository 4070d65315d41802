#pragma once

#include <nlohmann/json.hpp>

namespace lcpbench {

/// What results are measured with: the members of `environment` in campaign.json (RESULTS.md).
nlohmann::ordered_json DescribeEnvironment();

}  // namespace lcpbench
