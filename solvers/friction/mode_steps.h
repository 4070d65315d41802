#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/first_order/contact_sweeps.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_factor.h"

/// Internal to solvers/.
namespace lcpbench {

/// The method of mode-newton by itself, see mode_newton.h.
class ModeSteps {
 public:
  /// How far a run goes.
  struct Limits {
    int steps = 200;
    double eps = 1e-6;  ///< at first
    int sweeps = 0;     ///< where a step fails; 0: eps grows instead, and eight times ends the run
  };
  /// Forgets the matrix: the next run may be for another problem.
  void Reset() { sweeps_are_ready_ = false; }
  /// True where an answer passes. *phi: where to start from; the last iterate afterwards.
  bool Run(const ContactRows& rows, const Limits& limits, Eigen::VectorXd* phi, FrictionAnswer* answer);
  /// Proximal points: each solves the problem of A + eps about the last, eps not small, by Newton steps with a line
  /// search on the residual of that problem. Slower and surer than Run. True where an answer passes.
  bool Approach(const ContactRows& rows, int points, Eigen::VectorXd* phi, FrictionAnswer* answer);
  /// Solves the modes of *phi with a vanishing eps, a few times. True where an answer passes.
  bool Polish(const ContactRows& rows, const Eigen::VectorXd& phi, FrictionAnswer* answer);
  /// Up to `count` sweeps from *phi. True where an answer passes.
  bool Sweep(const ContactRows& rows, int count, Eigen::VectorXd* phi, FrictionAnswer* answer);

 private:
  int FindProximalPoint(const ContactRows& rows, double eps, double wanted, double* rho, Eigen::VectorXd* phi,
                        FrictionAnswer* answer);
  bool Refine(const ContactRows& rows, const Eigen::VectorXd& phi, FrictionAnswer* answer);
  bool TryStep(const ContactRows& rows, double rho, Eigen::VectorXd* phi, double* next);

  ModeFactor factor_;
  ContactSweeps sweeps_;
  bool sweeps_are_ready_ = false;
  std::vector<RowMode> modes_;
  Eigen::VectorXd gaps_, next_, trial_, center_, f_;
};

}  // namespace lcpbench
