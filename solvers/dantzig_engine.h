#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>

#include "solvers/active_set.h"
#include "solvers/dantzig.h"
#include "solvers/lcp/residual.h"

namespace lcpbench {

/// The workings of DantzigSolver, shared by dantzig.cc (a solve from loading to the final judgement) and
/// dantzig_drive.cc (the driving of one row); no part of the interface.
///
/// Positions: F = [0, m), of which [0, joints) are bilateral; watched rows [m, q) with f = 0, w >= 0; the driven row q
// and the waiting rows behind it, [q, open); then rows out of play: dependent bilateral rows and stuck ones.
class DantzigSolver::Engine {
 public:
  explicit Engine(DantzigOptions options) : options_(options) {}

  void Reserve(Index max_rows);
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpOptions& options, LcpResult* result);

 private:
  static constexpr Index kNoRow = -1;
  // A value is rounding only up to this multiple of the sum of magnitudes that it was computed from.
  static constexpr double kNoise = 64 * std::numeric_limits<double>::epsilon();

  enum class End { kDone, kStuck, kInfeasible, kNotMet, kIterationLimit, kTimeLimit };
  struct Blocking {
    Index row = kNoRow;
    double step = 0;
  };

  End Run(LcpResult* result);
  bool FindZeroRowRay(LcpResult* result);
  End EnterJoints(LcpResult* result);
  End EnterWarmRows();
  End DriveAll(LcpResult* result);
  End Drive(LcpResult* result);
  Blocking FindBlocking(double s, double norm2, bool singular, bool least_index) const;
  void Advance(double step, double s, bool singular);
  void Retreat(double norm2);
  double NoiseAlongDirection() const;
  bool IsSmall(Index p, double norm2) const;
  bool ClaimRay(Index d, double sign, LcpResult* result);

  // How rows without business in F leave it. All at once is cheap, but a row may have been judged beside one that was
  // itself only rounding: repairs let them go one by one, the worst first, and solve anew in between.
  enum class Leaving { kAll, kAllAndTiny, kOneByOne };
  enum class Surplus { kNone, kNegative, kTiny, kRounding };
  Surplus FindSurplus(Index p, double largest, bool judge_by_size) const;
  bool SolveForces(Leaving leaving);
  void Release(Index p);
  bool FindViolations();
  template <typename Real>
  void ComputeWByFactors(const Eigen::VectorXd& f, Eigen::Matrix<Real, Eigen::Dynamic, 1>* body,
                         Eigen::VectorXd* w) const;
  bool Publish(LcpResult* result);
  void Refine();

  bool TimeIsUp(Index work);
  Index m() const { return active_.size(); }
  Index rates_end() const { return options_.order == DantzigOrder::kIndex ? q_ : open_; }

  const DantzigOptions options_;
  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  ResidualEstimate estimate_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;  // residuals up to this are not worth a proof of infeasibility
  const Eigen::VectorXd* initial_f_ = nullptr;
  std::optional<Deadline> deadline_;
  Index work_left_ = 0;
  std::int64_t pivots_ = 0;
  std::int64_t pivot_limit_ = 0;
  double rank_tolerance_ = 0;
  double tier_ = 0;  // smallest tier that the published f passes: max(rho, backward error^2)

  // State.
  ActiveSet active_;
  PermutedLcp& lcp_ = active_.lcp;
  Index joints_ = 0;
  Index q_ = 0;
  Index open_ = 0;
  Eigen::VectorXd dw_;  // rates of w along the direction, by position
  Eigen::VectorXd f_trial_, w_trial_, w_best_;
  Eigen::VectorXd body_;  // a value per column of J
  Eigen::Matrix<long double, Eigen::Dynamic, 1> body_extended_;
};

}  // namespace lcpbench
