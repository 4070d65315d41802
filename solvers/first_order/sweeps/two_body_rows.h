#pragma once

#include <algorithm>
#include <array>
#include <type_traits>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/projected_step.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "support/array_index.h"

/// Internal to solvers/first_order/sweeps/: compiled for each instruction set, in an unnamed namespace as
/// linear_algebra/vector_register.h says.
namespace lcpbench {
namespace {

constexpr Index kFour = kLanes;
constexpr Index kEight = 2 * kFour;
constexpr std::size_t kCacheLine = 64;
// From so many bytes on rows and bodies come from beyond the second-level cache, and are asked for ahead of time:
// bodies as many rows ahead as the latency takes, rows twice as many, so that they are there when their bodies are
// asked for. 48 to 192 rows are alike, 24 are too few for eights; backward passes, which the hardware does not foresee,
// take half as long, in the given order a quarter. Below, asking costs a fifth and saves nothing.
constexpr Index kFromMemory = Index{1} << 22;
constexpr Index kAhead = 96;

using Offsets = std::array<int, 2>;

// Whether a step changes the image, and the one that its products are read from.
template <typename Step>
constexpr bool kMoves = Step::kKind == StepKind::kSweep || Step::kKind == StepKind::kGradient;
template <typename Step>
constexpr bool kStepsInPlace = Step::kKind == StepKind::kSweep;

// A row in registers, with its bodies in `in`.
template <Index p, bool kFused>
struct Loaded {
  using Block = BodyLanes<p>;
  Block first_block;  // b behind the body's numbers
  Block second_block;
  Block first_body;
  Block second_body;
  int first;
  int second;

  LCPBENCH_ALWAYS_INLINE Loaded(const double* s, const double* in) {
    const Offsets offsets = ScaledRows::Offsets<p>(s);
    first = offsets[0];
    second = offsets[1];
    first_block = Load<Block>(s);
    second_block = BodyPart<p>(Load<Block>(s + kBodyWidth<p>));
    first_body = Load<Block>(in + first);
    second_body = Load<Block>(in + second);
  }
  LCPBENCH_ALWAYS_INLINE Lanes Products() const {
    if constexpr (kFused) return Folded(Fused<Block>(second_block, second_body, first_block * first_body));
    return Folded(first_block * first_body + second_block * second_body);
  }
  // kInPlace: `out` is what the bodies were loaded from.
  template <bool kInPlace>
  LCPBENCH_ALWAYS_INLINE void Push(const Block& df, double* out) const {
    const Block to_first = kInPlace ? first_body : Load<Block>(out + first);
    const Block to_second = kInPlace ? second_body : Load<Block>(out + second);
    if constexpr (kFused) {
      Store(out + first, Fused<Block>(BodyPart<p>(first_block), df, to_first));
      Store(out + second, Fused<Block>(second_block, df, to_second));
    } else {
      Store(out + first, to_first + BodyPart<p>(first_block) * df);
      Store(out + second, to_second + second_block * df);
    }
  }
};

// One of four values in all lanes.
template <int lane, typename Block>
LCPBENCH_ALWAYS_INLINE Block Spread(const Lanes& value) {
  if constexpr (std::is_same_v<Block, Lanes>) {
    return __builtin_shufflevector(value, value, lane, lane, lane, lane);
  } else {
    return __builtin_shufflevector(value, value, lane, lane, lane, lane, lane, lane, lane, lane);
  }
}

#ifdef __AVX512F__
// Rows whole, in one register each: half the instructions of rows by halves. Only what the compiler's vector types
// cannot say is in intrinsics; the arithmetic is that of Loaded, lane by lane.
struct WideRow {
  __m512d body;  // both, first below second

