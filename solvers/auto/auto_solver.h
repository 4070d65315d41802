#pragma once

#include <cstdint>

#include "solvers/lcp/engine_solver.h"
#include "solvers/linear_algebra/instruction_set.h"

namespace lcpbench {

/// Options of AutoSolver.
struct AutoOptions {
  /// Up to this many rows a dense tableau is tried first; in [0, SmallPivoting::kMaxRows].
  Index tableau_rows = 64;
  /// The same where rows outnumber the degrees of freedom of the bodies, or A is nearly full: other backends find that
  /// harder.
  Index hard_tableau_rows = 128;
  /// Factorizations that the semismooth Newton method is granted, >= 1; problems up to 10^3 rows need 10 to 70.
  std::int64_t newton_factorizations = 150;
  /// SettingsReader::SelfCheck, of the backends too; without it a tableau's answer is taken as it is.
  bool self_check = true;
  InstructionSet instructions = InstructionSet::kBest;  ///< of the tableau; refused where the machine lacks them

  /// Keys `tableau_rows`, `hard_tableau_rows`, `newton_factorizations`, `self_check` and `instructions` (best, sse2,
  /// avx2, avx512). @throws InputError for others
  static AutoOptions FromSettings(const Settings& settings);
};

/// Divides the problem, chooses among our own backends, checks the answer, and asks the next one where it is not right.
///
/// Factors, from arrays or as an LcpProblem, with at most two moving bodies a row are taken by rows: RowSolver solves
/// each island by active sets, a tableau or a profile factor, and no form of A is made.
/// Arrays of a symmetric dense or sparse A go to a tableau or, above tableau_rows rows (hard_tableau_rows of a full A),
/// to BandPivoting, without an LcpProblem. What they leave open, and other problems, go this way:
///
/// 1. Up to tableau_rows rows: principal pivoting on a dense tableau (SmallPivoting); one and two rows in closed form.
/// 2. Above that, rows that cannot carry force and repeated rows are left out (IdleRows), and what remains
///    falls into islands that share no moving body. Islands of up to tableau_rows rows get a tableau each. Large
///    problems by factors (AutoPortfolio::IsLarge) are looked at by columns of J first: one large island stays whole.
/// 3. The rest goes to AutoPortfolio: nncg, bpp, semismooth-newton, hybrid and dantzig in the order that their
///    predicted cost suggests.
/// 4. Wherever an answer does not pass, the next backend is asked; a tableau that gave up sends its island to 3.
///
/// kSolved is claimed only for an f that passed, by rho and backward error of the problem: after a single tableau in
/// double, with a bound of what rounding can hide, and in extended precision by the given form where that is too wide;
/// after several tableaus by the given form; the backends of 3 judge by it themselves or are judged so. kInfeasible
/// only with a ray that VerifyFarkasRay accepts.
///
/// LcpResult::detail says what was done: islands, rows left out, which backend answered, and which ones failed before
/// it. `iterations` are those of the backend that answered, in its unit; with islands the sum of pivots, then the
/// iterations of the backend of the rest. Guaranteed class: symmetric positive semidefinite A of any rank, as its
/// backends; nonsymmetric A is refused. A failure leaves the last backend's f and status.
///
/// Warm start: for a tableau's size one factorization of the rows with initial_f > 0, a second one after their wrong
/// rows have changed sides, and a tableau only where that is not the answer; the others as their own headers say.
///
/// Set-up covers what the problem's structure suggests first, of rows a copy; other backends prepare within the solve.
/// Limits are the backends' own, the time limit is shared. Solve does not allocate up to tableau_rows rows, unless a
/// tableau fails.
using AutoSolver = EngineSolver<AutoOptions, class AutoEngine>;
extern template class EngineSolver<AutoOptions, AutoEngine>;

}  // namespace lcpbench
