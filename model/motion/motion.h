#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/motion/contact_finder.h"
#include "model/motion/impact.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// What an LCP met on the way stands for. [docs/model.md sections 8, 9]
enum class MotionProblemKind {
  kAcceleration,  ///< w gap accelerations, f forces; b = J M^-1 F + gamma, without any stabilisation
  kImpact,        ///< w = J v+ + e J v-, f impulses
  kTimeStep,      ///< w = J v+ + d / h, f impulses
};

/// One LCP of a motion as the solver met it, together with its answer. References are valid during the call only.
struct MotionProblem {
  MotionProblemKind kind = MotionProblemKind::kAcceleration;
  double time = 0;  ///< [s]
  const ContactSystem& system;
  const std::vector<RowInfo>& rows;
  const LcpProblem& problem;
  const LcpResult& result;
};

/// Called once for every accepted step (at its beginning) and every impact; not for evaluations within a step. A time
/// step's problem that was found unsolvable comes with its ray before the relaxed one that was solved instead.
using MotionObserver = std::function<void(const MotionProblem&)>;

/// Why a motion stopped moving.
enum class MotionStatus {
  kMoving,
  kSolverFailed,  ///< no finite forces or impulses to go on with
  kPathEnd,       ///< a point came to an end of its path, or to a kink of it (path.h)
  kOverlap,       ///< bodies overlap deeper than the level can treat, and not by a contact that it followed
  kStalled,       ///< cannot advance: steps or bodies' displacements below the spacing of doubles, too many events
};

/// Counts and extremes since the motion began.
struct MotionStatistics {
  std::int64_t steps = 0;
  std::int64_t solves = 0;         ///< LCPs given to the solver
  std::int64_t failed_solves = 0;  ///< of these, not answered by kSolved: the motion went on with the best point given
  std::int64_t unsolvable = 0;     ///< of these, answered by kInfeasible
  std::int64_t impacts = 0;
  double worst_penetration = 0;  ///< deepest overlap of bodies met (overlap.h) [m], >= 0
  double worst_joint_error = 0;  ///< largest |d| of a bilateral row met [m]
  double solve_time_s = 0;       ///< in LcpSolver::Prepare and Solve, without the way to another process
};

/// eps_d of the acceleration level: gaps up to this are contacts [m]. What is nearer touches, and takes part in
/// impacts.
inline constexpr double kContactTolerance = 1e-6;

/// The deepest overlap that a motion takes [m]. At the acceleration level it is projected out before the motion begins,
/// and contacts found this deep are contacts still; what is deeper, and was not followed there from outside, is an
/// error of the positions.
/// @param width  the least of a movable body, 1 m where none has an outline [m]
double TreatedDepth(MotionLevel level, double width);

/// A solver does not take a problem, or gave forces or impulses that are not finite: the motion cannot go on.
struct NoFinitePoint {
  std::string detail;
};
/// @throws NoFinitePoint if the problem was refused, or its answer has no finite forces or impulses
void RequireFinite(const LcpProblem& problem, const LcpResult& result);

/// Hands LCPs to a solver and keeps the books of a motion: number of solves, failures, time. Failed solves go on with
/// the best point that the solver gives.
class CountedSolver {
 public:
  /// @param solver, statistics, check  must outlive this; check is called before every solve
  /// @param options  of every solve; initial_f is not read
  CountedSolver(LcpSolver& solver, const LcpOptions& options, MotionStatistics* statistics, const StopCheck& check)
      : solver_(solver), options_(options), statistics_(statistics), check_(check) {}

  /// @param initial_f  warm start, nullptr for a cold one; left out where its length does not fit
  void Solve(const LcpProblem& problem, const Eigen::VectorXd* initial_f, LcpResult* result);

 private:
  LcpSolver& solver_;
  LcpOptions options_;
  MotionStatistics* statistics_;
  const StopCheck& check_;
};

/// A world in motion under a solver. Not thread-safe; the solver must outlive it.
/// The same world, options, solver and build give the same bits, for as long as the motion goes.
class Motion {
 public:
  virtual ~Motion() = default;

  /// Moves on by `duration` [s], > 0 and finite, or until status() is not kMoving any more.
  /// @throws InputError for a duration that is not, and where geometry is singular (assembly.h, detection.h)
  void Advance(double duration);

  /// Now. Path joints on general curves and on paths have as s1, s2 where they are.
  const World& world() const { return world_; }
  double time() const { return time_; }  ///< [s] from the start
  MotionStatus status() const { return status_; }
  /// In words, where status() is not kMoving.
  const std::string& detail() const { return detail_; }
  const MotionStatistics& statistics() const { return statistics_; }
  void set_observer(MotionObserver observer) { observer_ = std::move(observer); }
  /// Called before every LCP and every search for contacts, and again and again in long ones. What it throws comes out
  /// of Advance, within a step: the motion must not go on then.
  void set_check(StopCheck check) { check_ = std::move(check); }

 protected:
  Motion(World world, const LcpOptions& lcp, LcpSolver& solver);

  /// @throws NoFinitePoint, which ends the motion as kSolverFailed
  virtual void Move(double duration) = 0;
  /// Notes the worst gaps of an instant in the statistics: of contacts how deep the outlines overlap there.
  void NoteGaps(const ContactSystem& system, const std::vector<RowInfo>& rows);
  /// Ends the motion as kOverlap.
  void End(const BodyOverlap& overlap);
  /// The same where bodies overlap untreatably (ContactFinder::FindUntreatable). Looks for it as often as bodies may
  /// have gone deeper by a part of what is treated.
  /// @param step     bodies moved for so long at velocities of up to their present ones [s]
  /// @param treated  the depth to which contacts are found [m]
  void EndIfUntreatable(double step, double treated);
  /// Ends the motion as kStalled.
  void Stall(const std::string& why);
  /// The same, and false, where steps of that length are below the spacing of doubles before `duration` is over.
  bool CanAdvance(double duration, double step);
  /// The same where a movable body did not move in `step` [s] although both its velocities, before and now, move it by
  /// more than `least` [m]: doubles are too coarse where it is.
  void RequireAdvance(std::span<const Body> before, double step, double least);
  /// Solves impacts' LCPs from a cold start; what it throws is NoFinitePoint.
  /// @param observed  they are shown to the observer
  ImpulseSolver Impulses(bool observed);
  void Observe(MotionProblemKind kind, const ContactSystem& system, const std::vector<RowInfo>& rows,
               const LcpProblem& problem, const LcpResult& result) const {
    if (observer_) observer_({kind, time_, system, rows, problem, result});
  }

  World world_;
  double time_ = 0;
  MotionStatus status_ = MotionStatus::kMoving;
  std::string detail_;
  MotionStatistics statistics_;
  StopCheck check_ = [] {};
  CountedSolver solver_;
  ContactFinder finder_;
  MotionObserver observer_;

 private:
  double approached_ = 0;  // since overlaps were looked for [m]
};

/// "acceleration" or "velocity".
std::string_view ToString(MotionLevel level);
/// @throws InputError naming the known levels
MotionLevel MotionLevelFromString(std::string_view key);

/// "acceleration", "impact" or "time_step".
std::string_view ToString(MotionProblemKind kind);

}  // namespace lcpbench
