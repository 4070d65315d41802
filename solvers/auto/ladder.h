#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "solvers/auto/auto_rules.h"
#include "solvers/auto/law_ladder.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/fixed_size_bpp.h"
#include "solvers/rows/profile_pivoting.h"
#include "solvers/rows/row_judge.h"

namespace lcpbench {

/// How Ladder ended.
struct RowAnswer {
  bool solved = false;          ///< f passed; else it is left to other solvers, and f is where they may begin
  bool fits = true;             ///< every island was for a method
  std::int64_t iterations = 0;  ///< pivots, steps, and iterations of what solved large islands
  double rho = 0;               ///< natural residual of f, in double
  std::size_t next = 0;  ///< of rows with laws: the first rule that an open island has not asked; 0: none was asked
};

/// From a step's rows to forces: what AutoSolver and StepSolver ask first.
///
/// Rows fall into islands that share no moving body and no law (RowIslands). Each one is solved by itself, by the
/// methods that the rules of AutoStage::kRows name for its size, or those of AutoStage::kLaws where the step has
/// friction rows, until an f passes by rho and backward errors, in double and with a bound of what rounding can hide.
/// What does not pass is left to the caller, as are a step with a plain island of more than AutoLimits::island_rows
/// rows, islands with laws of more than kMostLawRows, steps whose mu are all 0, and wrong lists of laws. Only Reserve
/// allocates.
class Ladder {
 public:
  static constexpr Index kMostLawRows = ModeFactor::kMostDense;  ///< of an island with laws, whose A is dense

  /// @param instructions  of the kernels. @throws InputError where the machine lacks them
  /// @param only          asks no other method
  /// @param limits        outlive this
  explicit Ladder(InstructionSet instructions = InstructionSet::kBest, std::optional<AutoMethod> only = {},
                  const AutoLimits& limits = kDefaultLimits)
      : only_(only),
        limits_(limits),
        few_(instructions),
        profile_(instructions),
        tableau_(instructions),
        relaxations_(instructions) {}
  Ladder(const Ladder&) = delete;
  Ladder& operator=(const Ladder&) = delete;

  /// Workspace for up to `max_rows` rows and `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// The same with room for laws.
  void ReserveLaws(Index max_rows, Index max_bodies);
  /// @param rows       checked (CheckRows), not extreme; reserved for, laws too where it has friction rows
  /// @param initial_f  n numbers, finite, or nullptr
  /// @param f          n, written, also where it is not solved
  /// @param w          n, written where solved: A f + b in double; may be nullptr with friction rows
  /// @param deadline   or nullptr for none; not looked at before the first island is solved
  RowAnswer Solve(const StepRows& rows, double tolerance, const Deadline* deadline, const double* initial_f, double* f,
                  double* w);
  /// What answered the largest island of the last solve of rows with laws, in words.
  const char* method() const { return method_; }

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
  PartEnd TryMethod(AutoMethod method, const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  PartEnd TryFixedSizeBpp(const Request& request, Part part, RowAnswer* answer);
  PartEnd TryPrincipalPivoting(const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  PartEnd TryProfilePivoting(const Request& request, Part part, const double* initial_f, RowAnswer* answer);
  bool Passes(const Request& request, Part part, double* rho) {
    return judge_.Passes(request.rows, part, request.tolerance, request.f, request.w, rho);
  }

  // Rows with laws.
  struct LawWork {
    LawWork(SmallPivoting* tableau, const AutoLimits& limits) : ladder(tableau, {}, limits) {}

    LawLadder ladder;
    // By row of the step: its place in the friction rows, in the bounded rows beyond these, or -1; and in its part.
    std::vector<std::int32_t> law, place;
    // The laws of the island that is solved; rows are counted in the island.
    std::vector<FrictionRow> friction;
    std::vector<BoundedRow> bounded;
    ContactRows contacts;
    FrictionAnswer::Room room;
    LcpOptions options;
    LcpResult result;
    PaddedVector start, gaps;
  };
  bool TakeLaws(const StepRows& rows);
  bool TryFixedSizeModes(const Request& request, Index size, std::span<const FrictionRow> friction, RowAnswer* answer);
  PartEnd SolveLaws(const Request& request, Part part, RowAnswer* answer);
  void PrepareLaws(const Request& request, Part part);
  void NameMethod(const char* method, Index size);

  const std::optional<AutoMethod> only_;
  const AutoLimits& limits_;
  AutoFacts facts_{.limits = &limits_};  // of the part at hand
  Index reserved_rows_ = 0, reserved_bodies_ = 0;
  RowIslands islands_;
  FixedSizeBpp few_;
  ProfilePivoting profile_;
  SmallPivoting tableau_;
  RowJudge judge_;
  std::vector<std::int32_t> all_;  // 0, 1, 2, ...

  SmallPivoting relaxations_;
  std::optional<LawWork> laws_;  // made where laws are first reserved for
  const char* method_ = "";
  Index rows_of_method_ = 0;
};

}  // namespace lcpbench
