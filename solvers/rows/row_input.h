#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/rows/row_judge.h"

namespace lcpbench {

/// Whether all numbers are in the range that methods square them in (LcpProblem::has_extreme_matrix, has_extreme_b).
/// Only the inverse masses of bodies that rows name are looked at.  O(n)
/// @param initial_f  n numbers, or nullptr
/// @throws InputError naming the array, the place and what was found: a size or p out of range, an array that is
///         missing, a body outside [-1, bodies), NaN or infinity, a negative inverse mass
bool CheckRows(const StepRows& rows, const double* initial_f);

/// Arrays in compressed rows, as two-body rows: J as it is where FindTwoBodies finds them, else the entries on bodies
/// that move, copied to their places; all numbers of A and b are checked on the way. Lists of friction and bounded rows
/// are those of the arrays, unchecked.
class TwoBodyCopy {
 public:
  /// False if a row acts on more than two bodies that can move, a number is extreme, or the arrays are wrong, which
  /// LcpProblem::FromArrays tells with its words.  O(entries); allocates where it has met no problem as large
  /// @param arrays  those of an LcpProblem, which has checked them, are of one in range; its b may have any size
  bool Take(const ProblemView& arrays);
  const StepRows& rows() const { return rows_; }

 private:
  template <Index p>
  bool TakeRows(const ProblemView& arrays);
  StepRows rows_;
  std::vector<std::int32_t> body_;
  std::vector<double> J_;
};

/// A problem as arrays have it, of rows with at most two moving bodies, and who judges answers to it.
struct RowTask {
  const StepRows& rows;
  std::span<const std::int32_t> all;  ///< 0, 1, 2, ... n - 1
  RowJudge& judge;
  const LcpOptions& options;
  const Deadline* deadline;  ///< nullptr for none
  double* w;                 ///< room for n numbers
};

/// An engine (engine_solver.h) that takes such rows without an LcpProblem. Internal to solvers/.
class RowEngine {
 public:
  RowEngine() = default;
  /// One that takes up to so many rows, and no limit of iterations.
  explicit RowEngine(Index most_rows) : most_rows_(most_rows) {}
  virtual ~RowEngine() = default;
  /// False where the arrays are of another kind, or not solved: they need an LcpProblem. Allocates where it has met no
  /// problem as large.
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);

 protected:
  /// False: not solved.
  virtual bool SolveRows(const RowTask& task, LcpResult* result) = 0;

 private:
  const std::optional<Index> most_rows_;
  TwoBodyCopy copy_;
  RowJudge judge_;
  std::vector<std::int32_t> all_;
  std::vector<double> w_;
};

}  // namespace lcpbench
