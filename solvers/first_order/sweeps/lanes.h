#pragma once

#include <cstddef>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

/// Internal to solvers/: four doubles that are worked on at once. The compiler's vector types, not one machine's
/// intrinsics: without AVX the same source becomes pairs of SSE2 operations. The sources in solvers/first_order/sweeps/
/// are compiled without contraction to fused operations, so that a row gives the same bits alone and among others, and
/// on every machine.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace lcpbench {

inline constexpr std::size_t kLanes = 4;

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kLanes * sizeof(double))));

// Forced, because a 32-byte vector passed to a real function has no ABI where AVX is off; GCC warns all the same.
#define LCPBENCH_ALWAYS_INLINE [[gnu::always_inline]] inline

LCPBENCH_ALWAYS_INLINE Lanes Load(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
LCPBENCH_ALWAYS_INLINE void Store(double* to, const Lanes& lanes) { std::memcpy(to, &lanes, sizeof lanes); }
LCPBENCH_ALWAYS_INLINE Lanes Broadcast(double value) { return Lanes{value, value, value, value}; }
/// Bits of `lanes` where the mask's bits are set.
LCPBENCH_ALWAYS_INLINE Lanes Masked(const Lanes& lanes, const LaneMask& mask) {
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(lanes) & mask);
}
/// max(value, floor), and a NaN that is a NaN. One number is treated as the first of two: the compiler would turn a
/// comparison into a branch, which no processor foresees over 10^5 rows.
LCPBENCH_ALWAYS_INLINE double AtLeast(double floor, double value) {
#ifdef __SSE2__
  return _mm_cvtsd_f64(_mm_max_sd(_mm_set_sd(floor), _mm_set_sd(value)));
#else
  return floor > value ? floor : value;
#endif
}
LCPBENCH_ALWAYS_INLINE Lanes AtLeast(const Lanes& floor, const Lanes& value) { return floor > value ? floor : value; }
LCPBENCH_ALWAYS_INLINE double Sum(const Lanes& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

#ifdef __AVX512F__
/// Eight doubles, where the machine has registers for them.
using WideLanes = double __attribute__((vector_size(2 * kLanes * sizeof(double))));

LCPBENCH_ALWAYS_INLINE WideLanes LoadWide(const double* from) {
  WideLanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
LCPBENCH_ALWAYS_INLINE void Store(double* to, const WideLanes& lanes) { std::memcpy(to, &lanes, sizeof lanes); }
/// One instruction, which the compiler does not find in the comparison where the floor is 0.
LCPBENCH_ALWAYS_INLINE WideLanes AtLeast(const WideLanes& floor, const WideLanes& value) {
  return _mm512_max_pd(floor, value);
}
LCPBENCH_ALWAYS_INLINE Lanes LowHalf(const WideLanes& lanes) {
  return __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3);
}
LCPBENCH_ALWAYS_INLINE Lanes HighHalf(const WideLanes& lanes) {
  return __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
}
#endif

}  // namespace lcpbench
