#pragma once

#include <utility>
#include <vector>

namespace lcpbench {

/// The q-quantile, q in [0, 1], of one value or more; infinite values are larger than any other. Linear interpolation
/// between order statistics. [Hyndman, Fan, Sample quantiles in statistical packages, 1996, definition 7]
double Quantile(std::vector<double> values, double q);

inline double MedianOf(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

}  // namespace lcpbench
