#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/instruction_set.h"

namespace lcpbench {

/// Options of StepSolver.
struct StepOptions {
  double tolerance = 1e-9;                                        ///< requested bound on rho (verify.h), in (0, 1)
  double time_limit_s = std::numeric_limits<double>::infinity();  ///< of one Solve, wall clock [s], > 0
  InstructionSet instructions = InstructionSet::kBest;            ///< of kernels; refused where the machine lacks them
  /// Threads of one SolveBatch, in [1, 1024], the caller's among them. Each call starts one thread per block of 512
  /// problems (16 with friction or bounded rows), at most so many. Results are the same with any number.
  int threads = 1;
};

/// How a solve of StepSolver ended.
struct StepAnswer {
  LcpStatus status = LcpStatus::kNotRun;  ///< the solver's claim, as LcpResult::status
  std::int64_t iterations = -1;           ///< pivots, and iterations of what solved large islands
  /// Natural residual of f (verify.h), as the solver measured it: the largest of its islands, which that over all rows
  /// does not exceed. Infinite where it was not measured, or is beyond double; never NaN.
  double rho = std::numeric_limits<double>::infinity();
  /// For kInfeasible: whether the ray is a proof, or holds within rounding only. False where the status is another.
  bool infeasible_proved = false;
  /// For kInfeasible within rounding: any solution needs |D^1/2 f|_1 of this or more (FarkasVerdict). Else 0.
  double force_min = 0;
};

/// From an engine's arrays to forces, for the LCP of one time step: what `auto` does, without LcpProblem objects.
///
/// Reads the caller's arrays in place, copies no matrix, and allocates nothing up to the sizes given to Reserve (1000
/// rows and more), unless all of its own methods fail on an island (Ladder): then AutoSolver's other backends are
/// asked, whose factorizations allocate. Method, guaranteed class (every A = J M^-1 J^T) and checks are those of
/// Ladder and AutoSolver; kSolved is claimed only for an f that passed.
///
/// Steps with friction rows, and bounded rows beside them, are solved in the same way, which allocates nothing where
/// every island has up to Ladder::kMostLawRows (128) rows. What it leaves open is
/// AutoSolver's and allocates, as do steps with bounded rows and no friction.
///
/// The input is checked in the same call: NaN, infinity, negative masses, bodies out of range, and friction and bounded
/// rows that LcpProblem refuses are refused. Bodies that no row names do not count: their inverse masses may be
/// anything, in Solve and in SolveBatch.
/// One object serves one thread at a time. The same rows and start give the same bits, whatever came before.
class StepSolver {
 public:
  /// @throws InputError for options out of range
  explicit StepSolver(const StepOptions& options = {});
  ~StepSolver();

  /// Workspace for steps of up to `max_rows` rows and `max_bodies` bodies; larger ones allocate once by themselves.
  void Reserve(Index max_rows, Index max_bodies);

  /// @param rows       the arrays of this step
  /// @param initial_f  warm start: rows.rows numbers, finite, 0 for new rows, in another array than f; nullptr: a cold
  ///                   start
  /// @param f          rows.rows numbers, written: forces, the best there are where the status is not kSolved
  /// @param w          rows.rows numbers, written: A f + b in double; nullptr: not wanted
  /// @throws InputError naming the array, the row or body, and what was found, with nothing written
  StepAnswer Solve(const StepRows& rows, const double* initial_f, double* f, double* w = nullptr);

  /// Many problems that share no body that can move, each given by its rows: problem k has the rows start[k] to
  /// start[k + 1] - 1 of `rows`. From arrays to forces by one problem per SIMD lane (RowBatch); what lanes do not
  /// solve, and problems of more than RowBatch::kMaxRows rows, as Solve. Lanes give an upper bound of rho, at most 4
  /// times too large. A problem's bits depend on it alone, not on its neighbours. time_limit_s is that of one problem.
  /// Where any problem has friction or bounded rows there are no lanes: each one is solved as Solve does, in its bits,
  /// side by side in threads. These allocate a copy of the lists.
  /// @param start    one number more than there are problems, ascending from 0 to rows.rows
  /// @param f        rows.rows numbers, written
  /// @param answers  one per problem, written
  /// With options.threads > 1 it allocates what threads need.
  /// @throws InputError as Solve, for `start`, and for a friction row whose normal row is of another problem; then f
  /// and answers may be written in part
  void SolveBatch(const StepRows& rows, std::span<const std::int32_t> start, double* f, std::span<StepAnswer> answers);

  /// How many solves went to AutoSolver since the construction: those that allocate.
  std::int64_t fallbacks() const;
  /// How many problems of the last SolveBatch were not solved in lanes.
  std::int64_t left() const;

 private:
  class BatchReceiver;
  struct Implementation;
  std::int64_t Sum(std::int64_t Implementation::*count) const;

  std::vector<std::unique_ptr<Implementation>> threads_;  // one each; the first is the caller's
};

}  // namespace lcpbench
