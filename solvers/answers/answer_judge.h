#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Judges candidates f of one solve by the problem's given form and keeps the best. Internal to solvers/. Only Reset
/// allocates.
class AnswerJudge {
 public:
  /// Up to this tier an answer is as good as rounding: no refinement or repair is worth while.
  static constexpr double kGoodEnough = 1e-13;

  /// O(nnz of A). @param dense  the form of A that backward errors are measured with, DenseA() or SparseA()
  void Reset(const LcpProblem& problem, bool dense);
  /// To be called before the first Start: b of the problem that was given to Reset, or of one that shares its matrix.
  void SetB(const LcpProblem& problem);
  /// Forgets the best; for a solve at `tolerance`.
  void Start(double tolerance);

  /// To be filled with the next candidate, in the problem's units and order.
  Eigen::VectorXd& candidate() { return f_; }
  /// Judges the candidate with a fresh w; if it is the best so far, result->f takes it over. True if it is good enough
  /// to stop.
  bool Publish(LcpResult* result);

  /// The smallest tier that the best candidate passes: max(rho, squared backward error). Infinite without one.
  double tier() const { return tier_; }
  /// w = A f + b of the best candidate, in the problem's units.
  const Eigen::VectorXd& w() const { return w_best_; }

 private:
  ResidualEstimate estimate_;
  GivenFormTest extended_;
  double tolerance_ = 0;
  double tier_ = std::numeric_limits<double>::infinity();
  Eigen::VectorXd f_, w_, w_best_;
};

/// A_ii = 0 makes row i of a PSD A zero: w_i = b_i whatever f is. If that is wrong by more than `threshold` in some
/// such row, +-e_i as a ray that VerifyFarkasRay accepts. O(n); allocates for a ray only. Internal to solvers/.
std::optional<Eigen::VectorXd> FindZeroRowRay(const LcpProblem& problem, double threshold);

}  // namespace lcpbench
