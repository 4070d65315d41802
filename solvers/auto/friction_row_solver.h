#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/auto/row_solver.h"
#include "solvers/friction/contact_rows.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_path.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/friction/relaxed_rows.h"
#include "solvers/friction/shift_rounds.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/islands.h"

/// Internal to solvers/.
namespace lcpbench {

/// From a step's rows with friction to forces: what AutoSolver and StepSolver ask first, as RowSolver is of plain rows.
///
/// Islands (RowIslands) of up to six contacts alone are solved in arrays of fixed size (FewContacts). Each other one
/// has a dense A, and is solved by what FrictionPortfolio begins with: the modes of initial_f; of not many contacts,
/// Newton steps from 0, and of few all modes one by one; rounds of the shifted relaxation, whose rows are rows of a
/// step as well and RowSolver's, with Newton steps on modes after each; Lemke's path along modes. What does not pass
/// for certain (ContactRows::IsSurelyRight), steps without friction (all mu = 0), wrong lists of laws and islands of
/// more than kMostRows rows are left to the caller. Only Reserve allocates.
class FrictionRowSolver {
 public:
  static constexpr Index kMostRows = ModeFactor::kMostDense;  ///< of an island

  /// @param plain  asked for relaxations, outlives this
  explicit FrictionRowSolver(RowSolver* plain);
  FrictionRowSolver(const FrictionRowSolver&) = delete;
  FrictionRowSolver& operator=(const FrictionRowSolver&) = delete;

  /// Workspace for up to `max_rows` rows and `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// As RowSolver::Solve, of rows with friction rows; w may be nullptr.
  RowAnswer Solve(const StepRows& rows, double tolerance, const Deadline* deadline, const double* initial_f, double* f,
                  double* w);
  /// What answered the largest island of the last solve, in words.
  const char* method() const { return method_; }

 private:
  using Part = std::span<const std::int32_t>;
  bool TakeLaws(const StepRows& rows);
  bool TakeFew(const StepRows& rows, Index size, std::span<const FrictionRow> friction, double tolerance,
               const double* initial_f, double* f, double* w, RowAnswer* answer);
  void NameMethod(const char* method, Index size);
  void TakePart(Part part);
  bool SolvePart(Part part, const double* initial_f, double* f, double* w, RowAnswer* answer);
  const char* Ask(FrictionAnswer* answer);
  bool TakeRelaxation();
  LcpStatus Relax(const FrictionAnswer& answer, const Eigen::VectorXd& shift, const Eigen::VectorXd* start,
                  Eigen::VectorXd* f);

  RowSolver& plain_;
  Index reserved_rows_ = 0, reserved_bodies_ = 0;
  RowIslands islands_;
  std::vector<std::int32_t> all_;  // 0, 1, 2, ...
  // By row of the step: its place in the friction rows, in the bounded rows beyond these, or -1; and in its part.
  std::vector<std::int32_t> law_, place_;

  const StepRows* step_ = nullptr;
  // The part at hand, rows counted in it.
  Part part_;
  std::vector<FrictionRow> friction_;
  std::vector<BoundedRow> bounded_;
  ContactRows contacts_;
  ModeSteps newton_;
  ShiftRounds rounds_;
  ModePath path_;
  FrictionAnswer::Room room_;
  LcpOptions options_;
  LcpResult result_;
  const Deadline* deadline_ = nullptr;
  Eigen::VectorXd start_, phi_, loads_;
  const char* method_ = "";
  Index rows_of_method_ = 0;

  // Its relaxation.
  RelaxedRows relaxed_;
  bool relaxed_is_ready_ = false;
  StepRows relaxed_step_;
  std::vector<std::int32_t> relaxed_body_;
  std::vector<double> relaxed_J_, relaxed_b_, relaxed_f_, relaxed_w_, relaxed_start_;
  std::vector<unsigned char> relaxed_bilateral_;
};

}  // namespace lcpbench
