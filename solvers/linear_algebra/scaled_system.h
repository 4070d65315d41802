#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/linear_algebra/body_space.h"
#include "solvers/linear_algebra/cholmod_factor.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/linear_algebra/scaled_lcp.h"

namespace lcpbench {

/// The linear algebra below the `ipm` solver: an LcpProblem in scaled variables, and solves with
/// A^ + diag(theta) on one symbolic analysis.
///
/// Scaled variables: A^ = S A S with S = D^-1/2, D = diag A, so that A^ has a unit diagonal; rows that A couples,
/// directly or not, form a component c, and all of b and f in it are divided by beta_c = max |S b|. So
///     f_i = s_i beta_c f^_i,   w_i = beta_c w^_i / s_i,   w^ = A^ f^ + b^,   max |b^| = 1 in every live component.
/// Neither row scaling nor a scaling of A or b (of one component alone, too) is seen in scaled variables.
///
/// Idle rows have f = 0 and take no part: rows of components that f = 0 solves, and rows with A_ii = 0.
class ScaledSystem {
 public:
  enum class Space {
    kAutomatic,  ///< the one of less predicted work
    kContact,    ///< factorizes A^ + diag(theta), n x n
    kBody,       ///< factorizes I + J^^T diag(1 / theta) J^ on the bodies (BodySpace)
  };

  /// Scales, finds components, chooses the space and analyses. O(nnz) and the analysis.
  /// kBody needs BodySpace::Suits(problem); otherwise it means kContact.
  /// Reads no b.
  void Prepare(const LcpProblem& problem, Space space);
  /// b of the prepared problem, or of one that shares its matrix: scales b, finds idle rows. To be called before all
  /// that follows.  O(n)
  void SetB(const LcpProblem& problem);

  /// The problem of SetB (a copy that shares storage).
  const LcpProblem& problem() const { return *problem_; }
  Index size() const { return rows_.b.size(); }
  /// Scales, b^, and which rows take part.
  const ScaledVectors& rows() const { return rows_; }
  bool idle(Index i) const { return !rows_.acts(i); }
  bool unilateral(Index i) const { return rows_.acts(i) && !rows_.is_joint(i); }
  const Eigen::VectorXd& b() const { return rows_.b; }

  /// y = A^ x, O(nnz) of the chosen space.
  void Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const;

  /// Numeric factorization of A^ + diag(theta); rows with theta = kOut are left out (x_i = 0 there to rounding), as are
  /// idle rows whatever their theta.
  bool Factorize(const Eigen::VectorXd& theta);
  const std::string& why() const { return body_space_ ? bodies_.why() : factor_.why(); }
  /// x = (A^ + diag(theta))^-1 r.
  void Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x);

  bool in_body_space() const { return body_space_; }
  /// Symbolic, of the latest Prepare; 0 where those of the problem before are kept, as in a sequence of one pattern.
  int analyses() const { return analyses_; }
  double fill() const { return factor().fill(); }
  double flops() const { return factor().flops(); }

  /// A pivot so large that its row neither moves nor moves others: 1 / kOut is far below the rounding of a unit
  /// diagonal.
  static constexpr double kOut = BodySpace::kOut;

 private:
  const CholmodFactor& factor() const { return body_space_ ? bodies_.factor() : factor_; }
  void ScaleRows();
  void BuildContactSpace();
  void BuildBodySpace();
  bool ChooseBodySpace(Space space, double contact_entries);

  std::optional<LcpProblem> problem_;
  ScaledVectors rows_;
  Islands parts_;
  Eigen::VectorXd pivots_;  // theta, kOut at idle rows
  SparseMatrix scaled_A_;
  CholmodFactor factor_;  // of contact space
  BodySpace bodies_;
  bool body_space_ = false;
  int analyses_ = 0;
};

}  // namespace lcpbench
