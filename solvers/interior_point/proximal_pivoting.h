#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "solvers/interior_point/ipm_run.h"

namespace lcpbench {

/// Block principal pivoting inside a proximal-point loop, in scaled variables: for fixed c, the problem with A + eps I
/// and b - eps c has a positive definite matrix, so pivoting with Murty's least-index rule as a safeguard is finite
/// [Judice, Pires 1994; Murty 1974]; c <- its solution converges to a solution of the problem itself for PSD A
/// [Rockafellar 1976]. Bilateral rows are always in F. One active set costs one factorisation.
class ProximalPivoting {
 public:
  enum class Outcome {
    kSolved,      ///< run->best_f() meets the tier
    kInfeasible,  ///< ray() is accepted
    kGaveUp,      ///< the budget is spent, or rounding prevents progress
    kStopped,     ///< a limit
  };

  void Reserve(Index n);

  /// How long pivots go on.
  struct Budget {
    int pivots;  ///< active sets to try
    /// A pivot ends it that leaves more than this fraction of the least number of wrong rows before it ...
    double progress = std::numeric_limits<double>::infinity();
    double most_wrong = 1;  ///< ... as does the first set with more than this fraction of all rows wrong, ...
    double few_wrong = 0;   ///< ... unless at most this fraction is left
  };

  /// From F = {f > w} and c = f.
  /// @param weight  eps to start with, if above the solver's own. An F that is wrong by a residual r moves f by
  ///     r / eps, so with eps about the residual of f the pivots stay near f even where A_FF is singular; eps then
  ///     falls with the residual, as in regularised Newton methods [Qi, Sun 1993; Facchinei, Pang 2003]
  Outcome Run(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w, const Budget& budget, double weight);

  /// Projects the growth direction on the null space of A over its support, and has VerifyFarkasRay judge it.
  /// Restricted to the component where it is largest: noise of the others would spoil the proof.
  bool TryRay(IpmRun* run, const Eigen::VectorXd& direction);
  /// In the problem's units.
  const Eigen::VectorXd& ray() const { return ray_; }

 private:
  bool Factorize(IpmRun* run);
  // x_ = the solution of the proximal problem on F; gap_ = its gaps.
  void SolveOnActiveSet(IpmRun* run);
  void ProximalGaps(IpmRun* run);
  // Proximal-point iterations on A_FF f_F = -b_F from x_; true if one of them is accepted.
  bool Polish(IpmRun* run);
  // After acceptance with a heavy eps: the same active set once more with the light one, kept if it is better.
  void Sharpen(IpmRun* run);
  bool AcceptClipped(IpmRun* run);
  // For forces_ that meet rho but not the componentwise measure, which then fails in rows where all terms are tiny.
  bool RepairTinyRows(IpmRun* run);
  // Rows that violate the proximal problem; their number is returned, they are marked in wrong_.
  Index FindWrongRows(const ScaledSystem& system);
  void Flip(const ScaledSystem& system, bool all);

  std::vector<char> active_, wrong_;
  Eigen::VectorXd center_, x_, gap_, polished_, right_, correction_, theta_, forces_, gaps_, ray_, snapped_;
  double weight_ = 0;  // eps
};

}  // namespace lcpbench
