#pragma once

#include <Eigen/Core>
#include <optional>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// rho and backward error in double, for solvers that stop when a tier is met. Same formulas as metrics in verify.h,
/// but a working estimate: the verdict is always verify.h's. Allocates in Reset only.
class ResidualEstimate {
 public:
  /// O(nnz of A). Reads the form of A named by `dense` (so that a solver does not make a second form by asking).
  void Reset(const LcpProblem& problem, bool dense);

  /// rho at f with w = A f + b given.  O(n).
  double Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

  /// Largest backward error at f, w.  O(nnz of A).
  double BackwardError(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

  /// Whether (f, w) meets tier `tolerance`: rho <= tolerance and, only then evaluated, backward error <=
  /// sqrt(tolerance).
  bool Meets(double tolerance, const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

 private:
  std::optional<LcpProblem> problem_;  // shares storage, so that the caller's object may go away
  bool dense_ = false;
  Eigen::VectorXd root_;   // D^1/2
  Eigen::VectorXd force_;  // A_ii
  double b_norm_ = 0;      // |D^-1/2 b|_2, or 1 when b = 0
  Eigen::Array<bool, Eigen::Dynamic, 1> bilateral_;
};

/// rho at f by the given form, for a single answer: no form of A is made.  O(nnz of the given form).
double RhoByGivenForm(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
