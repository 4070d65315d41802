#include "solvers/batch/row_batch.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "solvers/batch/extended_check.h"
#include "solvers/batch/kernel.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "support/cancellation.h"

namespace lcpbench {
namespace {

constexpr std::size_t kBlock = RowBatch::kBlock;
constexpr std::size_t kMostLanes = kBatchMaxLanes;
constexpr std::size_t kRoom = kBlock + (2 * kMostLanes);
constexpr std::size_t kSizes = kBatchMaxRows + 1;
constexpr std::size_t kMostNumbers = std::size_t{2} * 6 * kBatchMaxRows;  // of J
// What the first try leaves is tried once more with this part of A_ii added (BatchGroup::shift).
constexpr double kShift = 1e-8;
static_assert(RowBatch::kMaxRows == kBatchMaxRows);
constexpr KernelTable<BatchKernels> kKernels{{2, &SolveGroupSse2}, {4, &SolveGroupAvx2}, {8, &SolveGroupAvx512}};

// Bit i: byte i of `count` <= 8 is not 0. If `is_whole`, all 8 can be read.
std::uint32_t BitsOfBytes(const unsigned char* bytes, int count, bool is_whole) {
  std::uint64_t word = 0;
  if (is_whole) {
    std::memcpy(&word, bytes, 8);
    word &= ~std::uint64_t{0} >> (64 - 8 * count);
  } else {
    std::memcpy(&word, bytes, static_cast<std::size_t>(count));
  }
  if (word == 0) return 0;
  word |= word >> 4U;
  word |= word >> 2U;
  word |= word >> 1U;
  word &= 0x0101010101010101;
  return static_cast<std::uint32_t>((word * 0x0102040810204080) >> 56U);
}

// @param left  numbers that `bilateral` has, >= n
std::uint64_t JointsOf(const unsigned char* bilateral, int n, std::int64_t left) {
  std::uint64_t joints = 0;
  for (int i = 0; i < n; i += 8) {
    joints |= std::uint64_t{BitsOfBytes(bilateral + i, std::min(n - i, 8), i + 8 <= left)} << i;
  }
  return joints;
}

}  // namespace

struct RowBatch::Implementation {
  explicit Implementation(InstructionSet instructions) : kernels(FindKernel(kKernels, instructions)) {
    group.workspace = workspace.data();
  }

  // A lane's rows, filled up by rows of zeros.
  struct Padded {
    std::array<std::int32_t, 2 * kSizes> body;
    std::array<double, kMostNumbers> J;
    std::array<float, kMostNumbers> J_single;
    std::array<double, kBatchMaxRows> b, f;
  };

  // Problems that wait for neighbours of their size. A block and less than a group that the blocks before left have
  // room.
  struct Queue {
    std::array<std::array<std::int32_t, kRoom>, kSizes> problems;
    std::array<std::size_t, kSizes> count{};

    void Add(std::int32_t problem, std::int32_t n) {
      const auto size = static_cast<std::size_t>(n);
      problems[size][count[size]++] = problem;
    }
  };

  void Start(const StepRows& of, std::span<const std::int32_t> starts, double tolerance, double* forces, Receiver* to) {
    rows = &of;
    start = starts;
    f = forces;
    receiver = to;
    group.rho_limit = std::min(tableau::kMostRho, tolerance / 2);
    group.rounding_limit = tolerance / 2;
    group.close_rho_limit = tolerance;
    group.row_limit = tableau::kMargin * std::sqrt(tolerance);
    group.columns_per_body = of.columns_per_body;
    group.bodies = of.bodies;
    group.inverse_mass = of.inverse_mass;
    std::fill(std::begin(group.J), std::end(group.J), nullptr);
    std::fill(std::begin(group.J_single), std::end(group.J_single), nullptr);
    group.next_rows = 0;
    first_try.count.fill(0);
    second_try.count.fill(0);
  }

  std::int32_t SizeOf(std::int32_t problem) const {
    return start[static_cast<std::size_t>(problem) + 1] - start[static_cast<std::size_t>(problem)];
  }

