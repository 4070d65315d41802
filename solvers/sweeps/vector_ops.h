#pragma once

#include <cstddef>

#include "solvers/sweeps/aligned_array.h"
#include "solvers/sweeps/lanes.h"

/// Internal to solvers/: sums over whole arrays, in a fixed order.
namespace lcpbench {

/// Calls four(i) for i = 0, kLanes, ... and then one(i) for the rest.
template <typename Four, typename One>
LCPBENCH_ALWAYS_INLINE void ForLanes(std::size_t size, Four&& four, One&& one) {
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) four(i);
  for (; i < size; ++i) one(i);
}

/// A sum of products that are added four at a time.
class ProductSum {
 public:
  LCPBENCH_ALWAYS_INLINE void Add(double a, double b) { one_ += a * b; }
  LCPBENCH_ALWAYS_INLINE void Add(const Lanes& a, const Lanes& b) { four_ += a * b; }
  double Total() const { return one_ + Sum(four_); }

 private:
  double one_ = 0;
  Lanes four_{};
};

inline double Dot(const Array& a, const Array& b) {
  ProductSum sum;
  ForLanes(
      a.size(), [&](std::size_t i) { sum.Add(Load(&a[i]), Load(&b[i])); }, [&](std::size_t i) { sum.Add(a[i], b[i]); });
  return sum.Total();
}

/// (a - a0).(b - b0)
inline double DotOfDifferences(const Array& a, const Array& a0, const Array& b, const Array& b0) {
  ProductSum sum;
  ForLanes(
      a.size(), [&](std::size_t i) { sum.Add(Load(&a[i]) - Load(&a0[i]), Load(&b[i]) - Load(&b0[i])); },
      [&](std::size_t i) { sum.Add(a[i] - a0[i], b[i] - b0[i]); });
  return sum.Total();
}

}  // namespace lcpbench
