#pragma once

#include <span>
#include <string_view>

#include "solvers/lcp/verify.h"

namespace lcpbench {

/// Names and formulas of the scalar metrics: one table for files, the command and the report.
struct MetricEntry {
  std::string_view key;
  double Metrics::*value;
  std::string_view formula;
};

/// The primary metric first.
std::span<const MetricEntry> AllMetrics();

}  // namespace lcpbench
