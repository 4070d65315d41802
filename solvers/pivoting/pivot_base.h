#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/pivoting/complementary_basis.h"
#include "solvers/pivoting/pivot_options.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/row_input.h"

namespace lcpbench {

/// What dense pivoting methods with an updated factor of the active rows have in common, whatever their rule for the
/// next pivot: joints first, a rank rule with restarts, warm start, refinement with the given form, rays, and how a
/// solve ends. Internal to solvers/.
///
/// Positions of the permuted problem: F = [0, m), of which [0, joints) are bilateral; rows in play with f = 0
/// [m, open); then rows out of play (dependent bilateral rows, rows set aside). Only Reserve and Prepare allocate, and
/// ClaimRay for its ray.
class PivotBase : public RowEngine {
 public:
  /// @param rule  by which SolveArrays pivots on a tableau, without a limit of iterations; empty: it does not
  PivotBase(const PivotOptions& options, std::optional<TableauRule> rule);

  /// Refuses A that is not numerically symmetric, and more than max_rows rows.
  std::string WhyUnsupported(const LcpProblem& problem) const;

  virtual void Reserve(Index max_rows);
  void Prepare(const LcpProblem& problem);
  /// Runs the method with the rank tolerance, then, where that met neither the tolerance nor a proof, with a finer and
  /// a coarser one, from nothing active and without blocks.
  /// `problem` shares its matrix with the prepared one.
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 protected:
  static constexpr Index kNoRow = -1;
  /// A value is rounding only up to this multiple of the sum of magnitudes that it was computed from.
  static constexpr double kNoise = 64 * std::numeric_limits<double>::epsilon();

  /// kStuck: a row can be neither made right nor proved impossible, for the method's own use.
  enum class End { kDone, kStuck, kInfeasible, kNotMet, kIterationLimit, kTimeLimit };

  /// For MakeRight: the rows in play outside F that are violated. False if there are none.
  /// @param round  of repair; 0: the first, after EnterStart
  virtual bool FindViolations(int round) = 0;
  /// The method itself: ends with no row violated but by rounding, or otherwise than kDone.
  virtual End MakeRight(LcpResult* result) = 0;

  /// A start for the method: f_F >= 0 on unilateral rows.
  ///
  /// Bilateral rows enter and stay, and unilateral rows with initial_f_i > 0 (PermutedLcp::kGuessThreshold), without
  /// initial_f those with b_i < 0 if there is a block start, enter where clearly independent; all in one factorization
  /// unless bilateral rows may be dependent. A dependent one has w = y.b for every f: it is right and out of play, or
  /// proved impossible (kInfeasible). Then unilateral rows with f < 0 leave until there is none. With a block start all
  /// rows with w < 0 enter next, where clearly independent, and so on while their number falls.
  ///
  /// Each such block is one pivot; the first one is free.
  End EnterStart(LcpResult* result);
  /// w of all rows in play outside F, with f = 0 there; those with w < 0 beyond rounding move behind the others, whose
  /// w < 0 becomes 0. Returns the position of the first of them, open_ if there is none; also where time runs out.
  Index SetViolatedApart();

  /// How rows that do not belong in F leave it. All at once is cheap, but a row may have been judged beside one that
  /// was itself only rounding: repairs let them go one by one, the worst first, and solve anew in between.
  enum class Leaving { kAll, kOneByOne };
  /// f_F = -A_FF^-1 b_F, unless F has not changed since; unilateral rows with f < 0, or f > 0 by rounding only, leave
  /// until there is none. Where time runs out F is empty and TimeIsUp says so.
  void SolveForces(Leaving leaving);
  void Release(Index p);
  /// Judges f; true if it is good enough to stop. Without self-check true, unjudged.
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
  double ForceRoot(Index p) const { return std::sqrt(lcp_.diagonal[p] / unit_); }
  double GapRoot(Index p) const { return ForceRoot(p) * unit_; }
  Index RowAt(Index p) const { return lcp_.row[static_cast<size_t>(p)]; }

  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  AnswerJudge judge_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;  // residuals up to this are not worth a proof of infeasibility
  PermutedLcp::Guess guess_;    // for the first attempt
  std::optional<Deadline> deadline_;
  Index work_left_ = 0;
  std::int64_t pivots_ = 0;
  std::int64_t pivot_limit_ = 0;
  double rank_tolerance_ = 0;

  // State.
  ComplementaryBasis active_;
  PermutedLcp& lcp_ = active_.lcp;
  Index joints_ = 0;
  Index open_ = 0;
  Index violated_ = 0;  // after EnterStart: [m, violated) have w >= 0
  double unit_ = 1;     // A_pp of the row that came first

 private:
  bool SolveRows(const RowTask& task, LcpResult* result) override;
  void Start(const LcpOptions& options);
  PermutedLcp::Loaded Load(const PermutedLcp::Guess& guess);
  bool MayBeWrong() const;
  End EnterJoints(LcpResult* result);
  void LeaveOutStrongest(Index p);
  End Attempt(LcpResult* result);
  End EnterBlocks(double least_pivot);
  void ReleaseAll();
  void DropTinyForces(LcpResult* result);
  void GiveForces(Eigen::VectorXd* f) const;
  const Deadline* deadline() const { return deadline_.has_value() ? &*deadline_ : nullptr; }
  bool IsSurplus(Index p, double largest) const;

  const PivotOptions pivot_options_;
  std::optional<SmallPivoting> tableau_;
  bool blocks_ = false;  // in this attempt
  bool out_of_time_ = false;
  std::int64_t solved_at_ = -1;  // pivots_ when SolveForces left F and f as they are; -1: not so
  double largest_ = 0;           // A_ii f_i^2 then
  std::vector<Index> surplus_;   // positions, descending
};

}  // namespace lcpbench
