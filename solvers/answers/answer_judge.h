#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where candidate answers go, in the problem's units and order.
class AnswerSink {
 public:
  virtual ~AnswerSink() = default;
  /// To be filled with the next candidate, n numbers.
  virtual Eigen::VectorXd& candidate() = 0;
  /// Judges the candidate, keeps the best one. True if the best is good enough to stop.
  virtual bool Publish() = 0;
  /// The smallest tier that the best one passes: max(rho, squared backward error). Infinite without one.
  virtual double tier() const = 0;
  /// An estimate of the latest candidate's rho; 0 where there is none.
  virtual double rho() const { return 0; }
};

/// Judges candidates f of one solve by the problem's given form. Internal to solvers/. Only Reset allocates.
class AnswerJudge final : public AnswerSink {
 public:
  /// Up to this tier an answer is as good as rounding: no refinement or repair is worth while.
  static constexpr double kGoodEnough = 1e-13;

  /// O(nnz of A). @param dense  the form of A that backward errors are measured with, DenseA() or SparseA()
  void Reset(const LcpProblem& problem, bool dense);
  /// Forgets the best; for a solve at `tolerance` of the problem that was given to Reset, or of one that shares its
  /// matrix.
  /// @param result  its f takes over the best candidate
  void Start(const LcpProblem& problem, double tolerance, LcpResult* result);

  Eigen::VectorXd& candidate() override { return f_; }
  bool Publish() override;
  double tier() const override { return tier_; }
  /// w = A f + b of the best candidate, in the problem's units.
  const Eigen::VectorXd& w() const { return w_best_; }

 private:
  ResidualEstimate estimate_;
  GivenFormTest extended_;
  LcpResult* result_ = nullptr;
  double tolerance_ = 0;
  double tier_ = std::numeric_limits<double>::infinity();
  Eigen::VectorXd f_, w_, w_best_;
};

/// A_ii = 0 makes row i of a PSD A zero: w_i = b_i whatever f is. If that is wrong by more than `threshold` in some
/// such row, +-e_i as a ray that VerifyFarkasRay accepts. O(n); allocates for a ray only. Internal to solvers/.
std::optional<Eigen::VectorXd> FindZeroRowRay(const LcpProblem& problem, double threshold);

/// A direction found in doubles as a Farkas ray that VerifyFarkasRay accepts: as it is, or without entries that are
/// rounding of zeros; where that is a ray within rounding only, with entries of a few digits if this is a proof (ratios
/// of small whole numbers are frequent). Nothing where it is not accepted.  Up to six calls of VerifyFarkasRay;
/// allocates. Internal to solvers/.
/// @param direction  n numbers
std::optional<Eigen::VectorXd> AcceptedRay(const LcpProblem& problem, const Eigen::VectorXd& direction);

}  // namespace lcpbench
