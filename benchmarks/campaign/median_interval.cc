#include "benchmarks/campaign/median_interval.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cstddef>

namespace lcpbench {

MedianInterval IntervalOfMedian(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  // As many samples are left out at each end as lie beyond the median with a probability of 2.5 % at most.
  constexpr double kTail = 0.025;
  const boost::math::binomial_distribution<double> below(static_cast<double>(n), 0.5);
  std::size_t left_out = 0;
  while (2 * left_out + 1 < n && boost::math::cdf(below, static_cast<double>(left_out)) <= kTail) ++left_out;
  if (left_out > 0) --left_out;
  MedianInterval interval;
  const std::size_t middle = n / 2;
  interval.median = n % 2 == 1 ? samples[middle] : 0.5 * (samples[middle - 1] + samples[middle]);
  interval.low = samples[left_out];
  interval.high = samples[n - 1 - left_out];
  return interval;
}

}  // namespace lcpbench
