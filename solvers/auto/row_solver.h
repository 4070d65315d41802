#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "solvers/auto/auto_rules.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/fixed_size_bpp.h"
#include "solvers/rows/profile_pivoting.h"
#include "solvers/rows/row_judge.h"

namespace lcpbench {

/// How RowSolver ended.
struct RowAnswer {
  bool solved = false;          ///< f passed; else it is left to other solvers, and f is where they may begin
  bool fits = true;             ///< every island was for a method
  std::int64_t iterations = 0;  ///< pivots, and iterations of what solved large islands
  double rho = 0;               ///< natural residual of f, in double
};

/// From a step's rows to forces: what AutoSolver and StepSolver ask first.
///
/// Rows fall into islands that share no moving body (RowIslands). Each one is solved by itself, by the methods that the
/// rules of AutoStage::kRows name for its size, until an f passes by rho and backward errors of the given rows, in
/// double and with a bound of what rounding can hide. What does not pass is left to the caller, as is a step with an
/// island of more than AutoFacts::kMostIslandRows. Only Reserve allocates.
class RowSolver {
 public:
  /// @param instructions  of the kernels. @throws InputError where the machine lacks them
  /// @param only          asks no other method
  explicit RowSolver(InstructionSet instructions = InstructionSet::kBest, std::optional<AutoMethod> only = {})
      : only_(only),
        rules_(AutoRulesOf(AutoStage::kRows)),
        few_(instructions),
        profile_(instructions),
        tableau_(instructions) {}

  /// Workspace for up to `max_rows` rows and `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// @param rows       checked (CheckRows), not extreme
  /// @param initial_f  n numbers, finite, or nullptr
  /// @param f          n, written, also where it is not solved
  /// @param w          n, written where solved: A f + b in double
  /// @param deadline   or nullptr for none; not looked at before the first island is solved
  RowAnswer Solve(const StepRows& rows, double tolerance, const Deadline* deadline, const double* initial_f, double* f,
                  double* w);

 private:
  struct Request {
    const StepRows& rows;
    double tolerance;
    const Deadline* deadline;  // or nullptr
    const double* initial_f;
    double* f;
    double* w;
  };
  using Part = std::span<const std::int32_t>;
  enum class PartEnd {
    kSolved,
    kInexact,  // f is finite, and misses the tolerance
    kGaveUp,   // f is not to be used
    kNoRule,   // no method is for such a part
  };
  PartEnd SolvePart(const Request& request, Part part, RowAnswer* answer);
  static PartEnd SolveIdleRow(const Request& request, std::int32_t row);
  PartEnd Ask(AutoMethod method, const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  PartEnd AskFixedSizeBpp(const Request& request, Part part, RowAnswer* answer);
  PartEnd AskPrincipalPivoting(const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  PartEnd AskProfilePivoting(const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  bool Passes(const Request& request, Part part, double* rho) {
    return judge_.Passes(request.rows, part, request.tolerance, request.f, request.w, rho);
  }

  const std::optional<AutoMethod> only_;
  const std::span<const AutoRule> rules_;
  AutoFacts facts_;  // of the part at hand
  Index reserved_rows_ = 0, reserved_bodies_ = 0;
  RowIslands islands_;
  FixedSizeBpp few_;
  ProfilePivoting profile_;
  SmallPivoting tableau_;
  RowJudge judge_;
  std::vector<std::int32_t> all_;  // 0, 1, 2, ...
};

}  // namespace lcpbench
