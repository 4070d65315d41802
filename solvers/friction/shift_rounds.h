#pragma once

#include <Eigen/Core>

#include "solvers/friction/mode_steps.h"
#include "solvers/friction/relaxation.h"

/// Internal to solvers/.
namespace lcpbench {

/// The rounds of `shift` by themselves, see shift.h.
class ShiftRounds {
 public:
  /// @param options  of the relaxation
  explicit ShiftRounds(const RelaxationOptions& options) : relaxation_(options) {}
  /// Forgets the shift; for a solve of a problem whose ContactRows are `rows`.
  void Start(const ContactRows& rows) { shift_.setZero(rows.size()); }
  /// Whether the latest relaxation was solved: it may have no solution.
  bool is_solved() const { return relaxed_.status == LcpStatus::kSolved; }
  /// Whether the next round is the relaxation itself.
  bool is_unshifted() const { return !shift_.any(); }
  /// One round. True where an answer passes, of the relaxation or of Newton's method. *phi: the forces of the round.
  /// *is_relaxed: whether it is the relaxation's own.
  bool Run(const ContactRows& rows, ModeSteps* newton, Eigen::VectorXd* phi, FrictionAnswer* answer, bool* is_relaxed);

 private:
  RelaxationSolver relaxation_;
  LcpResult relaxed_;
  Eigen::VectorXd shift_;  // n, of b in the problem's units
  Eigen::VectorXd start_, gaps_;
};

}  // namespace lcpbench
