#include "solvers/sweeps/two_body_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "solvers/sweeps/lanes.h"
#include "solvers/sweeps/projected_step.h"

namespace lcpbench {
namespace {

// Rows on one body (the other is fixed) use a spare body as their second, with factors 0. There are several spares, so
// that neighbouring rows do not wait for each other's store.
constexpr Index kSpares = 8;
constexpr Index kEntriesPerRow = 12;
// Where fewer rows than this share of all go by fours, looking for sets costs more than they save.
constexpr double kLeastShareInFours = 0.5;
constexpr auto kFour = static_cast<Index>(kLanes);
// From so many rows on (16 MB) rows and bodies come from memory, and are asked for ahead of time: bodies as many rows
// ahead as memory's latency takes, rows twice as many, so that they are there when their bodies are asked for.
constexpr Index kRowsFromMemory = Index{1} << 18;
constexpr Index kAhead = 24;
constexpr LaneMask kFirstThree = {-1, -1, -1, 0};

using Offsets = std::array<int, 2>;

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

}  // namespace

TwoBodyRows::TwoBodyRows(const LcpProblem& problem, const ScaledProblem& scaled) : scaled_(scaled) {
  const SparseMatrix& J = problem.J();
  const Index bodies = J.cols() / 3;
  image_size_ = At(bodies + kSpares) * kLanes;
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
      s[kLanes * side + At(it.col() % 3)] = it.value() * std::sqrt(m) * scaled.inverse_root[At(k)];
    }
    s[3] = scaled.b[At(k)];
    if (body[0] < 0) body[0] = bodies + k % kSpares;
    if (body[1] < 0) body[1] = bodies + (k + kSpares / 2) % kSpares;
    const Offsets offsets = {static_cast<int>(body[0]) * static_cast<int>(kLanes),
                             static_cast<int>(body[1]) * static_cast<int>(kLanes)};
    std::memcpy(s + 7, &offsets, sizeof offsets);
  }
  FindSets();
}

void TwoBodyRows::FindSets() {
  const auto spares_from = static_cast<int>(image_size_ - At(kSpares) * kLanes);
  std::vector<Index> last_set(image_size_ / kLanes, -1);  // the last set with a row on the body
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
    const auto taken = [&](int offset) {
      return offset < spares_from && last_set[static_cast<size_t>(offset) / kLanes] == set;
    };
    if (taken(offsets[0]) || taken(offsets[1])) close(k);
    for (const int offset : offsets) last_set[static_cast<size_t>(offset) / kLanes] = set;
    ++length;
  }
  close(scaled_.size);
  if (static_cast<double>(in_fours) < kLeastShareInFours * static_cast<double>(scaled_.size)) set_end_.clear();
}

template <TwoBodyRows::Pass kPass, typename Step>
LCPBENCH_ALWAYS_INLINE void TwoBodyRows::VisitOne(const Row& row, Index k, const double* in, double* out, Step* step) {
  const Loaded loaded(row.s.data(), in);
  const double value = (*step)(k, Sum(loaded.Products()));
  if constexpr (kPass != Pass::kRead) loaded.Push<kPass == Pass::kInPlace>(Broadcast(value), out);
}

template <TwoBodyRows::Pass kPass, typename Step>
LCPBENCH_ALWAYS_INLINE void TwoBodyRows::VisitFour(const Row* row, Index k, const double* in, double* out, Step* step) {
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
  const Lanes value = (*step)(k, w);
  if constexpr (kPass != Pass::kRead) {
    r0.Push<kPass == Pass::kInPlace>(__builtin_shufflevector(value, value, 0, 0, 0, 0), out);
    r1.Push<kPass == Pass::kInPlace>(__builtin_shufflevector(value, value, 1, 1, 1, 1), out);
    r2.Push<kPass == Pass::kInPlace>(__builtin_shufflevector(value, value, 2, 2, 2, 2), out);
    r3.Push<kPass == Pass::kInPlace>(__builtin_shufflevector(value, value, 3, 3, 3, 3), out);
  }
}

