#pragma once

#include <Eigen/Core>

#include "solvers/interior_point/ipm_run.h"

namespace lcpbench {

/// Mehrotra's predictor-corrector for  w = A f + b, f_C, w_C > 0, f_C w_C = mu, w_B = 0  in scaled variables, with
/// Gondzio's centrality correctors. [Mehrotra 1992; Gondzio 1996; Wright, Primal-Dual Interior-Point Methods, ch. 10]
class InteriorPoint {
 public:
  enum class Progress {
    kGood,
    kStagnant,  ///< steps have become too short, or mu no longer falls
    kDiverged,  ///< f has left every reasonable bound: infeasible or very ill-conditioned
    kStopped,   ///< a limit, or no factorization
  };

  void Reserve(Index n);
  /// Regularised equality solve and Mehrotra's shift (one factorization).
  Progress StartCold(IpmRun* run);
  /// From f, moved onto f w = mu with f - w kept, so that no row is off centre (no factorization). [The smoothing of
  /// Chen, Harker 1993 and Kanzow 1996, taken for a start]
  /// @param mu_per_residual  mu in root mean squares of the natural residual of f
  void StartWarm(IpmRun* run, const Eigen::VectorXd& f, double mu_per_residual);
  /// Where rows block the steps: back to the middle, f w = growth mu in every row with f - w as it is, from where
  /// steps are long again.
  void Recentre(IpmRun* run, double growth);
  /// One step (one factorization).
  Progress Step(IpmRun* run);

  const Eigen::VectorXd& f() const { return f_; }
  const Eigen::VectorXd& w() const { return w_; }
  double mu() const { return mu_; }
  /// Part of its direction that the latest Step went, 0 to 1.
  double step() const { return step_; }
  /// max |A f + b - w|.
  double residual() const { return residual_; }

 private:
  void Measure(IpmRun* run);
  void Centre(const ScaledSystem& system, double mu);
  bool FactorizeStep(IpmRun* run);
  void SolveSystem(IpmRun* run, const Eigen::VectorXd& r, Eigen::VectorXd* x);
  // A df - dw = -defects (A f + b - w) and, on the rows C, w df + f dw = products.
  void Direction(IpmRun* run, double defects, const Eigen::VectorXd& products, Eigen::VectorXd* df,
                 Eigen::VectorXd* dw);
  // The target, in mu, of those shares of `most` that leaves the least mu behind the step df + target centre_df.
  double ChooseTarget(const ScaledSystem& system, double most) const;
  double MaxStep(const ScaledSystem& system, const Eigen::VectorXd& df, const Eigen::VectorXd& dw) const;
  void CorrectCentrality(IpmRun* run, double target_mu);

  Eigen::VectorXd f_, w_, df_, dw_, affine_df_, affine_dw_, trial_df_, trial_dw_;
  Eigen::VectorXd centre_df_, centre_dw_;  // the direction of products mu
  Eigen::VectorXd theta_, defect_, right_, correction_, product_;
  Eigen::VectorXd target_;  // w df + f dw of the direction df_, dw_
  double step_ = 0;
  double mu_ = 0;
  double residual_ = 0;
  int contacts_ = 0;
  int poor_steps_ = 0;
  bool refine_ = false;  // whether the present factor needs a refinement after every solve
};

}  // namespace lcpbench
