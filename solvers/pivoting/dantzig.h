#pragma once

#include "solvers/lcp/engine_solver.h"
#include "solvers/pivoting/pivot_options.h"

namespace lcpbench {

/// Which waiting unilateral row is driven next.
enum class DantzigOrder {
  kIndex,         ///< in the order of the rows: rows not yet reached need no w, so a pivot costs least
  kMostNegative,  ///< the most negative w_i / sqrt(A_ii): about a quarter fewer pivots, each with all of w
};

/// Options of DantzigSolver. Without block_start the method is the paper's.
struct DantzigOptions : PivotOptions {
  DantzigOrder order = DantzigOrder::kIndex;  ///< which row is driven next

  /// Those of PivotOptions, and `order` (index, most-negative).
  void Read(SettingsReader* reader);
};

/// Incremental pivoting on the dense A with an updated factor of its active block [Baraff 1994, sec. 4].
///
/// F is the set of rows whose force may be nonzero. Rows are made right one at a time: f_d of a row with w_d < 0 is
/// raised, f_F following along df_F = -A_FF^-1 A_Fd so that w_F stays 0, until w_d = 0 and d joins F; whenever an f_i,
/// i in F, or the w_i of a row that is right already, would turn negative first, i changes sides and driving goes on.
/// Each direction is one *pivot*, the unit of LcpResult::iterations and max_iterations (default 50 n + 1000; typically
/// 0.5 n to 2 n are used). Bilateral rows enter before all others and never leave.
///
/// Guaranteed for symmetric positive semidefinite A of any rank, in exact arithmetic: ends with a solution or with a
/// Farkas ray, because ties go to the least index after 20 degenerate pivots in a row [Chang, Cottle 1980]. On other
/// symmetric A it may fail, and says so; A that is not symmetric is refused, and A_ii < 0 is kUnsupported.
///
/// kSolved is claimed only after w was recomputed by the given form and meets the tolerance, kInfeasible only with a
/// ray that VerifyFarkasRay accepts. The method is direct: whatever the tolerance, it refines and repairs until rho and
/// the squared backward error are at most 1e-13, or no longer improve; then it starts anew with rank_tolerance / 100
/// and with 1000 rank_tolerance.
///
/// Warm start: the rows with initial_f_i > 0 (relative to the largest, in units of D^-1/2) are the first block. Only
/// the set matters, not the values.
///
/// SolveArrays first drives rows on a dense tableau (SmallPivoting) where rows are few: docs/solvers/pivoting.md.
///
/// Cost: O(n^2) to load, then m^2 + m |watched rows| multiply-adds per pivot for m = |F|, O(n m) to judge. Memory: two
/// n x n arrays besides DenseA(). Solve does not allocate for a problem of at most the reserved size, unless it reports
/// a restart, a failure or a ray.
///
/// Other ends: kIterationLimit and kTimeLimit leave the f of the interrupted drive (f_C >= 0; rows not yet reached may
/// have w < 0), kInfeasible the f that the ray was found at, kNumericalFailure the f of least max(rho, squared backward
/// error). Redundant rows, the start and departures from the paper: docs/solvers/pivoting.md.
using DantzigSolver = EngineSolver<DantzigOptions, class DantzigEngine>;
extern template class EngineSolver<DantzigOptions, DantzigEngine>;

}  // namespace lcpbench
