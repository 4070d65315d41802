#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Which waiting unilateral row is driven next.
enum class DantzigOrder {
  kIndex,         ///< in the order of the rows: rows not yet reached need no w, so a pivot costs least
  kMostNegative,  ///< the most negative w_i / sqrt(A_ii): about a quarter fewer pivots, each with all of w
};

/// Options of DantzigSolver.
struct DantzigOptions {
  /// Row d depends on the active rows F if y.A y <= rank_tolerance (y.D y) for y = (-A_FF^-1 A_Fd, 1), D = diag A: if y
  /// shows that D^-1/2 A D^-1/2 on F + d has an eigenvalue <= rank_tolerance. Independent of units and row scaling. The
  /// default lies between the rounding of A (n epsilon) and the eigenvalues of contacts with mass ratios up to 1e8
  /// (about 1e-9). In (0, 1).
  double rank_tolerance = 1e-12;
  DantzigOrder order = DantzigOrder::kIndex;  ///< which row is driven next

  /// Before rows are driven one by one, blocks of rows enter and leave F at once: see below. Without them the method is
  /// the paper's.
  bool block_start = true;
  bool self_check = true;  ///< SettingsReader::SelfCheck

  /// Larger problems are refused as unsupported before anything is allocated: three n x n arrays take 2.4 GB at the
  /// default, and pivoting on them minutes. In [1, 100000].
  Index max_rows = 10'000;

  /// Keys `rank_tolerance`, `order` (index, most-negative), `block_start` (yes, no), `max_rows` and
  /// `self_check`. @throws InputError
  /// for others
  static DantzigOptions FromSettings(const Settings& settings);
};

/// Incremental pivoting on the dense A with an updated factor of its active block.
///
/// Method [Baraff 1994, sec. 4]: F is the set of rows whose force may be nonzero. Rows are made right one at a time:
/// f_d of a row with w_d < 0 is raised, f_F following along df_F = -A_FF^-1 A_Fd so that w_F stays 0, until w_d = 0 and
/// d joins F; whenever an f_i, i in F, or the w_i of a row that is right already, would turn negative first, i changes
/// sides and driving goes on. Each direction is one *pivot*, the unit of LcpResult::iterations and max_iterations
/// (default 50 n + 1000; typically 0.5 n to 2 n are used).
///
/// Guaranteed for symmetric positive semidefinite A of any rank, in exact arithmetic: ends with a solution or with a
/// Farkas ray, because ties go to the least index after 20 degenerate pivots in a row [Chang, Cottle 1980]. On other
/// symmetric A it may fail, and says so; A that is not symmetric is refused. In double precision the claim kSolved is
/// made only after w was recomputed by the given form and meets the tolerance. The method is direct: whatever the
/// tolerance, it refines and repairs until rho and the squared backward error are at most 1e-13, or no longer improve.
///
/// Redundant rows: the rule of rank_tolerance decides. A dependent row has A y = 0, so raising it moves no w: only
/// forces can block, and if none does, y is a ray. It is reported as kInfeasible only if VerifyFarkasRay accepts it (y
/// is refined with extended-precision residuals first if need be) and the residual of the published f is above the
/// tolerance or 1e-9, whichever is less: a proof holds at every tolerance, but what rounding alone made infeasible is
/// solved. A row that is neither right nor proved impossible is left, and the final check decides. If that check fails,
/// the solve is repeated from the start with rank_tolerance / 100, then with 1000 rank_tolerance, then ends as
/// kNumericalFailure.
///
/// Bilateral rows enter before all others and never leave; dependent ones are left out with f = 0 for good: y has its
/// support on bilateral rows then, so y.w = y.b for every f, and the row is right if y.b = 0 and impossible otherwise.
///
/// Start: driving may begin at any F with A_FF nonsingular and f_F >= 0. The unilateral rows with b_i < 0 enter
/// together with the bilateral ones, f_F is solved for, and rows with f_i < 0 leave until none is left; then all rows
/// with w_i < 0 enter, and so on while more than two are violated and their number falls to 80 %. Each of these blocks
/// is one factorisation (rows that depend on those before are left out) and counts as one pivot but for the first.
/// Where blocks do not settle, which is where contacts are redundant, driving does the rest. Warm start: the first
/// block is that of the rows with initial_f_i > 0 (relative to the largest, in units of D^-1/2) in place of b_i < 0.
/// Only the set matters, not the values.
///
/// Stability: A is scaled by powers of two (PermutedLcp); the factor is L D L^T, rows enter by a substitution and leave
/// by a positive rank-one update (ActiveSet, DenseLdlt), O(m^2) each for m = |F|. While rows are driven it is not made
/// anew: on recorded problems a fresh factor of the final F did not lower the residual.
///
/// Cost: O(n^2) to load, then m^2 + m |watched rows| multiply-adds per pivot, O(n m) to judge. Memory: two n x n arrays
/// besides DenseA(). Solve does not allocate for a problem of at most the reserved size, unless it reports a restart, a
/// failure or a ray.
///
/// Other ways of ending: kIterationLimit and kTimeLimit leave the f of the interrupted drive (f_C >= 0; rows not yet
/// reached may have w < 0), kInfeasible the f that the ray was found at, kNumericalFailure the f of smallest
/// max(rho, squared backward error). kUnsupported: A_ii < 0.
///
/// Departures from the paper: joints are solved as a block before the contacts; the rank rule and rays for singular
/// A_FF; the rule for ties; blocks; warm start; rounds of repair after the last row.
using DantzigSolver = EngineSolver<DantzigOptions, class DantzigEngine>;
extern template class EngineSolver<DantzigOptions, DantzigEngine>;

}  // namespace lcpbench
