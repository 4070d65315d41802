#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lemke.h"
#include "solvers/pivot_base.h"

namespace lcpbench {

/// The workings of LemkeSolver, shared by lemke.cc (a solve from loading to the final judgement) and lemke_path.cc (one
/// path of falling z); no part of the interface.
class LemkeSolver::Engine final : public PivotBase {
 public:
  explicit Engine(LemkeOptions options) : PivotBase(options.rank_tolerance, options.block_start, options.self_check) {}

  void Reserve(Index max_rows) override;

 private:
  End Run(LcpResult* result) override;

  // From z = 1 to z = 0, starting at F with f_F >= 0 and gaps no less than -violation sqrt(A_ii).
  End FollowPath(double violation, LcpResult* result);
  void SetCover(double violation);
  void SetPerturbation();
  double ComputeRates();
  double Noise(Index p) const;
  bool IsRounding(Index p, double rate, double size) const;
  Index NextEvent(double size, double* step);
  Index NextLeaving(Index entering, double norm2, double* step);
  Index BreakTie(const Eigen::VectorXd& rate, Index event);
  void ComputePerturbation(Index k);
  End EnterOrExchange(Index p, LcpResult* result);

  double z_ = 0;
  double largest_force_ = 0;      // D^1/2 f, over the path so far
  Eigen::VectorXd cover_;         // d, by row of the problem
  Eigen::VectorXd perturbation_;  // g, by row of the problem
  Eigen::VectorXd rate_;          // by position, per unit of falling z: of f in F, of w outside
  Eigen::VectorXd y_;             // by position, the direction of an exchange in F
  Eigen::VectorXd first_order_;   // by position: what one column of the perturbation does to f in F and w outside
  Eigen::VectorXd work_;
  std::vector<Index> ties_;  // positions
};

}  // namespace lcpbench
