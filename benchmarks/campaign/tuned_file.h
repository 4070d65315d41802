#pragma once

#include <map>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "solvers/registry.h"

namespace lcpbench {

/// What `lcpbench tune` has chosen (tuned.json, RESULTS.md; docs/formats/tuned.schema.json).
struct TunedFile {
  TuningSource source;
  /// By solver and the rows that they are meant for; empty: the default.
  std::map<std::string, std::map<Index, Settings>> chosen;
};

/// @throws InputError naming the file and the field, and what was expected; here and below
TunedFile ReadTunedFile(const std::string& path);

/// By size class the peers to ask in turn (CampaignPlan::portfolio) that `report.py portfolio` has chosen.
std::map<std::string, std::vector<std::string>> ReadPortfolio(const std::string& path);

}  // namespace lcpbench
