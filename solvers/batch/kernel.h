#pragma once

#include <cstddef>
#include <cstdint>

/// Internal to solvers/batch/: what the batch solver and its kernels, one for each instruction set, know of each other.
/// Plain types only: this header is compiled with every set of flags.
namespace lcpbench {

inline constexpr int kBatchMaxRows = 64;
inline constexpr int kBatchMaxLanes = 8;
/// Up to so many rows a kernel takes rows in turn (such groups have no larger problems beside them), and so many it has
/// at most: what few lanes gain by rows of their own does not pay for their gathers.
constexpr int RowsInTurn(std::size_t lanes) { return lanes == 8 ? 12 : 32; }
constexpr int MostRowsIn(std::size_t lanes) { return lanes == 8 ? kBatchMaxRows : 32; }
inline constexpr std::size_t kBatchWorkspace = std::size_t{8} * kBatchMaxLanes * kBatchMaxRows * (kBatchMaxRows + 24);

/// What is read and written of one problem besides its rows of J: b and f (n), bit i of `joints` for a bilateral row i.
/// n: the lane's own rows without those that fill it up.
struct BatchItem {
  const double* b = nullptr;
  double* f = nullptr;
  std::uint64_t joints = 0;
  int n = 0;
};

/// As many problems as the kernel has lanes, given by their rows (StepRows), all filled up to `rows` rows; a lane
/// without a problem of its own repeats another's.
struct BatchGroup {
  BatchItem items[kBatchMaxLanes];
  const std::int32_t* body[kBatchMaxLanes] = {};
  const double* J[kBatchMaxLanes] = {};
  const float* J_single[kBatchMaxLanes] = {};  ///< read where J[0] is nullptr
  const double* inverse_mass = nullptr;
  std::int64_t bodies = 0;
  int columns_per_body = 3;
  int rows = 0;
  void* workspace = nullptr;   ///< kBatchWorkspace bytes, aligned to 64
  double rho_limit = 0;        ///< at most this rho, in double, where rounding hides no row's error and
  double rounding_limit = 0;   ///< can hide at most this much of it
  double close_rho_limit = 0;  ///< up to this one a test in higher precision is worth while
  double row_limit = 0;        ///< at most this backward error of each row, in double
  /// This part of A_ii is added to it in the tableau, so that rows that depend on others move, too; refinement against
  /// A itself makes up for it.
  double shift = 0;
  /// What memory shall bring meanwhile, a little with every row: of the group after this one all but the bodies, which
  /// have come before, and of the one after that the bodies.
  struct Next {
    const std::int32_t* body;
    const char* J;
    const double* b;
    const double* f;
    const std::int32_t* later_body;
  } next[kBatchMaxLanes] = {};
  int next_rows = 0;  ///< of the smaller one of both; 0: nothing
  // Answers.
  std::uint32_t met = 0;    ///< bit l: the f of lane l passed both limits
  std::uint32_t close = 0;  ///< bit l: it passed close_rho_limit and row_limit
  int pivots[kBatchMaxLanes] = {};
  double rho[kBatchMaxLanes] = {};  ///< an upper bound, at most 4 times too large
};

/// Brings inverse_mass[at] into the cache, if there is such a number. Of no linkage: see vector_register.h.
[[maybe_unused, gnu::always_inline]] static inline void FetchMass(const double* inverse_mass, std::int64_t at) {
  const auto address =
      reinterpret_cast<std::uintptr_t>(inverse_mass) + (static_cast<std::uintptr_t>(at) * sizeof(double));
  // NOLINTNEXTLINE(performance-no-int-to-ptr): may be outside of the array
  __builtin_prefetch(reinterpret_cast<const void*>(address));
}

/// The kernel of one instruction set.
struct BatchKernels {
  std::size_t lanes;
  void (*solve)(BatchGroup* group);
};

void SolveGroupAvx512(BatchGroup* group);
void SolveGroupAvx2(BatchGroup* group);
void SolveGroupSse2(BatchGroup* group);

}  // namespace lcpbench
