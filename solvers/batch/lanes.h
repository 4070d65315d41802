#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

/// Internal to solvers/batch/.
namespace lcpbench {
namespace {

/// The two bodies of a row.
struct IndexPair {
  std::int32_t index[2];
};

/// As many doubles at once as the instruction set has lanes that this header is compiled for: 8 with AVX-512 (F, DQ and
/// VL), 4 with AVX2 and FMA, 2 with SSE2, which every x86-64 has. In an unnamed namespace like all that kernels are
/// made of: what is compiled for one instruction set must never be linked in place of another's.
struct Lanes {
#if defined(__AVX512F__)
  static constexpr int kWidth = 8;
#elif defined(__AVX2__)
  static constexpr int kWidth = 4;
#else
  static constexpr int kWidth = 2;
#endif
  using V [[gnu::vector_size(8 * kWidth)]] = double;
  using M [[gnu::vector_size(8 * kWidth)]] = long long;  ///< all bits of a lane or none

  static V Load(const double* from) { return *reinterpret_cast<const V*>(from); }
  static void Store(double* to, V v) { *reinterpret_cast<V*>(to) = v; }
  static V Set(double x) { return x - V{}; }
  /// a b + c; SSE2 rounds products and sums separately.
  static V Fma(V a, V b, V c) {
#if defined(__AVX512F__)
    return _mm512_fmadd_pd(a, b, c);
#elif defined(__AVX2__)
    return _mm256_fmadd_pd(a, b, c);
#else
    return a * b + c;
#endif
  }
  /// c - a b
  static V Fnma(V a, V b, V c) {
#if defined(__AVX512F__)
    return _mm512_fnmadd_pd(a, b, c);
#elif defined(__AVX2__)
    return _mm256_fnmadd_pd(a, b, c);
#else
    return c - a * b;
#endif
  }
  static V Max(V a, V b) { return a > b ? a : b; }
  static V Min(V a, V b) { return a < b ? a : b; }
  static V Abs(V a) { return Masked(M{} + std::numeric_limits<long long>::max(), a); }
  static V Xor(V a, V b) { return reinterpret_cast<V>(reinterpret_cast<M>(a) ^ reinterpret_cast<M>(b)); }
  /// Lanes whose sign bit is set.
  static M SignOf(V a) {
#if defined(__AVX2__)
    return reinterpret_cast<M>(a) < 0;
#else
    return reinterpret_cast<M>(_mm_shuffle_epi32(_mm_srai_epi32(reinterpret_cast<__m128i>(a), 31), 0xf5));
#endif
  }
  /// a where m, else b.
  static V Select(M m, V a, V b) {
#if defined(__AVX512F__)
    return _mm512_mask_blend_pd(static_cast<__mmask8>(Bits(m)), b, a);
#elif defined(__AVX2__)
    return _mm256_blendv_pd(b, a, reinterpret_cast<V>(m));
#else
    return reinterpret_cast<V>((m & reinterpret_cast<M>(a)) | (~m & reinterpret_cast<M>(b)));
#endif
  }
  static V Masked(M m, V a) { return reinterpret_cast<V>(m & reinterpret_cast<M>(a)); }
  static bool Any(M m) { return Bits(m) != 0; }
  static unsigned Bits(M m) {
#if defined(__AVX512F__)
    return _mm512_movepi64_mask(reinterpret_cast<__m512i>(m));
#elif defined(__AVX2__)
    return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<V>(m)));
#else
    return static_cast<unsigned>(_mm_movemask_pd(reinterpret_cast<V>(m)));
#endif
  }
  /// Which lanes have the same integers, to select by.
#if defined(__AVX512F__)
  using Choice = __mmask8;
  static Choice Equal(M a, M b) {
    return _mm512_cmpeq_epi64_mask(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b));
  }
  /// a where `first`, else b where `second`, else 0.
  static V Choose(Choice first, V a, Choice second, V b) {
    return _mm512_mask_mov_pd(_mm512_maskz_mov_pd(second, b), first, a);
  }
#else
  using Choice = M;
  static Choice Equal(M a, M b) { return a == b; }
  static V Choose(Choice first, V a, Choice second, V b) { return Select(first, a, Masked(second, b)); }
