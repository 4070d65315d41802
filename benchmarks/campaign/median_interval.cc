#include "benchmarks/campaign/median_interval.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace lcpbench {

RoundInterval IntervalOfRounds(const std::vector<double>& medians) {
  const auto count = static_cast<double>(medians.size());
  double mean = 0;
  for (const double median : medians) mean += std::log(median) / count;
  RoundInterval interval;
  interval.center = std::exp(mean);
  if (medians.size() < 2) return interval;
  double squares = 0;
  for (const double median : medians) squares += (std::log(median) - mean) * (std::log(median) - mean);
  constexpr double kUpper = 0.975;
  const double student = boost::math::quantile(boost::math::students_t(count - 1), kUpper);
  const double half = student * std::sqrt(squares / (count - 1) / count);
  interval.low = std::exp(mean - half);
  interval.high = std::exp(mean + half);
  return interval;
}

double MedianOf(std::vector<double> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(samples.begin(), middle));
}

}  // namespace lcpbench
