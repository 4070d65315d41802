#pragma once

#include <limits>
#include <vector>

namespace lcpbench {

/// A 95 % confidence interval of a cell's time from the medians of its rounds: what differs between rounds (clock rate,
/// memory layout, neighbours) is common to all repetitions of one, so that rounds are the samples, however many
/// repetitions they have. Student's interval of the logarithms. [Kalibera, Jones, Rigorous benchmarking in reasonable
/// time, ISMM 2013]
struct RoundInterval {
  double center = 0;  ///< the geometric mean of the rounds
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  /// Half its width by its centre; infinite for one round.
  double relative_width() const { return (high - low) / (2 * center); }
};

/// @param medians  of every round, > 0, at least one
RoundInterval IntervalOfRounds(const std::vector<double>& medians);

/// Of at least one sample.  O(n)
double MedianOf(std::vector<double> samples);

}  // namespace lcpbench
