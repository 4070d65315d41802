#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/projected_step.h"
#include "solvers/first_order/sweeps/row_kernel.h"

namespace lcpbench {
namespace {

// Rows on one body (the other is fixed) use a spare body as their second, with factors 0. There are several spares, so
// that neighbouring rows do not wait for each other's store.
constexpr Index kSpares = 8;
constexpr Index kEntriesPerRow = 12;
// Where fewer rows than this share of all go by fours, looking for sets costs more than they save.
constexpr double kLeastShareInFours = 0.5;
constexpr Index kFour = kLanes;
constexpr Index kEight = 2 * kFour;
constexpr std::size_t kCacheLine = 64;
// From so many rows on (4 MB) rows and bodies come from beyond the second-level cache, and are asked for ahead of time:
// bodies as many rows ahead as the latency takes, rows twice as many, so that they are there when their bodies are
// asked for. 48 to 192 rows are alike, 24 are too few for eights; backward passes, which the hardware does not foresee,
// take half as long, in the given order a quarter. Below, asking costs a fifth and saves nothing.
constexpr Index kRowsFromMemory = Index{1} << 16;
constexpr Index kAhead = 96;
constexpr LaneMask kFirstThree = {-1, -1, -1, 0};

using Offsets = std::array<int, 2>;

// Whether a step changes the image, and the one that its products are read from.
template <typename Step>
constexpr bool kMoves = Step::kKind != StepKind::kResidual;
template <typename Step>
constexpr bool kStepsInPlace = Step::kKind == StepKind::kSweep;

size_t At(Index i) { return static_cast<size_t>(i); }

LCPBENCH_ALWAYS_INLINE Offsets BodiesOf(const double* s) {
  Offsets offsets;
  static_assert(sizeof offsets == sizeof(double));
  std::memcpy(&offsets, s + 7, sizeof offsets);
  return offsets;
}

// A row in registers, with its bodies in `in`.
struct Loaded {
  Lanes first_block;  // b in the fourth lane
  Lanes second_block;
  Lanes first_body;
  Lanes second_body;
  int first;
  int second;

  LCPBENCH_ALWAYS_INLINE Loaded(const double* s, const double* in) {
    const Offsets offsets = BodiesOf(s);
    first = offsets[0];
    second = offsets[1];
    first_block = Load(s);
    second_block = Masked(Load(s + kLanes), kFirstThree);
    first_body = Load(in + first);
    second_body = Load(in + second);
  }
  LCPBENCH_ALWAYS_INLINE Lanes Products() const { return first_block * first_body + second_block * second_body; }
  // kInPlace: `out` is what the bodies were loaded from.
  template <bool kInPlace>
  LCPBENCH_ALWAYS_INLINE void Push(const Lanes& df, double* out) const {
    const Lanes to_first = kInPlace ? first_body : Load(out + first);
    const Lanes to_second = kInPlace ? second_body : Load(out + second);
    Store(out + first, to_first + Masked(first_block, kFirstThree) * df);
    Store(out + second, to_second + second_block * df);
  }
};

#ifdef __AVX512F__
// Rows whole, in one register each: half the instructions of rows by halves. Only what the compiler's vector types
// cannot say is in intrinsics; the arithmetic is that of Loaded, lane by lane.
struct WideRow {
  __m512d body;  // both, first below second

