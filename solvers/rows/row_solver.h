#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/profile_pivoting.h"
#include "solvers/rows/row_islands.h"
#include "solvers/rows/step_rows.h"

namespace lcpbench {

/// How RowSolver ended.
struct RowAnswer {
  bool solved = false;          ///< f passed; else it is left to other solvers, and f is where they may begin
  std::int64_t iterations = 0;  ///< pivots, and iterations of what solved large islands
  double rho = 0;               ///< natural residual of f, in double
};

class RowSolver {
 public:
  void Reserve(Index max_rows, Index max_bodies);
  /// @param rows  checked
  /// @param f     n, written
  /// @param w     n, written
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
  void SolvePart(const Request& request, std::span<const std::int32_t> part, RowAnswer* answer);
  bool JudgePart(const Request& request, std::span<const std::int32_t> part, double* rho);
  template <int p, typename Real>
  bool Judge(const StepRows& rows, const Real* J, std::span<const std::int32_t> part, double tolerance, const double* f,
             double* w, double* rho);

  RowIslands islands_;
  ProfilePivoting profile_;
  std::vector<double> velocity_, size_;  // by body, 0 between calls
  SmallPivoting tableau_;
  std::vector<std::int32_t> all_;
};

/// Arrays in compressed rows, as two-body rows: the entries of J on bodies that move, copied to their places.
class TwoBodyCopy {
 public:
  /// False if a row acts on more than two bodies that can move.  O(entries)
  bool Take(const ProblemArrays& arrays);
  const StepRows& rows() const { return rows_; }

 private:
  template <int p>
  bool TakeRows(const ProblemArrays& arrays);
  StepRows rows_;
  std::vector<std::int32_t> body_;
  std::vector<double> J_;
};

}  // namespace lcpbench
