#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The vectors of an LCP in the scaling of PermutedLcp, by row of the problem: S A S, t S b, t S^-1 f with powers of
/// two S_ii that bring A_ii into [1, 4) and t that brings the largest |b_i| into [1, 2); nothing is rounded. For
/// methods that leave A to an ActiveBlock. Rows with A_ii = 0 neither act nor are judged: b_i = 0, A_ii = 1 there, and
/// FindZeroRowRay looks at them. Internal to solvers/.
struct ScaledVectors {
  /// Allocates, and reads the bounds.
  void Reset(const LcpProblem& problem);
  /// False, half loaded, if an A_ii < 0.  O(n)
  bool Load(const LcpProblem& problem);

  bool is_joint(Eigen::Index i) const { return bilateral[static_cast<size_t>(i)] != 0; }
  bool acts(Eigen::Index i) const { return can_act[static_cast<size_t>(i)] != 0; }
  /// rho, times b_norm b_scale, of forces f and w = A f + b.  O(n)
  double Residual(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

  double GivenForce(Eigen::Index i, double f) const { return f * (scale[i] / b_scale); }
  double ScaledForce(Eigen::Index i, double given) const { return given * b_scale / scale[i]; }

  Eigen::VectorXd scale, diagonal, b;
  std::vector<char> can_act;  ///< A_ii > 0
  std::vector<char> bilateral;
  double b_scale = 1;  ///< t
  double b_norm = 1;   ///< |D^-1/2 b|_2 in given units, D_ii = 1 where A_ii = 0; 1 when b = 0
};

}  // namespace lcpbench
