#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "solvers/auto/auto_solver.h"
#include "solvers/batch/instructions.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Options of BatchSolver.
struct BatchOptions {
  /// Threads that share a batch, the calling one among them, >= 1. One by default: engines have threads of their own,
  /// and a batch of some hundred problems takes less time than waking others.
  int threads = 1;
  BatchInstructions instructions = BatchInstructions::kBest;  ///< refused where this machine lacks them
  /// Of the solver that gets what the lanes do not solve.
  AutoOptions fallback = {};
};

/// Problems of one size in one piece of memory, for callers that have no use for LcpProblem objects.
struct DenseBatch {
  Index rows = 0;             ///< n of every problem, in [0, BatchSolver::kMaxRows]
  Index problems = 0;         ///< how many
  const double* A = nullptr;  ///< problems x n x n; symmetric: only the entries (i, j), j <= i, of row-major A are read
  const double* b = nullptr;  ///< problems x n
  /// Bit i of entry p: row i of problem p is bilateral. nullptr: all rows of all problems are unilateral.
  const std::uint32_t* bilateral = nullptr;
};

/// Solves many small LCPs at once: one problem per SIMD lane, in double precision.
///
/// Method: principal pivoting on a symmetric tableau, rows in one order for all lanes (docs/solvers/batch.md). Powers
/// of two scale rows and b, so that units do not matter.
///
/// Every lane is checked by the given A and b as AutoSolver checks its tableau: rho <= 1e-9 and at most the tolerance
/// in double with all that rounding can hide of it, and every row's backward error <= sqrt(tolerance) / 10; one step of
/// refinement comes before where rho > 1e-13. Where rho alone meets the tolerance, extended precision decides, by the
/// problem's given form. A lane that did not finish, or does not pass, goes to AutoSolver: its answers, statuses, rays
/// and details are those of AutoSolver, and so is the guaranteed class: symmetric positive semidefinite A of any rank.
/// So do problems with more than kMaxRows rows, with nonsymmetric A, and all problems if
/// options.max_iterations is set, whose unit is that of a single backend. A failure leaves what AutoSolver leaves.
///
/// Cost: about n pivots of n^2 / 2 fused operations for a whole vector of problems, two to four times, plus reading A.
/// Equal sizes share vectors; sizes that do not fill one share with the next.
///
/// Determinism: an answer's bits depend on the problem alone, not on its place in the batch, on its neighbours or on
/// the number of threads. AVX2 and AVX-512 give the same bits; SSE2, which has no fused operations, its own.
///
/// One object serves one thread at a time.
class BatchSolver {
 public:
  static constexpr Index kMaxRows = 32;  ///< larger problems go to AutoSolver

  /// @throws InputError if this machine lacks the instructions, for threads < 1, or for options that AutoSolver refuses
  explicit BatchSolver(BatchOptions options = {});
  ~BatchSolver();

  /// Workspace for batches of up to `max_problems`: then Solve allocates only for results whose f has another size, in
  /// AutoSolver's later backends and tests in extended precision, and for forms of A that no one asked for before
  /// (DenseA is what is read).
  void Reserve(Index max_problems);

  /// results[i] answers problems[i]; status, f, iterations (pivots), detail ("lanes") and ray as LcpSolver::Solve
  /// writes them. Once options.time_limit_s is over, for the whole batch, the rest ends as kTimeLimit with f = 0.
  /// @throws InputError if the spans differ in length, for options out of range, or with an initial_f
  void Solve(std::span<const LcpProblem> problems, const LcpOptions& options, std::span<LcpResult> results);

  /// The same for a DenseBatch: f (problems x n) and, if not nullptr, status (one per problem) are written.
  /// @throws InputError also for rows out of range and where a problem has NaN or infinite numbers
  void Solve(const DenseBatch& batch, const LcpOptions& options, double* f, LcpStatus* status);

  /// How many problems of the last Solve went to AutoSolver.
  Index fallbacks() const;
  /// The instruction set in use; never kBest.
  BatchInstructions instructions() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lcpbench