#endif
  static M FromBits(unsigned bits) { return FromBits(bits, std::make_integer_sequence<int, kWidth>{}); }

  /// to[j] has from[l][offset + j] in lane l, j < count <= kWidth; nothing beyond is read.
  template <typename Real>
  static void LoadTransposed(const Real* const* from, std::size_t offset, int count, V* to) {
    for (int l = 0; l < kWidth; ++l) to[l] = LoadFirst(from[l] + offset, count);
    Transpose<1>(to);
  }
  /// The opposite. Changes `rows`.
  static void StoreTransposed(V* rows, double* const* to, std::size_t offset, int count) {
    Transpose<1>(rows);
    for (int l = 0; l < kWidth; ++l) StoreFirst(to[l] + offset, count, rows[l]);
  }

 private:
  template <int... l>
  static M FromBits(unsigned bits, std::integer_sequence<int, l...> /*lanes*/) {
    return M{-static_cast<long long>(bits >> l & 1U)...};
  }
  static unsigned FirstBits(int count) { return (1U << static_cast<unsigned>(count)) - 1U; }
  static V LoadFirst(const double* from, int count) {
#if defined(__AVX512F__)
    return _mm512_maskz_loadu_pd(static_cast<__mmask8>(FirstBits(count)), from);
#elif defined(__AVX2__)
    if (count >= kWidth) return _mm256_loadu_pd(from);
    return _mm256_maskload_pd(from, reinterpret_cast<__m256i>(FromBits(FirstBits(count))));
#else
    return count > 1 ? _mm_loadu_pd(from) : _mm_load_sd(from);
#endif
  }
  static V LoadFirst(const float* from, int count) {
#if defined(__AVX512F__)
    return _mm512_cvtps_pd(_mm256_maskz_loadu_ps(static_cast<__mmask8>(FirstBits(count)), from));
#elif defined(__AVX2__)
    if (count >= kWidth) return _mm256_cvtps_pd(_mm_loadu_ps(from));
    const __m128i first = _mm_cmpgt_epi32(_mm_set1_epi32(count), _mm_setr_epi32(0, 1, 2, 3));
    return _mm256_cvtps_pd(_mm_maskload_ps(from, first));
#else
    return V{from[0], count > 1 ? from[1] : 0.0};
#endif
  }
  /// Two indices become one lane's 64 bits.
  static V LoadFirst(const IndexPair* from, int count) {
#if defined(__AVX512F__)
    return reinterpret_cast<V>(_mm512_maskz_loadu_epi64(static_cast<__mmask8>(FirstBits(count)), from));
#elif defined(__AVX2__)
    const M first = FromBits(FirstBits(count < kWidth ? count : kWidth));
    return reinterpret_cast<V>(
        _mm256_maskload_epi64(reinterpret_cast<const long long*>(from), reinterpret_cast<__m256i>(first)));
#else
    const auto* pair = reinterpret_cast<const __m128i*>(from);
    return reinterpret_cast<V>(count > 1 ? _mm_loadu_si128(pair) : _mm_loadl_epi64(pair));
#endif
  }
  static void StoreFirst(double* to, int count, V v) {
#if defined(__AVX512F__)
    _mm512_mask_storeu_pd(to, static_cast<__mmask8>(FirstBits(count)), v);
#elif defined(__AVX2__)
    if (count >= kWidth) return _mm256_storeu_pd(to, v);
    _mm256_maskstore_pd(to, reinterpret_cast<__m256i>(FromBits(FirstBits(count))), v);
#else
    return count > 1 ? _mm_storeu_pd(to, v) : _mm_store_sd(to, v);
#endif
  }

  // Exchanges the blocks of `step` columns beside the diagonal of blocks of 2 `step`, and so on up to the whole.
  template <int step>
  static void Transpose(V* r) {
    if constexpr (step < kWidth) {
      for (int l = 0; l < kWidth; ++l) {
        if ((l & step) == 0) ExchangeBlocks<step>(&r[l], &r[l + step], std::make_integer_sequence<int, kWidth>{});
      }
      Transpose<2 * step>(r);
    }
  }
  template <int step, int... l>
  static void ExchangeBlocks(V* upper, V* lower, std::integer_sequence<int, l...> /*lanes*/) {
    const V a = *upper;
    const V b = *lower;
    *upper = __builtin_shufflevector(a, b, ((l & step) == 0 ? l : kWidth + l - step)...);
    *lower = __builtin_shufflevector(a, b, ((l & step) == 0 ? l + step : kWidth + l)...);
  }
};

}  // namespace
}  // namespace lcpbench
