#pragma once

#include <emmintrin.h>

#include <cstddef>

/// Internal to solvers/batch/: two doubles at once, with what every x86-64 has. See lanes_avx512.h for the meaning of
/// each operation. Products and sums are rounded separately here.
namespace lcpbench {
namespace {

struct LanesSse2 {
  static constexpr int kWidth = 2;
  using V = __m128d;
  using M = __m128d;

  static V Load(const double* from) { return _mm_load_pd(from); }
  static void Store(double* to, V v) { _mm_store_pd(to, v); }
  static V Set(double x) { return _mm_set1_pd(x); }
  static V Fma(V a, V b, V c) { return _mm_add_pd(_mm_mul_pd(a, b), c); }
  static V Fnma(V a, V b, V c) { return _mm_sub_pd(c, _mm_mul_pd(a, b)); }
  static V Max(V a, V b) { return _mm_max_pd(a, b); }
  static V Min(V a, V b) { return _mm_min_pd(a, b); }
  static V Abs(V a) { return _mm_andnot_pd(_mm_set1_pd(-0.0), a); }
  static V Xor(V a, V b) { return _mm_xor_pd(a, b); }
  static M Less(V a, V b) { return _mm_cmplt_pd(a, b); }
  static M LessEqual(V a, V b) { return _mm_cmple_pd(a, b); }
  static M SignOf(V a) {
    const __m128i high = _mm_srai_epi32(_mm_castpd_si128(a), 31);
    return _mm_castsi128_pd(_mm_shuffle_epi32(high, 0xf5));
  }
  static M Both(M a, M b) { return _mm_and_pd(a, b); }
  static M Either(M a, M b) { return _mm_or_pd(a, b); }
  static M Without(M a, M b) { return _mm_andnot_pd(b, a); }
  static V Select(M m, V a, V b) { return _mm_or_pd(_mm_and_pd(m, a), _mm_andnot_pd(m, b)); }
  static V Masked(M m, V a) { return _mm_and_pd(m, a); }
  static bool Any(M m) { return _mm_movemask_pd(m) != 0; }
  static unsigned Bits(M m) { return static_cast<unsigned>(_mm_movemask_pd(m)); }
  static M FromBits(unsigned bits) {
    return _mm_castsi128_pd(_mm_set_epi64x((bits & 2U) != 0 ? -1 : 0, (bits & 1U) != 0 ? -1 : 0));
  }

  static void LoadTransposed(const double* const* from, std::size_t offset, int count, V* to) {
    V r[2];
    for (int l = 0; l < 2; ++l) r[l] = count > 1 ? _mm_loadu_pd(from[l] + offset) : _mm_load_sd(from[l] + offset);
    to[0] = _mm_unpacklo_pd(r[0], r[1]);
    to[1] = _mm_unpackhi_pd(r[0], r[1]);
  }
  static void StoreTransposed(const V* rows, double* const* to, std::size_t offset, int count) {
    const V first = _mm_unpacklo_pd(rows[0], rows[1]);
    const V second = _mm_unpackhi_pd(rows[0], rows[1]);
    if (count > 1) {
      _mm_storeu_pd(to[0] + offset, first);
      _mm_storeu_pd(to[1] + offset, second);
    } else {
      _mm_store_sd(to[0] + offset, first);
      _mm_store_sd(to[1] + offset, second);
    }
  }
};

}  // namespace
}  // namespace lcpbench
