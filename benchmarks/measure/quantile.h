#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lcpbench {

/// The q-quantile, q in [0, 1], of one value or more; infinite values are larger than any other. Linear interpolation
/// between order statistics. [Hyndman, Fan, Sample quantiles in statistical packages, 1996, definition 7]
inline double Quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double part = place - std::floor(place);
  // Neither 0 times infinity nor the difference of two infinities is a number.
  if (part == 0 || std::isinf(values[below])) return values[below];
  return values[below] + part * (values[below + 1] - values[below]);
}

/// The weighted quantile of one value or more, each with its weight: the least value with at least `level` of the
/// weight, in (0, 1], at or below it; where that is exactly `level`, the mean of it and the next one. [Same, definition
/// 2, with weights]
inline double WeightedQuantile(std::vector<std::pair<double, double>> values, double level) {
  constexpr double kEqual = 1e-9;  // sums of weights, relative
  std::sort(values.begin(), values.end());
  double all = 0;
  for (const auto& [value, weight] : values) all += weight;
  double below = 0;
  std::size_t at = 0;
  while ((below += values[at].second / all) < level - kEqual && at + 1 < values.size()) ++at;
  const bool is_exact = below <= level + kEqual && at + 1 < values.size();
  return is_exact ? (values[at].first + values[at + 1].first) / 2 : values[at].first;
}

inline double MedianOf(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

}  // namespace lcpbench