  // Reads a block in order, a byte from every cache line: in this order memory brings lines before they are asked for.
  // The sum is there so that the loads are.
  unsigned Touch(std::size_t first, std::size_t last) const {
    const std::int64_t begin = start[first];
    const std::int64_t end = start[last];
    const std::int64_t p = rows->columns_per_body;
    const unsigned of_J = rows->J != nullptr ? TouchLines(rows->J + 2 * p * begin, rows->J + 2 * p * end)
                                             : TouchLines(rows->J_single + 2 * p * begin, rows->J_single + 2 * p * end);
    const unsigned of_loads = TouchLines(rows->b + begin, rows->b + end) + TouchLines(f + begin, f + end);
    // Bodies of an island mostly lie side by side, and what is out of range is refused later: to fetch it does no harm.
    for (std::int64_t k = 2 * begin; k < 2 * end; k += 2) {
      FetchMass(rows->inverse_mass, rows->body[k] * p);
    }
    return of_J + of_loads;
  }
  template <typename Number>
  static unsigned TouchLines(const Number* begin, const Number* end) {
    constexpr std::ptrdiff_t kLine = 64;
    const auto* byte = reinterpret_cast<const unsigned char*>(begin);
    const auto* const last = reinterpret_cast<const unsigned char*>(end);
    unsigned sum = 0;
    for (; byte < last; byte += kLine) sum += *byte;
    return sum;
  }

  void Sort(std::size_t first, std::size_t last) {
    touched = Touch(first, last);
    for (std::size_t k = first; k < last; ++k) {
      const std::int32_t n = start[k + 1] - start[k];
      const auto problem = static_cast<std::int32_t>(k);
      if (n > MostRowsIn(kernels.lanes) || n == 0) {
        receiver->Leave(problem);
      } else {
        first_try.Add(problem, n);
      }
    }
  }

  // Whole groups of each size. While one is solved, memory brings the next.
  void SolveFull(Queue* queue) {
    const std::size_t lanes = kernels.lanes;
    std::size_t count = 0;
    for (std::size_t size = 1; size < kSizes; ++size) {
      const std::array<std::int32_t, kRoom>& problems = queue->problems[size];
      for (std::size_t from = 0; from + lanes <= queue->count[size]; from += lanes) full[count++] = &problems[from];
    }
    if (count == 0) return;
    for (std::size_t k = 0; k < count; ++k) {
      PrepareNext(full[std::min(k + 1, count - 1)], full[std::min(k + 2, count - 1)]);
      SolveEqual(queue, {full[k], lanes});
    }
    group.next_rows = 0;
    for (std::size_t size = 1; size < kSizes; ++size) {
      std::array<std::int32_t, kRoom>& problems = queue->problems[size];
      const std::size_t left = queue->count[size] % lanes;
      std::copy_n(&problems[queue->count[size] - left], left, problems.data());
      queue->count[size] = left;
    }
  }

  void PrepareNext(const std::int32_t* problems, const std::int32_t* later) {
    const std::int64_t p = rows->columns_per_body;
    group.next_rows = std::min(SizeOf(problems[0]), SizeOf(later[0]));
    for (std::size_t l = 0; l < kernels.lanes; ++l) {
      const std::int64_t first = start[static_cast<std::size_t>(problems[l])];
      BatchGroup::Next& next = group.next[l];
      next.body = rows->body + 2 * first;
      next.J = rows->J != nullptr ? reinterpret_cast<const char*>(rows->J + 2 * p * first)
                                  : reinterpret_cast<const char*>(rows->J_single + 2 * p * first);
      next.b = rows->b + first;
      next.f = f + first;
      next.later_body = rows->body + 2 * std::int64_t{start[static_cast<std::size_t>(later[l])]};
    }
  }

  void SolveRest(Queue* queue) {
    std::array<std::int32_t, kBatchMaxLanes> problems{};
    std::size_t used = 0;
    const auto in_turn = static_cast<std::size_t>(RowsInTurn(kernels.lanes));
    for (std::size_t size = kSizes - 1; size > 0; --size) {
      // From here on by another order of pivots.
      if (size == in_turn && used > 0) {
        SolveMixed(queue, {problems.data(), used});
        used = 0;
      }
      for (std::size_t k = 0; k < queue->count[size]; ++k) {
        problems[used++] = queue->problems[size][k];
        if (used < kernels.lanes) continue;
        SolveMixed(queue, {problems.data(), used});
        used = 0;
      }
    }
    if (used > 0) SolveMixed(queue, {problems.data(), used});
  }

  void PointTo(std::size_t lane, std::int32_t problem) {
    const std::int64_t first = start[static_cast<std::size_t>(problem)];
    const std::int64_t width = std::int64_t{2} * rows->columns_per_body;
    const std::int32_t n = SizeOf(problem);
    group.body[lane] = rows->body + 2 * first;
    if (rows->J != nullptr) {
      group.J[lane] = rows->J + width * first;
    } else {
      group.J_single[lane] = rows->J_single + width * first;
    }
    BatchItem& item = group.items[lane];
    item.b = rows->b + first;
    item.f = f + first;
    item.n = n;
    item.joints = rows->bilateral == nullptr ? 0 : JointsOf(rows->bilateral + first, n, rows->rows - first);
  }

