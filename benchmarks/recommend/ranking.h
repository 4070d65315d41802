#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmarks/recommend/measurement.h"

namespace lcpbench {

/// What is asked of a solver.
struct RecommendationRequest {
  double tolerance = 1e-6;
  std::optional<double> deadline_s;  ///< of set-up and solve of a step
  bool by_tail = false;              ///< rank by the 99th percentile (several steps), else by the median (one problem)
};

/// A measurement, judged by the request.
struct Assessment {
  Measurement measured;
  // Of the steps' latencies [s] (Quantile).
  double p50_s = 0;
  double p99_s = 0;
  double max_s = 0;
  double in_time = 1;       ///< share of the steps within the deadline; 1 without one
  double verified = 0;      ///< share of the steps verified at the tolerance
  bool meets = false;       ///< all steps verified, and the deadline met at the 99th percentile
  std::string shortcoming;  ///< why it does not meet the request; "" where it does
  double time_s = 0;        ///< what it is ranked by
};

/// Ranks: those that meet the request first, by time; then the rest, by the share of verified steps, the share in time,
/// and time. What is equal stays in the order given.
std::vector<Assessment> RankMeasurements(const std::vector<Measurement>& measurements,
                                         const RecommendationRequest& request);

/// As printf writes it. @param format  of one double
std::string FormatNumber(double value, const char* format);

}  // namespace lcpbench
