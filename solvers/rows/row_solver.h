#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/profile_pivoting.h"
#include "solvers/rows/row_islands.h"

namespace lcpbench {

/// How RowSolver ended.
struct RowAnswer {
  bool solved = false;          ///< f passed; else it is left to other solvers, and f is where they may begin
  std::int64_t iterations = 0;  ///< pivots, and iterations of what solved large islands
  double rho = 0;               ///< natural residual of f, in double
};

/// From a step's rows to forces: what AutoSolver and StepSolver ask first.
///
/// 1. Rows fall into islands that share no moving body (RowIslands), each one solved by itself.
/// 2. Up to 6 rows: one active set after the other (TinyRows).
/// 3. Up to 128 rows: principal pivoting on a dense tableau, into which A is assembled (SmallPivoting).
/// 4. Above, and where the tableau gave up: ProfilePivoting.
///
/// An island counts as solved only if its f passes by rho and backward errors of the given rows, in double and with a
/// bound of what rounding can hide. What does not is left to the caller, as is an island of more than kMostIslandRows.
/// Only Reserve allocates.
class RowSolver {
 public:
  static constexpr Index kMostIslandRows = 2000;

  /// @throws InputError if this machine lacks the instructions
  explicit RowSolver(InstructionSet instructions) : tableau_(instructions) {}

  /// Workspace for up to `max_rows` rows and `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// @param rows       checked (CheckRows), not extreme
  /// @param initial_f  n numbers, finite, or nullptr
  /// @param f          n, written, also where it is not solved
  /// @param w          n, written where solved: A f + b in double
  RowAnswer Solve(const StepRows& rows, const LcpOptions& options, const double* initial_f, double* f, double* w);

 private:
  struct Request {
    const StepRows& rows;
    const LcpOptions& options;
    const double* initial_f;
    const Deadline* deadline;  // or nullptr
    double* f;
    double* w;
  };
  enum class DenseEnd {
    kSolved,
    kInexact,  // f is finite, and misses the tolerance
    kGaveUp,   // f is not to be used
  };
  DenseEnd SolveDense(const Request& request, std::span<const std::int32_t> part, RowAnswer* answer);
  void SolvePart(const Request& request, std::span<const std::int32_t> part, RowAnswer* answer);
  bool JudgePart(const Request& request, std::span<const std::int32_t> part, double* rho);
  enum class Known { kRight, kUnclear, kWrong };
  template <Index p, typename Real, typename Sum>
  Known Judge(const StepRows& rows, const Real* J, std::span<const std::int32_t> part, double tolerance,
              const double* f, double* w, double* rho, Sum* v);

  RowIslands islands_;
  ProfilePivoting profile_;
  std::vector<double> velocity_, size_;  // by body, 0 between calls
  std::vector<long double> extended_velocity_;
  SmallPivoting tableau_;
  std::vector<std::int32_t> all_;  // 0, 1, 2, ...
};

/// Arrays in compressed rows, as two-body rows: the entries of J on bodies that move, copied to their places, and all
/// numbers checked on the way.
class TwoBodyCopy {
 public:
  /// False if a row acts on more than two bodies that can move, a number is extreme, or the arrays are wrong, which
  /// LcpProblem::FromArrays tells with its words.  O(entries); allocates where it has met no problem as large
  bool Take(const ProblemArrays& arrays);
  const StepRows& rows() const { return rows_; }

 private:
  template <Index p>
  bool TakeRows(const ProblemArrays& arrays);
  StepRows rows_;
  std::vector<std::int32_t> body_;
  std::vector<double> J_;
  std::vector<unsigned char> moves_;  // by body
};

}  // namespace lcpbench
