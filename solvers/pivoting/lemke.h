#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of LemkeSolver.
struct LemkeOptions {
  /// Row p depends on the active rows F if y.A y <= rank_tolerance (y.D y) for y = (-A_FF^-1 A_Fp, 1), D = diag A: as
  /// DantzigOptions::rank_tolerance, for the same reason. In (0, 1).
  double rank_tolerance = 1e-12;

  /// Also without a warm start, the path starts at an F that blocks of rows have entered and left, as by `dantzig`;
  /// else at the bilateral rows alone, as in the book. A path to the solution is the shorter the nearer it starts: a
  /// quarter of the time at 100 rows.
  bool block_start = false;
  bool self_check = true;  ///< SettingsReader::SelfCheck

  /// Larger problems are refused as unsupported before anything is allocated: three n x n arrays take 2.4 GB at the
  /// default. In [1, 100000].
  Index max_rows = 10'000;

  /// Keys `rank_tolerance`, `block_start` (yes, no), `max_rows` and `self_check`. @throws InputError for others
  static LemkeOptions FromSettings(const Settings& settings);
};

/// Lexicographic Lemke for symmetric positive semidefinite A, on an updated factor of the active block.
///
/// Method [Lemke 1965; Cottle, Pang, Stone, sec. 4.4, 4.5, 4.9]: the problem with b + z d in the place of b, covering
/// vector d >= 0, has a solution at z = 1 that is known; z falls to 0 along the path of almost complementary bases. For
/// symmetric A a basis is a set F with A_FF nonsingular, and the tableau is never formed: f_F and w follow
///     f_F' = A_FF^-1 d_F,   w' = -d + A_F f_F'   (per unit of falling z)
/// until an f_i, i in F, or a w_i reaches 0. Then i changes sides, which is one of Lemke's pivots. Where the row p that
/// would enter depends on F, y = (-A_FF^-1 A_Fp, 1) has A y = 0: f moves along y at fixed z, no w changes, and the
/// first f_j to reach 0 leaves for p (two of Lemke's pivots); if none does, y >= 0 and y.b = -z y.d < 0, which is a
/// Farkas ray. Each step along the path or along a y is one *pivot*, the unit of LcpResult::iterations and
/// max_iterations (default 50 n + 1000; typically 0.5 n to 2 n are used).
///
/// Guaranteed for symmetric positive semidefinite A of any rank, in exact arithmetic: ends with a solution or with a
/// Farkas ray. z never rises for such A, and ties (rows that reach 0 together but for rounding) are resolved
/// lexicographically: as if b were b + e g + e^2 u_1 + ... + e^(n+1) u_n for an infinitesimal e, u_k unit vectors, g
/// chosen such that the start has f_F, w > 0 to first order. Columns of this perturbation are computed one after the
/// other while a tie lasts; almost always g decides. No basis is visited twice. On other symmetric A it may fail, and
/// says so; A that is not symmetric is refused. In double precision kSolved is claimed only after w was recomputed by
/// the given form and meets the tolerance, kInfeasible only with a ray that VerifyFarkasRay accepts while the residual
/// of the published f is above the tolerance or 1e-9, whichever is less.
///
/// The covering vector is d_i = s sqrt(A_ii) for contacts outside F, 0 in F and for joints, with s such that the most
/// violated row has w = 0 at z = 1: independent of units and row scaling, as are all tolerances. A is scaled by powers
/// of two (PermutedLcp), so powers of two in A, b or single rows change no pivot and no bit.
///
/// Bilateral rows enter before all others by the rank rule and never leave; dependent ones are right for every f or
/// proved impossible, as in `dantzig`. Warm start: the unilateral rows with initial_f_i > 0 enter F, rows with f_i < 0
/// leave until none is left, blocks of violated rows follow as by `dantzig`, and the path starts there. Only the set
/// matters. At the end of the path f_F is solved
/// for with b, refined with the residual of the given form, and if rounding left a violation, a path from the current F
/// starts again (at most 10 times while that helps); then the solve is repeated with rank_tolerance / 100, then with
/// 1000 rank_tolerance.
///
/// Cost: O(n^2) to load; per pivot one substitution pair for the direction and at most one more to enter, so about
/// 1.5 m^2 + m (n - m) multiply-adds for m = |F|; a tie costs as much again. Memory: two n x n arrays besides DenseA().
/// Solve does not allocate for a problem of at most the reserved size, unless it reports a restart, a failure or a ray.
///
/// Other ways of ending: kIterationLimit and kTimeLimit leave the f of the interrupted path (f_C >= 0, solving the
/// problem with b + z d), kInfeasible the f that the ray was found at, kNumericalFailure the f of smallest
/// max(rho, squared backward error). kUnsupported: A_ii < 0.
///
/// Departures from the book: joints; the start from any F instead of F empty only; g before the unit vectors; a factor
/// of A_FF in the place of a tableau or basis inverse; repairs.
using LemkeSolver = EngineSolver<LemkeOptions, class LemkeEngine>;
extern template class EngineSolver<LemkeOptions, LemkeEngine>;

}  // namespace lcpbench
