#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "solvers/auto/auto_limits.h"
#include "solvers/lcp/engine_solver.h"
#include "solvers/linear_algebra/instruction_set.h"

namespace lcpbench {

enum class AutoMethod : std::uint8_t;  // auto_rules.h

/// What the methods of AutoStage::kRows and kLaws left open: the others go on from there.
struct RowsReached {
  bool was_asked = false;  ///< false: numbers are out of their range, or rows are bounded and none has friction
  std::size_t next = 0;    ///< of rows with laws: RowAnswer::next
  Eigen::VectorXd f;       ///< where it was asked
};

/// Options of AutoSolver.
struct AutoOptions {
  AutoLimits limits = {};  ///< within the ranges of kAutoLimits
  /// What a caller's own Ladder has reached of the problem that is solved next, as StepSolver's has; or nullptr.
  const RowsReached* reached = nullptr;
  bool asks_exact = true;  ///< whether the exact rule comes last; not of what a solver asks within its own solve
  InstructionSet instructions = InstructionSet::kBest;  ///< of the tableau; refused where the machine lacks them
  /// One method of AutoStage::kRows or kMatrix that is asked and no other; empty: all.
  std::optional<AutoMethod> only = {};

  /// Keys: the names of kAutoLimits and `instructions` (best, sse2, avx2, avx512).
  /// @throws InputError for others
  static AutoOptions FromSettings(const Settings& settings);
  /// The options of a solver that is one method of `auto` and no other. @throws InputError for any setting
  static AutoOptions Only(AutoMethod method, const Settings& settings);
};

/// Divides the problem, chooses among our own methods, checks the answer, and asks the next one where it is not right.
/// Which method comes when is a table of rules (auto_rules.h, docs/solvers/auto.md), read from the top:
///
/// 1. Factors with at most two moving bodies a row, and symmetric matrices, from arrays or as an LcpProblem, are read
///    in place: rows by Ladder, island by island; a matrix by a tableau or a banded factor.
/// 2. Other problems, and what 1 leaves open: a tableau where it is small, else rows that cannot carry force are left
///    out (IdleRows), and small islands of the others get a tableau each.
/// 3. What remains goes to AutoPortfolio: other solvers, in the order of their predicted cost.
///
/// kSolved is claimed only for an f that passed, by rho and backward error of the problem: in 1 and after a single
/// tableau in double, with a bound of what rounding can hide, and in extended precision where that is too wide; after
/// several tableaus by the given form; the solvers of 3 judge by it themselves. kInfeasible only with a ray that
/// VerifyFarkasRay accepts.
///
/// LcpResult::detail says what was done: islands, rows left out, which method answered, and which ones failed before
/// it. `iterations` are those of all backends, each in its unit; with islands the sum of pivots, then those of the
/// backends of the rest. Guaranteed class: symmetric positive semidefinite A of any rank, as its backends; nonsymmetric
/// A is refused. A failure leaves the last backend's f and status.
///
/// Warm start: for a tableau's size one factorization of the rows with initial_f > 0, a second one after their wrong
/// rows have changed sides, and a tableau only where that is not the answer; the others as their own headers say.
///
/// Set-up covers what the problem's structure suggests first, of rows a copy; other backends prepare within the solve.
/// Limits hold for all backends together. Solve does not allocate up to tableau_rows rows, unless a tableau
/// fails.
using AutoSolver = EngineSolver<AutoOptions, class AutoEngine>;
extern template class EngineSolver<AutoOptions, AutoEngine>;

}  // namespace lcpbench
