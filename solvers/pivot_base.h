#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>

#include "solvers/active_set.h"
#include "solvers/answer_judge.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// What dense pivoting methods with an updated factor of the active rows have in common, whatever their rule for the
/// next pivot: joints first, a rank rule, warm start, refinement with the given form, rays. Internal to solvers/.
///
/// Positions of the permuted problem: F = [0, m), of which [0, joints) are bilateral; rows in play with f = 0
/// [m, open); then rows out of play (dependent bilateral rows, rows set aside). Only Reserve and Prepare allocate, and
/// ClaimRay for its ray.
class PivotBase {
 public:
  void Reserve(Index max_rows);
  void Prepare(const LcpProblem& problem);

 protected:
  static constexpr Index kNoRow = -1;
  /// A value is rounding only up to this multiple of the sum of magnitudes that it was computed from.
  static constexpr double kNoise = 64 * std::numeric_limits<double>::epsilon();

  enum class End { kDone, kInfeasible, kNotMet, kIterationLimit, kTimeLimit };

  /// Reads the options of one call; `pivot_limit` is used where they name none.
  void Start(const LcpOptions& options, std::int64_t pivot_limit);
  /// Loads the problem anew with nothing active. False: an A_ii < 0.
  bool Load(double rank_tolerance);
  /// Bilateral rows enter and stay. A dependent one has w = y.b for every f: it is right and out of play, or proved
  /// impossible (kInfeasible).
  End EnterJoints(LcpResult* result);
  /// Unilateral rows with initial_f_i > 0 relative to the largest (in units of D^-1/2) enter where independent.
  End EnterWarmRows();

  /// f_F = -A_FF^-1 b_F; unilateral rows with f < 0, or f > 0 by rounding only, leave, the worst first, and f is solved
  /// for anew in between; all of them at once where `at_once`.
  void SolveForces(bool at_once);
  /// w of all rows in play outside F, with f = 0 there; within rounding of 0 counts as 0. Returns the largest
  /// -w_i / GapRoot(i), 0 where no row is violated.
  double ComputeGaps();
  void Release(Index p);
  /// Judges f; true if it is good enough to stop.
  bool Publish(LcpResult* result);
  /// One step of iterative refinement with the residual of the given form at the published f.
  void Refine();
  /// y = sign (df_F, 1 at d) as a Farkas ray, refined with extended-precision residuals until VerifyFarkasRay accepts
  /// it, at most a few times.
  bool ClaimRay(Index d, double sign, LcpResult* result);

  bool TimeIsUp(Index work);
  Index m() const { return active_.size(); }
  /// Forces f_p and gaps w_p of different rows compare as f_p ForceRoot(p) and w_p / GapRoot(p): sqrt(A_pp) in units of
  /// one row's, because sqrt(A_pp) itself is rounded differently when A is multiplied by 2.
  double ForceRoot(Index p) const { return root_[RowAt(p)]; }
  double GapRoot(Index p) const { return root_[RowAt(p)] * unit_; }
  Index RowAt(Index p) const { return lcp_.row[static_cast<size_t>(p)]; }

  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  AnswerJudge judge_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;  // residuals up to this are not worth a proof of infeasibility
  const Eigen::VectorXd* initial_f_ = nullptr;
  std::optional<Deadline> deadline_;
  Index work_left_ = 0;
  std::int64_t pivots_ = 0;
  std::int64_t pivot_limit_ = 0;
  double rank_tolerance_ = 0;

  // State.
  ActiveSet active_;
  PermutedLcp& lcp_ = active_.lcp;
  Index joints_ = 0;
  Index open_ = 0;
  double unit_ = 1;       // A_pp of the row that came first
  Eigen::VectorXd root_;  // by row of the problem
};

}  // namespace lcpbench
