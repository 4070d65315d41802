#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solvers/friction/mode_steps.h"
#include "solvers/friction/relaxation.h"
#include "solvers/friction/relaxed_rows.h"
#include "solvers/pivoting/small_pivoting.h"

/// Internal to solvers/.
namespace lcpbench {

/// The rounds of `shift` by themselves, see shift.h. The relaxation of a dense A is P A P^T, solved by a tableau; of
/// others an LcpProblem.
class ShiftRounds {
 public:
  /// @param tableau  of dense A, outlives this
  /// @param plain    of others
  ShiftRounds(SmallPivoting* tableau, const WithinOptions& plain);
  /// For problems of up to so many rows.
  void Reserve(Index max_rows);
  /// Forgets the shift; for a solve of a problem whose ContactRows are `rows`.
  void Start(const ContactRows& rows);
  /// Whether the latest relaxation was solved: it may have no solution.
  bool is_solved() const { return status_ == LcpStatus::kSolved; }
  bool ran_out_of_time() const { return status_ == LcpStatus::kTimeLimit; }
  /// Up to `count` rounds. The method that answered; nullptr if none did. *phi: the forces of the last round.
  const char* TakeRounds(const ContactRows& rows, int count, ModeSteps* newton, PaddedVector* phi,
                         FrictionAnswer* answer);

 private:
  // Whether Newton's method may go on from the latest relaxation.
  bool has_forces() const { return status_ != LcpStatus::kUnsupported && status_ != LcpStatus::kTimeLimit; }
  const char* TakeRound(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi, FrictionAnswer* answer);
  void AssembleDense(const ContactRows& rows);
  bool RelaxDense(const ContactRows& rows, FrictionAnswer* answer, PaddedVector* phi);
  bool RelaxProblem(const ContactRows& rows, FrictionAnswer* answer, PaddedVector* phi);

  SmallPivoting* const tableau_;
  std::unique_ptr<RelaxationSolver> solver_;  // nullptr without `plain`
  LcpResult result_;
  LcpStatus status_ = LcpStatus::kNotRun;
  bool is_first_ = true, is_assembled_ = false;
  PaddedVector shift_;  // n: of scaled gaps
  PaddedVector gaps_, loads_, start_;
  RelaxedRows relaxed_;
  PaddedVector A_, row_, b_, f_, diagonal_;  // of the dense relaxation
  std::vector<unsigned char> bilateral_;
};

}  // namespace lcpbench
