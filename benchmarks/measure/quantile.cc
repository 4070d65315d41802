#include "benchmarks/measure/quantile.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {

double Quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(place));
  const double part = place - std::floor(place);
  // Neither 0 times infinity nor the difference of two infinities is a number.
  if (part == 0 || std::isinf(values[below])) return values[below];
  return values[below] + part * (values[below + 1] - values[below]);
}

}  // namespace lcpbench
