#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

/// Internal to solvers/: vector registers of the instruction set that a file is compiled for.
namespace lcpbench {
namespace {

/// The two bodies of a row.
struct IndexPair {
  std::int32_t index[2];
};

/// As many doubles at once as the instruction set has lanes that this header is compiled for: 8 with AVX-512 (F, DQ and
/// VL), 4 with AVX2 and FMA, 2 with SSE2, which every x86-64 has. In an unnamed namespace like all that kernels are
/// made of: what is compiled for one instruction set must never be linked in place of another's. For the same reason
/// kernels call no inline functions of the standard library and of Eigen.
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
  static V Sqrt(V a) {
#if defined(__AVX512F__)
    return _mm512_sqrt_pd(a);
#elif defined(__AVX2__)
    return _mm256_sqrt_pd(a);
#else
    return _mm_sqrt_pd(a);
#endif
  }
  static double Sum(V a) {
#if defined(__AVX512F__)
    return _mm512_reduce_add_pd(a);
#elif defined(__AVX2__)
    const __m128d half = _mm256_castpd256_pd128(a) + _mm256_extractf128_pd(a, 1);
    return half[0] + half[1];
#else
    return a[0] + a[1];
#endif
  }
  static double Least(V a) {
#if defined(__AVX512F__)
    return _mm512_reduce_min_pd(a);
#elif defined(__AVX2__)
    const __m128d half = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return half[0] < half[1] ? half[0] : half[1];
#else
    return a[0] < a[1] ? a[0] : a[1];
#endif
  }
  /// from[0], from[step], from[2 step], ...
  static V Gather(const double* from, std::ptrdiff_t step) {
    return Gather(from, step, std::make_integer_sequence<int, kWidth>{});
  }
  /// Where the lanes of from[at] are, in doubles; and the numbers there.
  static M LanePlaces(M at) {
#if defined(__AVX512F__)
    return (at << 3) + M{0, 1, 2, 3, 4, 5, 6, 7};
#elif defined(__AVX2__)
    return (at << 2) + M{0, 1, 2, 3};
#else
    return (at << 1) + M{0, 1};
#endif
  }
  static V GatherLanes(const V* from, M places) {
    const auto* const numbers = reinterpret_cast<const double*>(from);
#if defined(__AVX512F__)
    return _mm512_i64gather_pd(reinterpret_cast<__m512i>(places), numbers, 8);
#elif defined(__AVX2__)
    return _mm256_i64gather_pd(numbers, reinterpret_cast<__m256i>(places), 8);
#else
    return V{numbers[places[0]], numbers[places[1]]};
#endif
  }
  /// The numbers are from 0 to 2^31.
  static M Larger(M a, M b) {
#if defined(__AVX512F__)
    return a > b ? a : b;
#elif defined(__AVX2__)
    return reinterpret_cast<M>(_mm256_max_epi32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#else
    return M{a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
#endif
  }
  /// 0, 1, 2, ...
  static V Indices() { return Indices(std::make_integer_sequence<int, kWidth>{}); }
  static V Xor(V a, V b) { return reinterpret_cast<V>(reinterpret_cast<M>(a) ^ reinterpret_cast<M>(b)); }
  /// Lanes whose sign bit is set.
  static M SignOf(V a) {
#if defined(__AVX2__)
    return reinterpret_cast<M>(a) < 0;
#else
    return reinterpret_cast<M>(_mm_shuffle_epi32(_mm_srai_epi32(reinterpret_cast<__m128i>(a), 31), 0xf5));
#endif
  }
  static M FromSigns(M a) { return SignOf(reinterpret_cast<V>(a)); }
  /// a where m, else b.
  static V Select(M m, V a, V b) {
#if defined(__AVX512F__)
    return Select(static_cast<__mmask8>(Bits(m)), a, b);
#elif defined(__AVX2__)
    return _mm256_blendv_pd(b, a, reinterpret_cast<V>(m));
#else
    return _mm_or_pd(_mm_and_pd(reinterpret_cast<V>(m), a), _mm_andnot_pd(reinterpret_cast<V>(m), b));
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
  /// Which lanes have the same numbers, to select by.
#if defined(__AVX512F__)
  using Choice = __mmask8;
  static Choice Equal(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ); }
  static Choice Less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
  static Choice Either(Choice a, Choice b) { return _kor_mask8(a, b); }
  static V Select(Choice choice, V a, V b) { return _mm512_mask_blend_pd(choice, b, a); }
  /// 0 where `choice`, else a.
  static V Without(Choice choice, V a) { return _mm512_maskz_mov_pd(static_cast<__mmask8>(~choice), a); }
  static Choice Equal(M a, M b) {
    return _mm512_cmpeq_epi64_mask(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b));
  }
  /// a where `first`, else b where `second`, else 0.
  static V Choose(Choice first, V a, Choice second, V b) {
    return _mm512_mask_mov_pd(_mm512_maskz_mov_pd(second, b), first, a);
  }
#else
  using Choice = M;
  // By intrinsics: GCC 12 takes such masks apart in two lanes, if it sees where they come from.
#if defined(__AVX2__)
  static Choice Equal(V a, V b) { return reinterpret_cast<M>(_mm256_cmp_pd(a, b, _CMP_EQ_OQ)); }
  static Choice Less(V a, V b) { return reinterpret_cast<M>(_mm256_cmp_pd(a, b, _CMP_LT_OQ)); }
  static V Without(Choice choice, V a) { return _mm256_andnot_pd(reinterpret_cast<V>(choice), a); }
#else
  static Choice Equal(V a, V b) { return reinterpret_cast<M>(_mm_cmpeq_pd(a, b)); }
  static Choice Less(V a, V b) { return reinterpret_cast<M>(_mm_cmplt_pd(a, b)); }
  static V Without(Choice choice, V a) { return _mm_andnot_pd(reinterpret_cast<V>(choice), a); }
#endif
  static Choice Either(Choice a, Choice b) { return a | b; }
  static Choice Equal(M a, M b) { return a == b; }
  static V Choose(Choice first, V a, Choice second, V b) { return Select(first, a, Masked(second, b)); }
#endif
  /// Powers of two: s such that s^2 d is in [1, 4), for d > 0; and t such that t x is in [1, 2) for x > 0, 1 for 0. The
  /// reciprocal of the largest exponents is no normal number; such x overflow elsewhere.
  static V ScaleOfDiagonal(V d) { return PowerOfTwo(1535U - ((ExponentOf(d) + 1U) >> 1U)); }
  static V ScaleOfLargest(V x) {
    return Select(Set(0) < x, PowerOfTwo(2046U - ExponentOf(Min(x, Set(0x1p1022)))), Set(1));
  }
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
  // Biased exponents of numbers > 0, and powers of two by them.
  using Exponents [[gnu::vector_size(8 * kWidth)]] = unsigned long long;
  static Exponents ExponentOf(V a) { return reinterpret_cast<Exponents>(a) >> 52U; }
  static V PowerOfTwo(Exponents biased) { return reinterpret_cast<V>(biased << 52U); }

  template <int... l>
  static V Indices(std::integer_sequence<int, l...> /*lanes*/) {
    return V{l...};
  }
  template <int... l>
  static V Gather(const double* from, std::ptrdiff_t step, std::integer_sequence<int, l...> /*lanes*/) {
    return V{from[l * step]...};
  }
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

/// Rows of a triangle are laid out in whole registers of so many doubles, the most that any instruction set has.
inline constexpr std::ptrdiff_t kRegister = 8;

}  // namespace
}  // namespace lcpbench