  LCPBENCH_ALWAYS_INLINE WideRow(const double* s, const double* in) {
    const Offsets offsets = ScaledRows::Offsets<3>(s);
    const __m512d first = _mm512_castpd256_pd512(_mm256_load_pd(in + offsets[0]));
    body = _mm512_insertf64x4(first, _mm256_load_pd(in + offsets[1]), 1);
  }
  LCPBENCH_ALWAYS_INLINE __m512d Products(const double* s) const {
    return _mm512_maskz_mul_pd(kFactors, body, _mm512_load_pd(s));
  }
  template <bool kInPlace>
  LCPBENCH_ALWAYS_INLINE void Push(const double* s, __m512d df, double* out) const {
    const Offsets offsets = ScaledRows::Offsets<3>(s);
    const __m512d to = kInPlace ? body : WideRow(s, out).body;
    const __m512d sum = _mm512_add_pd(to, _mm512_maskz_mul_pd(kBlocks, df, _mm512_load_pd(s)));
    _mm256_store_pd(out + offsets[0], _mm512_castpd512_pd256(sum));
    _mm256_store_pd(out + offsets[1], _mm512_extractf64x4_pd(sum, 1));
  }

 private:
  static constexpr __mmask8 kFactors = 0b01111111;  // all but the offsets
  static constexpr __mmask8 kBlocks = 0b01110111;   // all but the offsets and b
};

// Sums of the lower and upper halves of a and b, lane by lane: four lanes of a, then of b.
LCPBENCH_ALWAYS_INLINE __m512d AddHalves(__m512d a, __m512d b) {
  return _mm512_add_pd(_mm512_shuffle_f64x2(a, b, 0b01'00'01'00), _mm512_shuffle_f64x2(a, b, 0b11'10'11'10));
}
// Sums of neighbouring lanes.
LCPBENCH_ALWAYS_INLINE __m512d AddNeighbours(__m512d a, __m512d b) {
  return _mm512_add_pd(_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
}
// Sums of neighbouring pairs of lanes.
LCPBENCH_ALWAYS_INLINE __m512d AddPairs(__m512d a, __m512d b) {
  return _mm512_add_pd(_mm512_shuffle_f64x2(a, b, 0b10'00'10'00), _mm512_shuffle_f64x2(a, b, 0b11'01'11'01));
}
#endif

// Passes over ScaledRows. Sets of consecutive rows that share no body are found when the rows are laid out, and stepped
// by eights, a register a row, with the eight dot products added up in one transposition; by fours, half a row a
// register, in space and where there is no AVX-512; what is left of a set by fours and one by one. All give the same
// bits. Measured cost: docs/solvers/first_order.md. Without sets all rows go one by one, with fused operations.
template <Index p, bool kInSets>
class TwoBodyRows final : public LaidOutRows<TwoBodyRows<p, kInSets>, !kInSets> {
 public:
  TwoBodyRows(const ScaledProblem& scaled, ScaledRows* rows)
      : LaidOutRows<TwoBodyRows<p, kInSets>, !kInSets>(scaled), rows_(*rows) {}

  void SetRows() override {
    if (kInSets) rows_.FindSets();
  }
  void SetB() override {
    for (Index k = 0; k < rows_.size(); ++k) rows_.row(k)[p] = this->scaled_.b[k];
  }
  bool OneByOne() const { return rows_.set_end().empty(); }
  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override { return 4 * p; }
  Index ImageSize() const override { return rows_.image_size(); }
  void StartImage(Array* image) const override {
    double* const to = image->data();
    for (Index i = 0; i < ImageSize(); ++i) to[i] = i % kBodyWidth<p> == p ? 1 : 0;
  }
  void AddToImage(Index begin, Index end, Point* x) const override {
    for (Index k = begin; k < end; ++k) {
      if (x->f[k] != 0) AddRowToImage(k, x->f[k], &x->image);
    }
  }
  void AddRowToImage(Index row, double df, Array* image) const override {
    Loaded<p, !kInSets>(rows_.row(row), image->data()).template Push<true>(Filled<BodyLanes<p>>(df), image->data());
  }
  double W(Index row, const Point& x) const override {
    return Sum(Loaded<p, !kInSets>(rows_.row(row), x.image.data()).Products());
  }
  template <typename Step>
  void Visit(Index begin, Index end, bool backward, const Point& from, Array* image, Step* step) const {
    double* const out = image == nullptr ? nullptr : image->data();
    if (backward) {
      VisitRows<true>(begin, end, from.image.data(), out, step);
    } else {
      VisitRows<false>(begin, end, from.image.data(), out, step);
    }
  }

 private:
  static constexpr Index kRow = 2 * kBodyWidth<p>;  // numbers of one

  template <typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitOne(const double* row, Index k, const double* in, double* out, Step* step) {
    const Loaded<p, !kInSets> loaded(row, in);
    const double value = step->Take(k, Sum(loaded.Products()));
    if constexpr (kMoves<Step>) loaded.template Push<kStepsInPlace<Step>>(Filled<BodyLanes<p>>(value), out);
  }

  template <HalfOfEight kHalf, typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitFour(const double* row, Index k, const double* in, double* out, Step* step) {
    const Loaded<p, !kInSets> r0(row, in);
    const Loaded<p, !kInSets> r1(row + kRow, in);
    const Loaded<p, !kInSets> r2(row + 2 * kRow, in);
    const Loaded<p, !kInSets> r3(row + 3 * kRow, in);
    const Lanes p0 = r0.Products();
    const Lanes p1 = r1.Products();
    const Lanes p2 = r2.Products();
    const Lanes p3 = r3.Products();
    // Lane by lane the same additions as Sum.
    const Lanes pairs01 = __builtin_shufflevector(p0, p1, 0, 4, 2, 6) + __builtin_shufflevector(p0, p1, 1, 5, 3, 7);
    const Lanes pairs23 = __builtin_shufflevector(p2, p3, 0, 4, 2, 6) + __builtin_shufflevector(p2, p3, 1, 5, 3, 7);
    const Lanes w =
        __builtin_shufflevector(pairs01, pairs23, 0, 1, 4, 5) + __builtin_shufflevector(pairs01, pairs23, 2, 3, 6, 7);
    const Lanes value = step->template Take<kHalf>(k, w);
    if constexpr (kMoves<Step>) {
      r0.template Push<kStepsInPlace<Step>>(Spread<0, BodyLanes<p>>(value), out);
      r1.template Push<kStepsInPlace<Step>>(Spread<1, BodyLanes<p>>(value), out);
      r2.template Push<kStepsInPlace<Step>>(Spread<2, BodyLanes<p>>(value), out);
      r3.template Push<kStepsInPlace<Step>>(Spread<3, BodyLanes<p>>(value), out);
    }
  }

  // For the rows that come kAhead rows after rows k to k + kRows - 1, or before them.
  template <bool kBackward, Index kRows>
  LCPBENCH_ALWAYS_INLINE void FetchAhead(Index k, const double* in) const {
    const Index bodies_of = kBackward ? k - kAhead : k + kAhead;
    const Index rows_at = kBackward ? bodies_of - kAhead : bodies_of + kAhead;
    if (kBackward ? rows_at < 0 : rows_at + kRows > rows_.size()) return;
    for (Index i = 0; i < kRows; ++i) {
      const Offsets offsets = ScaledRows::Offsets<p>(rows_.row(bodies_of + i));
      __builtin_prefetch(in + offsets[0], 1);
      __builtin_prefetch(in + offsets[1], 1);
      for (Index at = 0; at < kRow; at += 8) __builtin_prefetch(rows_.row(rows_at + i) + at);
    }
  }

  template <bool kBackward, typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitEight(const double* row, Index k, const double* in, double* out, Step* step) {
#ifdef __AVX512F__
    if constexpr (p == 3) {
      const auto s = [&](Index i) { return row + i * kRow; };
      const WideRow rows[kEight] = {WideRow(s(0), in), WideRow(s(1), in), WideRow(s(2), in), WideRow(s(3), in),
                                    WideRow(s(4), in), WideRow(s(5), in), WideRow(s(6), in), WideRow(s(7), in)};
      const auto halves = [&](Index i, Index j) { return AddHalves(rows[i].Products(s(i)), rows[j].Products(s(j))); };
      const __m512d w = AddPairs(AddNeighbours(halves(0, 2), halves(1, 3)), AddNeighbours(halves(4, 6), halves(5, 7)));
      alignas(kCacheLine) double value[kEight];
      Store(value, step->Take(k, WideLanes(w)));
      if constexpr (kMoves<Step>) {
        asm("" : "+m"(value));  // broadcasts from memory are free, from registers they take a quarter of the pass
        for (Index i = 0; i < kEight; ++i) {
          rows[i].template Push<kStepsInPlace<Step>>(s(i), _mm512_set1_pd(value[i]), out);
        }
      }
      return;
    }
#endif
    if constexpr (kBackward) VisitFour<HalfOfEight::kHigh>(row + kFour * kRow, k + kFour, in, out, step);
    VisitFour<HalfOfEight::kLow>(row, k, in, out, step);
    if constexpr (!kBackward) VisitFour<HalfOfEight::kHigh>(row + kFour * kRow, k + kFour, in, out, step);
  }

  template <bool kBackward, typename Step>
  void VisitRows(Index begin, Index end, const double* in, double* out, Step* step_of_all) const {
    // A copy, so that its sums stay in registers: nothing that `out` points to can be it.
    Step step = *step_of_all;
    const double* const rows = rows_.row(0);
    const bool from_memory = rows_.size() * kRow * Index{sizeof(double)} >= kFromMemory;
    const auto by_ones = [&](Index k) __attribute__((always_inline)) {
      if (kInSets && from_memory) FetchAhead<kBackward, 1>(k, in);
      VisitOne(rows + k * kRow, k, in, out, &step);
    };
    if constexpr (Step::kOneByOne) {
      for (Index k = begin; k < end; ++k) by_ones(kBackward ? begin + end - 1 - k : k);
    } else {
      VisitSets<kBackward>(begin, end, in, out, from_memory, by_ones, &step);
    }
    *step_of_all = step;
  }

  template <bool kBackward, typename ByOnes, typename Step>
  LCPBENCH_ALWAYS_INLINE void VisitSets(Index begin, Index end, const double* in, double* out, bool from_memory,
                                        const ByOnes& by_ones, Step* step) const {
    const double* const rows = rows_.row(0);
    const auto by_eights = [&](Index k) __attribute__((always_inline)) {
      if (from_memory) FetchAhead<kBackward, kEight>(k, in);
      VisitEight<kBackward>(rows + k * kRow, k, in, out, step);
    };
    const auto by_fours = [&](Index k) __attribute__((always_inline)) {
      if (from_memory) FetchAhead<kBackward, kFour>(k, in);
      VisitFour<HalfOfEight::kNone>(rows + k * kRow, k, in, out, step);
    };
    const Index* const set_end = rows_.set_end().data();
    const Index* const last_set = set_end + rows_.set_end().size();
    const auto start_of = [&](const Index* set) { return set == set_end ? 0 : set[-1]; };
    // Within a set the order does not matter to the result, but memory is best walked one way.
    if constexpr (kBackward) {
      const Index* set = std::lower_bound(set_end, last_set, end);
      for (Index to = end; to > begin; to = start_of(set--)) {
        const Index from = std::max(begin, start_of(set));
        const Index ones = from + (to - from) / kFour * kFour;
        const Index fours = from + (to - from) / kEight * kEight;
        for (Index k = to; k-- > ones;) by_ones(k);
        if (fours < ones) by_fours(fours);
        for (Index k = fours - kEight; k >= from; k -= kEight) by_eights(k);
      }
    } else {
      const Index* set = std::upper_bound(set_end, last_set, begin);
      for (Index k = begin; k < end; ++set) {
        const Index to = std::min(end, *set);
        for (; k + kEight <= to; k += kEight) by_eights(k);
        if (k + kFour <= to) {
          by_fours(k);
          k += kFour;
        }
        for (; k < to; ++k) by_ones(k);
      }
    }
  }

  ScaledRows& rows_;
};

}  // namespace

RowKernel* LCPBENCH_KERNEL(NewTwoBodyRows)(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows) {
  if (p == 3 && in_sets) return new TwoBodyRows<3, true>(scaled, rows);
  if (p == 3) return new TwoBodyRows<3, false>(scaled, rows);
  if (in_sets) return new TwoBodyRows<6, true>(scaled, rows);
  return new TwoBodyRows<6, false>(scaled, rows);
}

}  // namespace lcpbench
