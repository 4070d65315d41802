#pragma once

#include <cstddef>

#include "solvers/first_order/sweeps/aligned_array.h"
#include "solvers/first_order/sweeps/lanes.h"

/// Internal to solvers/: sums over whole arrays, in a fixed order.
namespace lcpbench {

/// Calls four(i) for i = 0, kLanes, ... and then one(i) for the rest.
template <typename Four, typename One>
LCPBENCH_ALWAYS_INLINE void ForLanes(std::size_t size, Four&& four, One&& one) {
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) four(i);
  for (; i < size; ++i) one(i);
}

/// Which lanes of eight a value of four lanes is; kNone where there are no eight.
enum class HalfOfEight { kLow, kHigh, kNone };

/// A sum of products that are added one, four or eight at a time. The halves of eights are summed apart from all else,
/// so that the total has the same bits where a machine takes them half by half.
class ProductSum {
 public:
  template <HalfOfEight kHalf = HalfOfEight::kNone>
  LCPBENCH_ALWAYS_INLINE void Add(double a, double b) {
    one_ += a * b;
  }
  template <HalfOfEight kHalf = HalfOfEight::kNone>
  LCPBENCH_ALWAYS_INLINE void Add(const Lanes& a, const Lanes& b) {
    if constexpr (kHalf == HalfOfEight::kLow) {
      low_ += a * b;
    } else if constexpr (kHalf == HalfOfEight::kHigh) {
      high_ += a * b;
    } else {
      four_ += a * b;
    }
  }
#ifdef __AVX512F__
  template <HalfOfEight kHalf = HalfOfEight::kNone>
  LCPBENCH_ALWAYS_INLINE void Add(const WideLanes& a, const WideLanes& b) {
    eight_ += a * b;
  }
  double Total() const { return one_ + (Sum(four_) + (Sum(low_ + LowHalf(eight_)) + Sum(high_ + HighHalf(eight_)))); }
#else
  double Total() const { return one_ + (Sum(four_) + (Sum(low_) + Sum(high_))); }
#endif

 private:
  double one_ = 0;
  Lanes four_{};
  Lanes low_{};
  Lanes high_{};
#ifdef __AVX512F__
  WideLanes eight_{};
#endif
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
