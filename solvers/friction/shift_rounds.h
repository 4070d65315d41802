#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>

#include "solvers/friction/mode_steps.h"
#include "solvers/friction/relaxation.h"

/// Internal to solvers/.
namespace lcpbench {

/// The rounds of `shift` by themselves, see shift.h.
class ShiftRounds {
 public:
  /// A relaxation: of the gaps b + shift, in the problem's units, within the limits of the answer.
  /// @param shift  n
  /// @param start  n, forces of the round before; nullptr: a cold start
  /// @param f      n, written: forces, zeros where there are none
  using Relax = std::function<LcpStatus(const FrictionAnswer& answer, const Eigen::VectorXd& shift,
                                        const Eigen::VectorXd* start, Eigen::VectorXd* f)>;

  explicit ShiftRounds(Relax relax) : relax_(std::move(relax)) {}
  /// For problems of up to so many rows.
  void Reserve(Index max_rows);
  /// Forgets the shift; for a solve of a problem whose ContactRows are `rows`.
  void Start(const ContactRows& rows);
  /// Whether the latest relaxation was solved: it may have no solution.
  bool is_solved() const { return status_ == LcpStatus::kSolved; }
  bool ran_out_of_time() const { return status_ == LcpStatus::kTimeLimit; }
  /// Up to `count` rounds. The method that answered; nullptr if none did. *phi: the forces of the last round.
  const char* Run(const ContactRows& rows, int count, ModeSteps* newton, Eigen::VectorXd* phi, FrictionAnswer* answer);

 private:
  const char* RunOne(const ContactRows& rows, ModeSteps* newton, Eigen::VectorXd* phi, FrictionAnswer* answer);

  const Relax relax_;
  LcpStatus status_ = LcpStatus::kNotRun;
  bool is_shifted_ = false;
  Eigen::VectorXd shift_, f_, start_, gaps_;  // n
};

/// By RelaxationSolver, of answer.problem().
ShiftRounds::Relax RelaxProblems(const WithinOptions& options);

}  // namespace lcpbench
