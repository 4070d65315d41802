#pragma once

#include <immintrin.h>

#include <cstddef>

/// Internal to solvers/batch/: four doubles at once, with AVX2 and FMA. See lanes_avx512.h for the meaning of each
/// operation.
namespace lcpbench {
namespace {

struct LanesAvx2 {
  static constexpr int kWidth = 4;
  using V = __m256d;
  using M = __m256d;

  static V Load(const double* from) { return _mm256_load_pd(from); }
  static void Store(double* to, V v) { _mm256_store_pd(to, v); }
  static V Set(double x) { return _mm256_set1_pd(x); }
  static V Fma(V a, V b, V c) { return _mm256_fmadd_pd(a, b, c); }
  static V Fnma(V a, V b, V c) { return _mm256_fnmadd_pd(a, b, c); }
  static V Max(V a, V b) { return _mm256_max_pd(a, b); }
  static V Min(V a, V b) { return _mm256_min_pd(a, b); }
  static V Abs(V a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
  static V Xor(V a, V b) { return _mm256_xor_pd(a, b); }
  static M Less(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
  static M LessEqual(V a, V b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
  static M SignOf(V a) {
    return _mm256_castsi256_pd(_mm256_cmpgt_epi64(_mm256_setzero_si256(), _mm256_castpd_si256(a)));
  }
  static M Both(M a, M b) { return _mm256_and_pd(a, b); }
  static M Either(M a, M b) { return _mm256_or_pd(a, b); }
  static M Without(M a, M b) { return _mm256_andnot_pd(b, a); }
  static V Select(M m, V a, V b) { return _mm256_blendv_pd(b, a, m); }
  static V Masked(M m, V a) { return _mm256_and_pd(m, a); }
  static bool Any(M m) { return _mm256_movemask_pd(m) != 0; }
  static unsigned Bits(M m) { return static_cast<unsigned>(_mm256_movemask_pd(m)); }
  static M FromBits(unsigned bits) { return _mm256_castsi256_pd(Lanes(bits)); }

  static void LoadTransposed(const double* const* from, std::size_t offset, int count, V* to) {
    for (int l = 0; l < 4; ++l) {
      to[l] = count >= 4 ? _mm256_loadu_pd(from[l] + offset) : _mm256_maskload_pd(from[l] + offset, First(count));
    }
    Transpose(to);
  }
  static void StoreTransposed(V* rows, double* const* to, std::size_t offset, int count) {
    Transpose(rows);
    for (int l = 0; l < 4; ++l) {
      if (count >= 4) {
        _mm256_storeu_pd(to[l] + offset, rows[l]);
      } else {
        _mm256_maskstore_pd(to[l] + offset, First(count), rows[l]);
      }
    }
  }

 private:
  static __m256i First(int count) { return Lanes((1U << static_cast<unsigned>(count)) - 1U); }
  static __m256i Lanes(unsigned bits) {
    const __m256i bit = _mm256_set_epi64x(8, 4, 2, 1);
    return _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(static_cast<long long>(bits)), bit), bit);
  }

  static void Transpose(V* r) {
    const V a = _mm256_unpacklo_pd(r[0], r[1]);
    const V b = _mm256_unpackhi_pd(r[0], r[1]);
    const V c = _mm256_unpacklo_pd(r[2], r[3]);
    const V d = _mm256_unpackhi_pd(r[2], r[3]);
    r[0] = _mm256_permute2f128_pd(a, c, 0x20);
    r[1] = _mm256_permute2f128_pd(b, d, 0x20);
    r[2] = _mm256_permute2f128_pd(a, c, 0x31);
    r[3] = _mm256_permute2f128_pd(b, d, 0x31);
  }
};

}  // namespace
}  // namespace lcpbench
