#pragma once

#include <Eigen/Core>
#include <cstring>
#include <type_traits>

#ifdef __SSE2__
#include <immintrin.h>
#endif

/// Internal to solvers/: four doubles (or eight) that are worked on at once, and sums over arrays in a fixed order. The
/// compiler's vector types, not one machine's intrinsics: without AVX the same source becomes pairs of SSE2 operations.
/// The passes over rows are compiled without contraction to fused operations, so that a row gives the same bits alone
/// and among others, and on every machine.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace lcpbench {

using Array = Eigen::VectorXd;  ///< starts at a cache line (EIGEN_MAX_ALIGN_BYTES)

inline constexpr Eigen::Index kLanes = 4;

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kLanes * sizeof(double))));
using WideLanes = double __attribute__((vector_size(2 * kLanes * sizeof(double))));
using WideLaneMask = long long __attribute__((vector_size(2 * kLanes * sizeof(double))));

// Forced, because a vector passed to a real function has no ABI where the machine lacks the registers; GCC warns all
// the same.
#define LCPBENCH_ALWAYS_INLINE [[gnu::always_inline]] inline

/// T: double, Lanes or WideLanes. Addresses need no alignment.
template <typename T = Lanes>
LCPBENCH_ALWAYS_INLINE T Load(const double* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <typename T>
LCPBENCH_ALWAYS_INLINE void Store(double* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
}
template <typename T = Lanes>
LCPBENCH_ALWAYS_INLINE T Filled(double value) {
  return value - T{};
}
/// Bits of `lanes` where the mask's bits are set.
template <typename T, typename Mask>
LCPBENCH_ALWAYS_INLINE T Masked(const T& lanes, const Mask& mask) {
  return reinterpret_cast<T>(reinterpret_cast<Mask>(lanes) & mask);
}
/// max(value, floor), and a NaN that is a NaN. One number is treated as the first of two: the compiler would turn a
/// comparison into a branch, which no processor foresees over 10^5 rows; eight are one instruction, which the compiler
/// does not find in the comparison where the floor is 0.
template <typename T>
LCPBENCH_ALWAYS_INLINE T AtLeast(const T& floor, const T& value) {
#ifdef __SSE2__
  if constexpr (std::is_same_v<T, double>) return _mm_cvtsd_f64(_mm_max_sd(_mm_set_sd(floor), _mm_set_sd(value)));
#endif
#ifdef __AVX512F__
  if constexpr (std::is_same_v<T, WideLanes>) return _mm512_max_pd(floor, value);
#endif
  return floor > value ? floor : value;
}
/// a b + c, rounded once where the machine can: not where rows alone and among others must give the same bits.
template <typename T>
LCPBENCH_ALWAYS_INLINE T Fused(const T& a, const T& b, const T& c) {
#ifdef __FMA__
  if constexpr (std::is_same_v<T, Lanes>) return _mm256_fmadd_pd(a, b, c);
#endif
#ifdef __AVX512F__
  if constexpr (std::is_same_v<T, WideLanes>) return _mm512_fmadd_pd(a, b, c);
#endif
  return a * b + c;
}
LCPBENCH_ALWAYS_INLINE double Sum(const Lanes& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }
/// Lanes of the same sum.
LCPBENCH_ALWAYS_INLINE const Lanes& Folded(const Lanes& lanes) { return lanes; }
LCPBENCH_ALWAYS_INLINE Lanes Folded(const WideLanes& lanes) {
  return __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) + __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
}

/// Which lanes of eight a value of four lanes is; kNone where there are no eight.
enum class HalfOfEight { kLow, kHigh, kNone };

/// A sum of vectors in registers. Without AVX by pairs: GCC 12 keeps vectors wider than registers in memory from one
/// turn of a loop to the next.
#ifdef __AVX__
template <typename T>
using Kept = T;
#else
template <typename T>
struct Kept {
  using Pair = double __attribute__((vector_size(2 * sizeof(double))));
  static constexpr int kPairs = sizeof(T) / sizeof(Pair);
  Pair pair[kPairs] = {};

  LCPBENCH_ALWAYS_INLINE void operator+=(const T& more) {
    for (int i = 0; i < kPairs; ++i) pair[i] += Pair{more[2 * i], more[2 * i + 1]};
  }
  LCPBENCH_ALWAYS_INLINE operator T() const {  // NOLINT(google-explicit-constructor): as where it is T
    T all;
    std::memcpy(&all, pair, sizeof all);
    return all;
  }
};
#endif

/// A sum of products that are added one, four or eight at a time. The halves of eights are summed apart from all else,
/// so that the total has the same bits where a machine takes them half by half.
class ProductSum {
 public:
  template <HalfOfEight kHalf = HalfOfEight::kNone, typename T>
  LCPBENCH_ALWAYS_INLINE void Add(const T& a, const T& b) {
    if constexpr (std::is_same_v<T, double>) {
      one_ += a * b;
    } else if constexpr (std::is_same_v<T, WideLanes>) {
      eight_ += a * b;
    } else if constexpr (kHalf == HalfOfEight::kLow) {
      low_ += a * b;
    } else if constexpr (kHalf == HalfOfEight::kHigh) {
      high_ += a * b;
    } else {
      four_ += a * b;
    }
  }
  LCPBENCH_ALWAYS_INLINE double Total() const {
    const WideLanes eight = eight_;
    Lanes low = low_;
    Lanes high = high_;
    low += __builtin_shufflevector(eight, eight, 0, 1, 2, 3);
    high += __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
    return one_ + (Sum(four_) + (Sum(low) + Sum(high)));
  }

 private:
  double one_ = 0;
  Kept<Lanes> four_{};
  Kept<Lanes> low_{};
  Kept<Lanes> high_{};
  Kept<WideLanes> eight_{};
};

/// The same of products that are added one at a time alone.
class SumOneByOne {
 public:
  template <HalfOfEight kHalf = HalfOfEight::kNone>
  LCPBENCH_ALWAYS_INLINE void Add(double a, double b) {
    sum_ += a * b;
  }
  double Total() const { return sum_; }

 private:
  double sum_ = 0;
};

/// Calls take(at) for entries by fours and the rest one by one: at(x) are those of the array x, as Lanes or double.
template <typename Take>
LCPBENCH_ALWAYS_INLINE void ForEntries(Eigen::Index size, const Take& take) {
  Eigen::Index i = 0;
  for (; i + kLanes <= size; i += kLanes) take([i](const Array& x) { return Load(x.data() + i); });
  for (; i < size; ++i) take([i](const Array& x) { return x[i]; });
}
inline double Dot(Eigen::Index size, const Array& a, const Array& b) {
  ProductSum sum;
  ForEntries(size, [&](const auto& at) { sum.Add(at(a), at(b)); });
  return sum.Total();
}
/// (a - a0).(b - b0)
inline double DotOfDifferences(Eigen::Index size, const Array& a, const Array& a0, const Array& b, const Array& b0) {
  ProductSum sum;
  ForEntries(size, [&](const auto& at) { sum.Add(at(a) - at(a0), at(b) - at(b0)); });
  return sum.Total();
}

}  // namespace lcpbench
