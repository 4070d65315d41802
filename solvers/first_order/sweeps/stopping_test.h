#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/first_order/sweeps/row_work.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"

/// Internal to solvers/.
namespace lcpbench {

/// When a first-order solve is over, and what it then returns: the same for every such solver.
///
/// A check makes the image of f afresh, so that no rounding of earlier passes is left in it, and evaluates rho of the
/// scaled problem: about two sweeps. Where rho meets the tolerance, rho and the backward error are evaluated by the
/// *given* form in extended precision, and only that makes a kSolved. The iterate of least rho among those checked (the
/// start and, but for the time limit, the last one are) is kept and returned.
class StoppingTest {
 public:
  /// At least every so many iterations there is a check. Between checks the residuals that a pass sees at each row's
  /// own moment tell when one is likely to succeed.
  static constexpr std::int64_t kCheckInterval = 32;

  void Prepare(const LcpProblem& problem);
  /// From the next Begin on, see SettingsReader::SelfCheck. Without: rho of the scaled problem in double decides. On at
  /// first.
  void SetSelfCheck(bool self_check) { self_check_ = self_check; }

  /// From the next Begin on: whether a solve ends with kIterationLimit as soon as its rate of convergence, the mean
  /// since iteration `after` + 1, will not bring it to the tolerance within the limit. (The rate of the last iterations
  /// says less: it falls where the active set changes, and recovers.) Off at first.
  void EndWhenHopeless(bool end, std::int64_t after = 0) {
    ends_when_hopeless_ = end;
    hopeful_iterations_ = after;
  }

  /// Begins a solve of `problem` (the prepared one, or one that shares its matrix) at work->f and checks it. All
  /// pointers are kept until the end of the solve.
  /// @return true when the solve is over already; its status is set
  bool Begin(const LcpProblem& problem, const LcpOptions& options, std::int64_t default_limit, RowWork* work,
             PacedPasses* passes, LcpResult* result);
  /// One iteration is done: counts it, and checks where that is due. True when the solve is over.
  /// @param residual  norm of the natural residuals that the iteration's pass saw
  bool Continue(double residual);
  /// The time was up within an iteration, and f (not its image) is a valid iterate: ends the solve.
  void EndOutOfTime();
  /// Writes result->f.
  void Finish();

 private:
  bool Check();
  bool Claim();
  bool IsHopeless(double residual);

  GivenFormTest given_;
  bool self_check_ = true;
  bool ends_when_hopeless_ = false;
  std::int64_t hopeful_iterations_ = 0;
  double first_log_residual_ = 0;
  Array best_;
  Eigen::VectorXd candidate_;  // of the given problem, on trial for the claim
  bool claimed_ = false;
  double best_rho_ = 0;

  double tolerance_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t unchecked_ = 0;  // iterations since the last check
  std::int64_t patience_ = 1;   // iterations between checks that the residual asks for
  RowWork* work_ = nullptr;
  PacedPasses* passes_ = nullptr;
  LcpResult* result_ = nullptr;
};

}  // namespace lcpbench