  LCPBENCH_ALWAYS_INLINE WideRow(const double* s, const double* in) {
    const Offsets offsets = BodiesOf(s);
    const __m512d first = _mm512_castpd256_pd512(_mm256_load_pd(in + offsets[0]));
    body = _mm512_insertf64x4(first, _mm256_load_pd(in + offsets[1]), 1);
  }
  LCPBENCH_ALWAYS_INLINE __m512d Products(const double* s) const {
    return _mm512_maskz_mul_pd(kFactors, body, _mm512_load_pd(s));
  }
  template <bool kInPlace>
  LCPBENCH_ALWAYS_INLINE void Push(const double* s, __m512d df, double* out) const {
    const Offsets offsets = BodiesOf(s);
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

// Matrix-free rows on at most two bodies each (LcpProblem::has_two_body_rows): S = D^-1/2 J M^-1/2 in blocks of three.
// Image: the velocities S^T f, four numbers per body.
//
// A row is one cache line with everything it needs but f: its two blocks, b, and where its bodies are. The fourth
// number of a body is the constant 1, the factor of b. One copy of S serves the product and the update, so that no
// inverse mass is read. Sets of consecutive rows that share no body are found when the rows are laid out, and stepped
// by eights, a register a row, with the eight dot products added up in one transposition; by fours, half a row a
// register, where there is no AVX-512; what is left of a set by fours and one by one. All give the same
// bits. Measured cost: docs/solvers/first_order.md.
class TwoBodyRows final : public LaidOutRows<TwoBodyRows> {
 public:
  TwoBodyRows(const LcpProblem& problem, const ScaledProblem& scaled) : LaidOutRows(scaled) {
    const SparseMatrix& J = problem.J();
    const Index bodies = J.cols() / 3;
    image_size_ = (bodies + kSpares) * kLanes;
    rows_.assign(At(scaled.size), {});
    for (Index k = 0; k < scaled.size; ++k) {
      double* s = rows_[At(k)].s.data();
      std::array<Index, 2> body = {-1, -1};
      for (SparseMatrix::InnerIterator it(J, scaled.Given(k)); it; ++it) {
        const double m = problem.inverse_mass()[it.col()];
        if (m == 0 || it.value() == 0) continue;
        const Index block = it.col() / 3;
        const size_t side = body[0] < 0 || body[0] == block ? 0 : 1;
        body[side] = block;
        s[kLanes * static_cast<Index>(side) + it.col() % 3] = it.value() * std::sqrt(m) * scaled.inverse_root[k];
      }
      if (body[0] < 0) body[0] = bodies + k % kSpares;
      if (body[1] < 0) body[1] = bodies + (k + kSpares / 2) % kSpares;
      const Offsets offsets = {static_cast<int>(body[0] * kLanes), static_cast<int>(body[1] * kLanes)};
      std::memcpy(s + 7, &offsets, sizeof offsets);
    }
    FindSets();
  }

  void SetB() override {
    for (Index k = 0; k < scaled_.size; ++k) rows_[At(k)].s[3] = scaled_.b[k];
  }
  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override { return kEntriesPerRow; }
  void StartImage(Array* image) const override {
    image->setZero(image_size_);
    for (Index i = 3; i < image_size_; i += kLanes) (*image)[i] = 1;
  }
  void AddToImage(Index begin, Index end, Point* x) const override {
    for (Index k = begin; k < end; ++k) {
      if (x->f[k] != 0) AddRowToImage(k, x->f[k], &x->image);
    }
  }
  void AddRowToImage(Index row, double df, Array* image) const override {
    Loaded(rows_[At(row)].s.data(), image->data()).Push<true>(Filled(df), image->data());
  }
  double W(Index row, const Point& x) const override {
    return Sum(Loaded(rows_[At(row)].s.data(), x.image.data()).Products());
  }
  template <typename Step>
  void Visit(Index begin, Index end, bool backward, const Point& from, Point* to, Step* step) const {
    double* const out = to == nullptr ? nullptr : to->image.data();
    if (backward) {
      VisitRows<true>(begin, end, from.image.data(), out, step);
    } else {
      VisitRows<false>(begin, end, from.image.data(), out, step);
    }
  }

 private:
  struct alignas(kCacheLine) Row {
    std::array<double, 8> s{};  // first block, b, second block, offsets of the bodies (two int)
  };

  void FindSets() {
    const Index spares_from = image_size_ - kSpares * kLanes;
    std::vector<Index> last_set(At(image_size_ / kLanes), -1);  // the last set with a row on the body
    Index set = 0;
    Index length = 0;
    Index in_fours = 0;
    set_end_.clear();
    const auto close = [&](Index end) {
      set_end_.push_back(end);
      in_fours += length - length % kFour;
      length = 0;
      ++set;
    };
    for (Index k = 0; k < scaled_.size; ++k) {
      const Offsets offsets = BodiesOf(rows_[At(k)].s.data());
      const auto taken = [&](int offset) { return offset < spares_from && last_set[At(offset / kLanes)] == set; };
      if (taken(offsets[0]) || taken(offsets[1])) close(k);
      for (const int offset : offsets) last_set[At(offset / kLanes)] = set;
      ++length;
    }
    close(scaled_.size);
    if (static_cast<double>(in_fours) < kLeastShareInFours * static_cast<double>(scaled_.size)) set_end_.clear();
  }

  template <typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitOne(const Row& row, Index k, const double* in, double* out, Step* step) {
    const Loaded loaded(row.s.data(), in);
    const double value = step->Take(k, Sum(loaded.Products()));
    if constexpr (kMoves<Step>) loaded.Push<kStepsInPlace<Step>>(Filled(value), out);
  }

  template <HalfOfEight kHalf, typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitFour(const Row* row, Index k, const double* in, double* out, Step* step) {
    const Loaded r0(row[0].s.data(), in);
    const Loaded r1(row[1].s.data(), in);
    const Loaded r2(row[2].s.data(), in);
    const Loaded r3(row[3].s.data(), in);
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
      r0.Push<kStepsInPlace<Step>>(__builtin_shufflevector(value, value, 0, 0, 0, 0), out);
      r1.Push<kStepsInPlace<Step>>(__builtin_shufflevector(value, value, 1, 1, 1, 1), out);
      r2.Push<kStepsInPlace<Step>>(__builtin_shufflevector(value, value, 2, 2, 2, 2), out);
      r3.Push<kStepsInPlace<Step>>(__builtin_shufflevector(value, value, 3, 3, 3, 3), out);
    }
  }

  // For the rows that come kAhead rows after rows k to k + kRows - 1, or before them.
  template <bool kBackward, Index kRows>
  LCPBENCH_ALWAYS_INLINE void FetchAhead(Index k, const double* in) const {
    const Index bodies_of = kBackward ? k - kAhead : k + kAhead;
    const Index rows_at = kBackward ? bodies_of - kAhead : bodies_of + kAhead;
    if (kBackward ? rows_at < 0 : rows_at + kRows > scaled_.size) return;
    const Row* rows = rows_.data();
    for (Index i = 0; i < kRows; ++i) {
      const Offsets offsets = BodiesOf(rows[bodies_of + i].s.data());
      __builtin_prefetch(in + offsets[0], 1);
      __builtin_prefetch(in + offsets[1], 1);
      __builtin_prefetch(rows + rows_at + i);
    }
  }

  template <bool kBackward, typename Step>
  LCPBENCH_ALWAYS_INLINE static void VisitEight(const Row* row, Index k, const double* in, double* out, Step* step) {
#ifdef __AVX512F__
    const auto s = [&](Index i) { return row[i].s.data(); };
    const std::array<WideRow, kEight> rows = {WideRow(s(0), in), WideRow(s(1), in), WideRow(s(2), in),
                                              WideRow(s(3), in), WideRow(s(4), in), WideRow(s(5), in),
                                              WideRow(s(6), in), WideRow(s(7), in)};
    const auto halves = [&](Index i, Index j) {
      return AddHalves(rows[At(i)].Products(s(i)), rows[At(j)].Products(s(j)));
    };
    const __m512d w = AddPairs(AddNeighbours(halves(0, 2), halves(1, 3)), AddNeighbours(halves(4, 6), halves(5, 7)));
    alignas(kCacheLine) std::array<double, kEight> value;
    Store(value.data(), step->Take(k, WideLanes(w)));
    if constexpr (kMoves<Step>) {
      asm("" : "+m"(value));  // broadcasts from memory are free, from registers they take a quarter of the pass
      for (Index i = 0; i < kEight; ++i) {
        rows[At(i)].template Push<kStepsInPlace<Step>>(s(i), _mm512_set1_pd(value[At(i)]), out);
      }
    }
#else
    if constexpr (kBackward) VisitFour<HalfOfEight::kHigh>(row + kFour, k + kFour, in, out, step);
    VisitFour<HalfOfEight::kLow>(row, k, in, out, step);
    if constexpr (!kBackward) VisitFour<HalfOfEight::kHigh>(row + kFour, k + kFour, in, out, step);
#endif
  }

  template <bool kBackward, typename Step>
  void VisitRows(Index begin, Index end, const double* in, double* out, Step* step_of_all) const {
    // A copy, so that its sums stay in registers: nothing that `out` points to can be it.
    Step step = *step_of_all;
    const Row* const rows = rows_.data();
    const bool from_memory = scaled_.size >= kRowsFromMemory;
    const auto by_eights = [&](Index k) __attribute__((always_inline)) {
      if (from_memory) FetchAhead<kBackward, kEight>(k, in);
      VisitEight<kBackward>(rows + k, k, in, out, &step);
    };
    const auto by_fours = [&](Index k) __attribute__((always_inline)) {
      if (from_memory) FetchAhead<kBackward, kFour>(k, in);
      VisitFour<HalfOfEight::kNone>(rows + k, k, in, out, &step);
    };
    const auto by_ones = [&](Index k) __attribute__((always_inline)) {
      if (from_memory) FetchAhead<kBackward, 1>(k, in);
      VisitOne(rows[k], k, in, out, &step);
    };
    if (set_end_.empty()) {
      if constexpr (kBackward) {
        for (Index k = end; k-- > begin;) by_ones(k);
      } else {
        for (Index k = begin; k < end; ++k) by_ones(k);
      }
      *step_of_all = step;
      return;
    }
    const auto start_of = [&](size_t set) { return set == 0 ? 0 : set_end_[set - 1]; };
    // Within a set the order does not matter to the result, but memory is best walked one way.
    if constexpr (kBackward) {
      auto set = At(std::lower_bound(set_end_.begin(), set_end_.end(), end) - set_end_.begin());
      for (Index to = end; to > begin; to = start_of(set--)) {
        const Index from = std::max(begin, start_of(set));
        const Index ones = from + (to - from) / kFour * kFour;
        const Index fours = from + (to - from) / kEight * kEight;
        for (Index k = to; k-- > ones;) by_ones(k);
        if (fours < ones) by_fours(fours);
        for (Index k = fours - kEight; k >= from; k -= kEight) by_eights(k);
      }
    } else {
      auto set = At(std::upper_bound(set_end_.begin(), set_end_.end(), begin) - set_end_.begin());
      for (Index k = begin; k < end; ++set) {
        const Index to = std::min(end, set_end_[set]);
        for (; k + kEight <= to; k += kEight) by_eights(k);
        if (k + kFour <= to) {
          by_fours(k);
          k += kFour;
        }
        for (; k < to; ++k) by_ones(k);
      }
    }
    *step_of_all = step;
  }

  std::vector<Row> rows_;
  std::vector<Index> set_end_;  // of each set of independent rows; empty where there is little to gain
  Index image_size_ = 0;
};

}  // namespace

std::unique_ptr<RowKernel> MakeTwoBodyRows(const LcpProblem& problem, const ScaledProblem& scaled) {
  return std::make_unique<TwoBodyRows>(problem, scaled);
}

}  // namespace lcpbench
