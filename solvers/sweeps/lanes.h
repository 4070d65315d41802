#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <new>
#include <vector>

/// Internal to solvers/: four doubles that are worked on at once. The compiler's vector types, not one machine's
/// intrinsics: without AVX the same source becomes pairs of SSE2 operations. The sources in solvers/sweeps/ are compiled
/// without contraction to fused operations, so that a row gives the same bits alone and among others, and on every
/// machine.
namespace lcpbench {

inline constexpr std::size_t kLanes = 4;
inline constexpr std::size_t kCacheLine = 64;

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kLanes * sizeof(double))));

// Forced, because a 32-byte vector passed to a real function has no ABI where AVX is off.
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
LCPBENCH_ALWAYS_INLINE double Sum(const Lanes& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

/// Memory that starts at a cache line.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>& /*other*/) {}
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t{kCacheLine}));
  }
  void deallocate(T* memory, std::size_t /*count*/) { ::operator delete(memory, std::align_val_t{kCacheLine}); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};
template <typename T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;
using Array = AlignedVector<double>;

}  // namespace lcpbench
