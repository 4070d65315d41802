#pragma once

#include <vector>

namespace lcpbench {

/// A confidence interval of at least 95 % of the median of what the samples come from, whatever their distribution: two
/// order statistics, by the binomial distribution of how many samples lie below the median. [Conover, Practical
/// Nonparametric Statistics, 1999, sec. 3.2]
struct MedianInterval {
  double median = 0;
  double low = 0;
  double high = 0;
  /// Half its width by the median.
  double relative_width() const { return (high - low) / (2 * median); }
};

/// Of at least one sample; of fewer than six the interval reaches from the least to the largest and says less than 95
/// %. O(n log n)
MedianInterval IntervalOfMedian(std::vector<double> samples);

}  // namespace lcpbench