// For the four rows that come kAhead rows after row k, or before it.
LCPBENCH_ALWAYS_INLINE void TwoBodyRows::FetchAhead(Index k, Index ahead, const double* in) const {
  const Index bodies_of = k + ahead;
  const Index rows_at = bodies_of + ahead;
  if (std::min(bodies_of, rows_at) < 0 || std::max(bodies_of, rows_at) + kFour > scaled_.size) return;
  const Row* rows = rows_.data();
  for (Index i = 0; i < kFour; ++i) {
    const Offsets offsets = BodiesOf(rows[bodies_of + i].s.data());
    __builtin_prefetch(in + offsets[0], 1);
    __builtin_prefetch(in + offsets[1], 1);
    __builtin_prefetch(rows + rows_at + i);
  }
}

template <TwoBodyRows::Pass kPass, typename Step>
void TwoBodyRows::Visit(Index begin, Index end, bool backward, const double* in, double* out, Step* step) const {
  const Row* rows = rows_.data();
  if (set_end_.empty()) {
    if (backward) {
      for (Index k = end; k-- > begin;) VisitOne<kPass>(rows[k], k, in, out, step);
    } else {
      for (Index k = begin; k < end; ++k) VisitOne<kPass>(rows[k], k, in, out, step);
    }
    return;
  }
  const bool from_memory = scaled_.size >= kRowsFromMemory;
  // Within a set the order does not matter to the result, but memory is best walked one way.
  const auto by_fours = [&](Index k) {
    if (from_memory) FetchAhead(k, backward ? -kAhead : kAhead, in);
    VisitFour<kPass>(rows + k, k, in, out, step);
  };
  const auto visit_set = [&](Index from, Index to) {
    const Index rest = from + (to - from) / kFour * kFour;
    if (backward) {
      for (Index k = to; k-- > rest;) VisitOne<kPass>(rows[k], k, in, out, step);
      for (Index k = rest - kFour; k >= from; k -= kFour) by_fours(k);
    } else {
      for (Index k = from; k < rest; k += kFour) by_fours(k);
      for (Index k = rest; k < to; ++k) VisitOne<kPass>(rows[k], k, in, out, step);
    }
  };
  const auto start_of = [&](size_t set) { return set == 0 ? 0 : set_end_[set - 1]; };
  if (backward) {
    auto set = At(std::lower_bound(set_end_.begin(), set_end_.end(), end) - set_end_.begin());
    for (Index to = end; to > begin; to = start_of(set--)) visit_set(std::max(begin, start_of(set)), to);
  } else {
    auto set = At(std::upper_bound(set_end_.begin(), set_end_.end(), begin) - set_end_.begin());
    for (Index from = begin; from < end; from = set_end_[set++]) visit_set(from, std::min(end, set_end_[set]));
  }
}

Index TwoBodyRows::EntriesPerRow() const { return kEntriesPerRow; }

void TwoBodyRows::StartImage(Array* image) const {
  image->assign(image_size_, 0.0);
  for (size_t i = 3; i < image_size_; i += kLanes) (*image)[i] = 1;
}

void TwoBodyRows::AddRowToImage(Index row, double df, Array* image) const {
  Loaded(rows_[At(row)].s.data(), image->data()).Push<true>(Broadcast(df), image->data());
}

void TwoBodyRows::AddToImage(Index begin, Index end, const Array& f, Array* image) const {
  for (Index k = begin; k < end; ++k) {
    if (f[At(k)] != 0) AddRowToImage(k, f[At(k)], image);
  }
}

double TwoBodyRows::W(Index row, const Array& /*f*/, const Array& image) const {
  return Sum(Loaded(rows_[At(row)].s.data(), image.data()).Products());
}

void TwoBodyRows::Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
                        StepSums* sums) const {
  RunStep<false>(scaled_, omega, *f, f, sums,
                 [&](auto* step) { Visit<Pass::kInPlace>(begin, end, backward, image->data(), image->data(), step); });
}

void TwoBodyRows::GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                               Array* next_image, StepSums* sums) const {
  RunStep<true>(scaled_, step, y, next, sums, [&](auto* projected) {
    Visit<Pass::kAcross>(begin, end, false, y_image.data(), next_image->data(), projected);
  });
}

double TwoBodyRows::ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const {
  return RunResidual(scaled_, f,
                     [&](auto* residual) { Visit<Pass::kRead>(begin, end, false, image.data(), nullptr, residual); });
}

}  // namespace lcpbench
