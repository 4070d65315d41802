#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The vectors of an LCP in scaled units, by row of the problem: S A S, S b / t, S^-1 f / t with S = diag(scale) and
/// t = b_unit, for methods that leave A to an ActiveBlock. Internal to solvers/.
///
/// Load takes powers of two: S_ii that bring A_ii into [1, 4), and one t that brings the largest |b_i| into [1, 2), as
/// PermutedLcp; nothing is rounded. ScaledSystem takes S = D^-1/2 and a t for each part of A that nothing connects.
/// Rows with A_ii = 0 neither act nor are judged: b_i = 0, A_ii = 1 there, and FindZeroRowRay looks at them.
struct ScaledVectors {
  /// Allocates, and reads the bounds.
  void Reset(const LcpProblem& problem);
  /// False, half loaded, if an A_ii < 0.  O(n)
  bool Load(const LcpProblem& problem);

  bool is_joint(Eigen::Index i) const { return bilateral[static_cast<size_t>(i)] != 0; }
  bool acts(Eigen::Index i) const { return can_act[static_cast<size_t>(i)] != 0; }
  /// rho of forces f and w = A f + b.  O(n)
  double Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;

  double GivenForce(Eigen::Index i, double f) const { return f * (scale[i] * b_unit[i]); }
  double GivenGap(Eigen::Index i, double w) const { return w * (b_unit[i] / scale[i]); }
  double ScaledGap(Eigen::Index i, double given) const { return given / (b_unit[i] / scale[i]); }
  /// Of any forces f in given units: f >= 0 but for joints, and 0 for rows that do not act.
  void Clip(const Eigen::VectorXd& given, Eigen::VectorXd* f) const;

  Eigen::VectorXd scale, diagonal, b, b_unit;
  std::vector<char> can_act;  ///< takes part, with A_ii > 0
  std::vector<char> bilateral;
  double b_norm = 1;  ///< |D^-1/2 b|_2 in given units, D_ii = 1 where A_ii = 0; 1 when b = 0
};

}  // namespace lcpbench
