#pragma once

#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "solvers/registry.h"

namespace lcpbench {

/// What `lcpbench tune` has chosen (tuned.json, RESULTS.md; docs/formats/tuned.schema.json).
struct TunedFile {
  TuningSource source;
  std::vector<std::pair<std::string, Settings>> chosen;  ///< by solver; empty: the default
};

/// @throws InputError naming the file and the field, and what was expected
TunedFile ReadTunedFile(const std::string& path);

}  // namespace lcpbench
