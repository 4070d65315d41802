#pragma once

#include <immintrin.h>

#include <cstddef>

/// Internal to solvers/batch/: eight doubles at once, with AVX-512 F, DQ and VL. In an unnamed namespace like all that
/// kernels are made of: what is compiled for one instruction set must never be linked in place of another's.
namespace lcpbench {
namespace {

struct LanesAvx512 {
  static constexpr int kWidth = 8;
  using V = __m512d;
  using M = __mmask8;

  static V Load(const double* from) { return _mm512_load_pd(from); }
  static void Store(double* to, V v) { _mm512_store_pd(to, v); }
  static V Set(double x) { return _mm512_set1_pd(x); }
  static V Fma(V a, V b, V c) { return _mm512_fmadd_pd(a, b, c); }    ///< a b + c
  static V Fnma(V a, V b, V c) { return _mm512_fnmadd_pd(a, b, c); }  ///< c - a b
  static V Max(V a, V b) { return _mm512_max_pd(a, b); }
  static V Min(V a, V b) { return _mm512_min_pd(a, b); }
  static V Abs(V a) { return _mm512_abs_pd(a); }
  static V Xor(V a, V b) { return _mm512_xor_pd(a, b); }
  static M Less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
  static M LessEqual(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
  /// Lanes whose sign bit is set.
  static M SignOf(V a) { return _mm512_movepi64_mask(_mm512_castpd_si512(a)); }
  static M Both(M a, M b) { return static_cast<M>(a & b); }
  static M Either(M a, M b) { return static_cast<M>(a | b); }
  static M Without(M a, M b) { return static_cast<M>(a & ~b); }
  static V Select(M m, V a, V b) { return _mm512_mask_blend_pd(m, b, a); }  ///< a where m, else b
  static V Masked(M m, V a) { return _mm512_maskz_mov_pd(m, a); }
  static bool Any(M m) { return m != 0; }
  static unsigned Bits(M m) { return m; }
  static M FromBits(unsigned bits) { return static_cast<M>(bits); }

  /// to[j] has from[l][offset + j] in lane l, j < count <= kWidth; nothing beyond is read.
  static void LoadTransposed(const double* const* from, std::size_t offset, int count, V* to) {
    for (int l = 0; l < 8; ++l) to[l] = _mm512_maskz_loadu_pd(First(count), from[l] + offset);
    Transpose(to);
  }
  /// The opposite. Changes `rows`.
  static void StoreTransposed(V* rows, double* const* to, std::size_t offset, int count) {
    Transpose(rows);
    for (int l = 0; l < 8; ++l) _mm512_mask_storeu_pd(to[l] + offset, First(count), rows[l]);
  }

 private:
  static __mmask8 First(int count) { return static_cast<__mmask8>((1U << static_cast<unsigned>(count)) - 1U); }

  static void Transpose(V* r) {
    V t[8];
    for (int l = 0; l < 8; l += 2) {
      t[l] = _mm512_unpacklo_pd(r[l], r[l + 1]);
      t[l + 1] = _mm512_unpackhi_pd(r[l], r[l + 1]);
    }
    for (int h = 0; h < 2; ++h) {
      // Quarters of t: columns h, h + 2, h + 4, h + 6 of rows 0 and 1, 2 and 3, ...
      const V a = _mm512_shuffle_f64x2(t[h], t[2 + h], 0x88);
      const V b = _mm512_shuffle_f64x2(t[h], t[2 + h], 0xdd);
      const V c = _mm512_shuffle_f64x2(t[4 + h], t[6 + h], 0x88);
      const V d = _mm512_shuffle_f64x2(t[4 + h], t[6 + h], 0xdd);
      r[h] = _mm512_shuffle_f64x2(a, c, 0x88);
      r[2 + h] = _mm512_shuffle_f64x2(b, d, 0x88);
      r[4 + h] = _mm512_shuffle_f64x2(a, c, 0xdd);
      r[6 + h] = _mm512_shuffle_f64x2(b, d, 0xdd);
    }
  }
};

}  // namespace
}  // namespace lcpbench