  void SolveEqual(Queue* queue, std::span<const std::int32_t> problems) {
    for (std::size_t l = 0; l < problems.size(); ++l) PointTo(l, problems[l]);
    SolveAll(queue, problems, SizeOf(problems[0]));
  }

  void SolveMixed(Queue* queue, std::span<const std::int32_t> problems) {
    const std::int32_t n = SizeOf(problems[0]);  // the largest
    const std::size_t width = 2 * static_cast<std::size_t>(rows->columns_per_body);
    for (std::size_t l = 0; l < kernels.lanes; ++l) {
      const std::size_t of = l < problems.size() ? l : 0;
      PointTo(l, problems[of]);
      BatchItem& item = group.items[l];
      if (item.n == n) continue;
      const auto own = static_cast<std::size_t>(item.n);
      const auto all = static_cast<std::size_t>(n);
      Padded& copy = padded[l];
      std::fill(std::copy_n(group.body[l], 2 * own, copy.body.begin()), copy.body.begin() + std::ptrdiff_t{2} * n, -1);
      std::fill(std::copy_n(item.b, own, copy.b.begin()), copy.b.begin() + n, 0.0);
      group.body[l] = copy.body.data();
      item.b = copy.b.data();
      item.f = copy.f.data();
      if (rows->J != nullptr) {
        std::fill_n(std::copy_n(group.J[l], width * own, copy.J.begin()), width * (all - own), 0.0);
        group.J[l] = copy.J.data();
      } else {
        std::fill_n(std::copy_n(group.J_single[l], width * own, copy.J_single.begin()), width * (all - own), 0.0F);
        group.J_single[l] = copy.J_single.data();
      }
    }
    SolveAll(queue, problems, n);
  }

  void SolveAll(Queue* queue, std::span<const std::int32_t> problems, std::int32_t n) {
    group.rows = n;
    group.shift = queue == &first_try ? 0 : kShift;
#if defined(__AVX__)
    // SSE2's instructions take twice the time while upper halves of registers are in use; GCC 12 forgets some.
    if (kernels.lanes == 2) _mm256_zeroupper();
#endif
    kernels.solve(&group);
    for (std::size_t l = 0; l < problems.size(); ++l) {
      const BatchItem& item = group.items[l];
      double* const to = f + start[static_cast<std::size_t>(problems[l])];
      if (item.f != to) std::copy_n(item.f, item.n, to);
    }
    for (std::size_t l = 0; l < problems.size(); ++l) {
      const bool met = (group.met >> l & 1U) != 0;
      const bool close = (group.close >> l & 1U) != 0;
      if (met || (close && IsRight(problems[l], &group.rho[l]))) {
        receiver->Take(problems[l], group.pivots[l], group.rho[l]);
      } else if (queue == &first_try) {
        second_try.Add(problems[l], SizeOf(problems[l]));
      } else {
        receiver->Leave(problems[l]);
      }
    }
  }

  // Where rounding may hide more than the tolerance, or a row's backward error.
  bool IsRight(std::int32_t problem, double* rho) const {
    const std::int64_t first = start[static_cast<std::size_t>(problem)];
    const StepRows part = PartOf(*rows, first, start[static_cast<std::size_t>(problem) + 1]);
    return PassesExtended(part, group.close_rho_limit, group.row_limit, f + first, rho);
  }

  const BatchKernels& kernels;
  const StepRows* rows = nullptr;
  std::span<const std::int32_t> start;
  double* f = nullptr;
  Receiver* receiver = nullptr;
  BatchGroup group;
  alignas(64) std::array<std::byte, kBatchWorkspace> workspace;
  std::array<Padded, kBatchMaxLanes> padded;
  volatile unsigned touched = 0;
  Queue first_try, second_try;
  std::array<const std::int32_t*, (kBlock / 2) + (kSizes * kMostLanes)> full;  // groups of whole lanes
};

RowBatch::RowBatch(InstructionSet instructions) : implementation_(std::make_unique<Implementation>(instructions)) {}
RowBatch::~RowBatch() = default;

void RowBatch::Solve(const StepRows& rows, std::span<const std::int32_t> start, double tolerance,
                     std::atomic<std::size_t>* next, double* f, Receiver* receiver) {
  Implementation& own = *implementation_;
  own.Start(rows, start, tolerance, f, receiver);
  const std::size_t count = start.size() - 1;
  for (std::size_t first; (first = next->fetch_add(kBlock)) < count;) {
    Cancellation::Check();
    own.Sort(first, std::min(count, first + kBlock));
    own.SolveFull(&own.first_try);
    own.SolveFull(&own.second_try);
  }
  own.SolveRest(&own.first_try);
  own.SolveRest(&own.second_try);
}

}  // namespace lcpbench
