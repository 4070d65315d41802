#pragma once

#include <functional>
#include <string>

#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/motions/scene_source.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

// Problems of scenes in motion: the LCP of a time step of VelocityMotion, whatever the family's own level, h and e
// being the family's. The motion is driven by SweepSolver, as engines drive theirs, so that it can be followed at any
// size and has the same bits on every machine.

/// Projected Gauss-Seidel sweeps over J and M^-1, forwards and backwards in turn, started warm: until no force changes
/// by more than kChange of the largest load, at most kMostSweeps. A friction row is clamped to the bounds of the
/// moment. Scalar arithmetic in a fixed order, compiled as the model is: the same bits on every x86-64 machine. What is
/// left over is what engines leave, undone by the next steps' depth terms.
class SweepSolver final : public LcpSolver {
 public:
  static constexpr double kChange = 1e-8;
  static constexpr int kMostSweeps = 200;

  std::string WhyUnsupported(const LcpProblem& problem) const override;
  bool TakesFriction() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem&) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;
};

/// Lets a scene move until `handle` returns false, and at most `steps` steps of its own length. Of the acceleration
/// problems of a step the first one is handled: how many steps the integrator takes in between is its own matter.
/// Impacts and time steps are handled all.
/// @return "" or why the motion ended before its time
std::string FollowScene(const MovingScene& scene, LcpSolver& solver, int steps,
                        const std::function<bool(const MotionProblem& met)>& handle);

/// Lets a scene move under forces from exact arithmetic, rounded once (exact_solver.h), or with friction, where exact
/// answers need not exist and cost seconds, by SweepSolver; so that the problems met have the same bits on every
/// machine. Calls `handle` with every problem that SequenceWriter would write: of a step's
/// acceleration problems the first, impacts and time steps all. The problem is given an id of its own,
/// "<scene>-n<rows>-s<seed>-motion-<number from 0>".
/// @param start  its changes are none
/// @return "" or why the motion ended before its time
/// @throws InputError as StartScene
std::string ForEachSequenceProblem(
    const Recipe& start, int steps,
    const std::function<void(const LcpProblem& problem, const MotionProblem& met)>& handle);

/// One time step of a motion.
struct MotionStep {
  int number = 0;  ///< from 1
  /// Unilateral rows with a force whose contact had none in the step before, or was not there, since the start: how
  /// often contacts have closed.
  std::int64_t closings = 0;
  Instance instance;  ///< its id is that of the recipe with this step
};

/// FollowScene for a recipe's scene at the velocity level, driven by SweepSolver.
/// @param start  neither changes nor a step
/// @throws InputError as StartScene
std::string FollowMotion(const Recipe& start, int steps, const std::function<bool(const MotionStep& step)>& handle);

/// When a motion's problems are taken: the first at the first step from kSettled on by which contacts have closed
/// max(1, rows / 4) times, at kLatestStep at the latest; every further one kStepsBetween after the one before.
inline constexpr int kSettled = 40;
inline constexpr int kLatestStep = 100;
inline constexpr int kStepsBetween = 40;
/// Where a problem is refused, so many steps after it are tried.
inline constexpr int kStepsTried = 5;
/// Steps with fewer or more rows are refused.
inline constexpr Index kLeastMotionRows = 40;
inline constexpr Index kMostMotionRows = 2000;

/// Takes `count` problems of a motion, by the rule above.
/// @param accept  called with every candidate, refuses by returning false
void TakeSteps(const Recipe& start, int count, const std::function<bool(const MotionStep& step)>& accept);

/// The problem of recipe.motion_step.
/// @throws InputError where the motion ends before, and as above
Instance MakeMotionStep(const Recipe& recipe);

}  // namespace lcpbench
