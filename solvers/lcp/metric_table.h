#pragma once

#include <span>
#include <string_view>

#include "solvers/lcp/verify.h"

namespace lcpbench {

/// Names and formulas of the scalar metrics: one table for files, the command and the report.
struct MetricEntry {
  std::string_view key;      ///< in files and tables: "rho", "backward_error", ...
  double Metrics::*value;    ///< where Metrics has it
  std::string_view formula;  ///< one line
};

/// The primary metric first.
std::span<const MetricEntry> AllMetrics();

}  // namespace lcpbench
