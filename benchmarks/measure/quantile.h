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

inline double MedianOf(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

}  // namespace lcpbench
