#pragma once

#include <Eigen/Core>

#include "solvers/first_order/nncg.h"
#include "solvers/interior_point/ipm_run.h"

namespace lcpbench {

/// How many iterations of nonsmooth conjugate gradients take as long as one factorisation with its solves, from times
/// measured together on one machine; of them only ratios enter.
/// @param flops, fill  of the factorisation
double SweepsPerFactorization(const LcpProblem& problem, double flops, double fill);

/// Turns an interior iterate into an answer without another factorisation. An interior point that has found mu leaves a
/// residual of sqrt(mu) in every row where f and w both vanish, so that going on to mu = 1e-18 would take it twice as
/// long as finding the active set. Two ways out, of which each costs less than one step:
///
/// - Where the active set F = {f > w} is right, w_F = 0 is solved by iterative refinement on the factor of the latest
///   step: A + diag(w / f) is nearly A_FF on F and decouples the other rows. A wrong F shows after one solve.
/// - Where it is nearly right, what is wrong is local, and sweeps of nonsmooth conjugate gradients mend it: one digit
///   in some 50 sweeps where redundant contacts leave many rows with f = w = 0. [nncg.h]
class InteriorFinish {
 public:
  /// @param self_check  of the sweeps
  explicit InteriorFinish(bool self_check);

  /// Set-up for a problem; the sweeps' own set-up waits until they are first needed.
  /// @param factor_work  of one factorisation [flop]: sweeps are for where that is much
  void Reserve(Index n, double factor_work);
  /// To be called at the beginning of a solve.
  void Restart() { least_tried_ = std::numeric_limits<double>::infinity(); }

  /// @param f, w  an interior iterate, scaled, after a step whose factor is the system's latest
  /// @returns whether run->best_f() meets the tier now
  bool Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  /// Rows whose side the latest Try found to be wrong after one solve, as a fraction of all: how far F is from right.
  double wrong_rows() const { return wrong_rows_; }
  bool may_sweep() const { return may_sweep_; }
  /// From run->best_f(), for as long as the rate of convergence promises the tier within `iterations`.
  /// @returns as Try
  bool SweepFromBest(IpmRun* run, std::int64_t iterations);

 private:
  bool Refine(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  bool Sweep(IpmRun* run, const Eigen::VectorXd& f);
  double Rho(const ScaledSystem& system, const Eigen::VectorXd& f);
  bool Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations);

  Eigen::VectorXd x_, gap_, right_, correction_;
  NncgSolver sweeps_;
  bool prepared_ = false;
  double wrong_rows_ = 1;
  bool may_sweep_ = false;
  double least_tried_ = 0;  // rho of the last iterate that the sweeps were given
};

}  // namespace lcpbench
