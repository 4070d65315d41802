#pragma once

#include <functional>
#include <memory>

#include "solvers/lcp/engine_solver.h"
#include "solvers/pivoting/pivot_options.h"

namespace lcpbench {

/// Options of LemkeSolver. Without block_start, the default, the path starts at the bilateral rows alone, as in the
/// book; with it a path is shorter, as it starts nearer to the solution: a quarter of the time at 100 rows.
struct LemkeOptions : PivotOptions {
  LemkeOptions() { block_start = false; }
  /// Those of PivotOptions.
  void Read(SettingsReader* reader) { ReadShared(reader); }

  /// Makes the solver of problems that are not plain, which are refused without it. Not a setting.
  std::function<std::unique_ptr<LcpSolver>()> make_other = {};
};

/// Lexicographic Lemke for symmetric positive semidefinite A, on an updated factor of the active block
/// [Lemke 1965; Cottle, Pang, Stone, sec. 4.4, 4.5, 4.9].
///
/// The problem with b + z d instead of b, covering vector d >= 0, has a known solution at z = 1; z falls
/// to 0 along the path of almost complementary bases. For symmetric A a basis is a set F with A_FF nonsingular, and the
/// tableau is never formed: f_F and w follow
///     f_F' = A_FF^-1 d_F,   w' = -d + A_F f_F'   (per unit of falling z)
/// until an f_i, i in F, or a w_i reaches 0. Then i changes sides, which is one of Lemke's pivots. Where the row p that
/// would enter depends on F, y = (-A_FF^-1 A_Fp, 1) has A y = 0: f moves along y at fixed z, no w changes, and the
/// first f_j to reach 0 leaves for p (two of Lemke's pivots); if none does, y >= 0 and y.b = -z y.d < 0, which is a
/// Farkas ray. Each step along the path or along a y is one *pivot*, the unit of LcpResult::iterations and
/// max_iterations (default 50 n + 1000; typically 0.5 n to 2 n are used).
///
/// Problems with friction, sliding or bounded rows are left to another solver: in the registry the same idea along the
/// modes of contacts, NormalMapPath::Cover, guaranteed for a time step with c >= 0 (docs/friction.md section 2), in
/// exact arithmetic.
///
/// Guaranteed for symmetric positive semidefinite A of any rank, in exact arithmetic: ends with a solution or with a
/// Farkas ray, since ties are resolved lexicographically and no basis is visited twice. On other symmetric A it may
/// fail, and says so; A that is not symmetric is refused, and A_ii < 0 is kUnsupported.
///
/// Claims, bilateral rows, restarts, memory and the tableau of SolveArrays as for DantzigSolver (dantzig.h); a path
/// starts again from the current F at most 10 times while that helps. Warm start: the rows with initial_f_i > 0 and
/// blocks of violated rows enter F first, and the path starts there. Only the set matters.
///
/// Cost: O(n^2) to load; per pivot one substitution pair for the direction and at most one more to enter, so about
/// 1.5 m^2 + m (n - m) multiply-adds for m = |F|; a tie costs as much again.
///
/// Other ends: kIterationLimit and kTimeLimit leave the f of the interrupted path (f_C >= 0, solving the problem with
/// b + z d), the others as for DantzigSolver. Covering vector, ties and departures from the book:
/// docs/solvers/pivoting.md.
using LemkeSolver = EngineSolver<LemkeOptions, class LemkeEngine>;
extern template class EngineSolver<LemkeOptions, LemkeEngine>;

}  // namespace lcpbench
