#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace lcpbench {

// The arithmetic of fresh_benchmark's tables: the definitions of the report (report/lcpbench_report/statistics:
// weighted.py, class_times.py), so that its numbers and a campaign's mean the same.

/// The least value with at least `level` of the weight at or below it; where that is exactly `level`, the mean of it
/// and the next one. Infinity is a value; NaN without any.
double WeightedQuantile(const std::vector<double>& values, const std::vector<double>& weights, double level);

/// One solver on the problems of a FreshGroup.
struct FreshTimes {
  std::string solver;
  bool is_own = false;
  /// Times of all problems [s]: infinite where the answer is not verified, NaN where it had no turn within the budget.
  std::vector<double> seconds;
};

/// The problems of one size class and origin.
struct FreshGroup {
  std::string origin;
  std::string size_class;
  std::vector<double> weights;  ///< of the problems
  std::vector<FreshTimes> solvers;
};

/// What one solver does there.
struct FreshSummary {
  std::size_t problems = 0;  ///< that had their turn
  double right = 0;          ///< verified, of their weight
  double median_s = 0;       ///< failures infinite
  double p90_s = 0;          ///< of verified answers, and so p99_s
  double p99_s = 0;          ///< NaN of fewer than kLeastForP99 problems
};

/// Below, less than one problem is beyond the 99th percentile.
inline constexpr std::size_t kLeastForP99 = 100;

FreshSummary Summarize(const FreshTimes& times, const std::vector<double>& weights);

/// The share of the weight that a solver must be right on to be called the best.
inline constexpr double kRightShare = 0.99;
/// Problems that it must have had its turn at.
inline constexpr std::size_t kLeastTurns = 20;

/// The one with the least median of the peers (or of our own solvers) that are right on `least` of the weight; null
/// where none is.
const FreshTimes* BestOf(const FreshGroup& group, bool own, double least = kRightShare);

/// Weighted median of time / time of `other` over the problems on which both had their turn and `other` is verified;
/// NaN without any.
double RatioTo(const std::vector<double>& seconds, const std::vector<double>& other,
               const std::vector<double>& weights);

/// The least time of a peer on each problem: infinite where none is verified.
std::vector<double> FastestPeer(const FreshGroup& group);

/// Tables in Markdown: for every origin a line per size class and solver; then, for every own solver, origins by size
/// classes with the ratio to the best right peer.
/// @param groups  by origin, and within by size class
void WriteFreshTables(const std::vector<FreshGroup>& groups, std::ostream& out);

}  // namespace lcpbench
