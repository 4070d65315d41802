#include "benchmarks/collection/recipes/motion_steps.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/motion/contact_finder.h"
#include "solvers/exact/exact_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// How often contacts have closed.
class ClosingCount {
 public:
  void Follow(const MotionProblem& met) {
    const std::vector<std::optional<int>> before = matching_.Follow(met.system, met.rows);
    std::vector<bool> loaded(met.rows.size());
    for (std::size_t i = 0; i < loaded.size(); ++i) {
      loaded[i] = !met.rows[i].bilateral && met.result.f[static_cast<Index>(i)] > 0;
      const bool was_loaded = before[i].has_value() && loaded_[static_cast<std::size_t>(*before[i])];
      if (loaded[i] && !was_loaded && !first_) ++count_;
    }
    loaded_ = std::move(loaded);
    first_ = false;
  }
  std::int64_t count() const { return count_; }

 private:
  RowMatching matching_;
  std::vector<bool> loaded_;
  bool first_ = true;
  std::int64_t count_ = 0;
};

}  // namespace

std::string SweepSolver::WhyUnsupported(const LcpProblem& problem) const {
  return problem.has_factors() ? "" : "not given by factors";
}

void SweepSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const Eigen::VectorXd& D = problem.DiagonalA();
  const Index n = problem.size();
  std::vector<double> v(static_cast<std::size_t>(J.cols()), 0.0);  // M^-1 J^T f
  const auto push = [&](Index i, double force) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      v[static_cast<std::size_t>(it.col())] += inverse_mass[it.col()] * (it.value() * force);
    }
  };
  std::vector<const FrictionRow*> friction(static_cast<std::size_t>(n), nullptr);
  for (const FrictionRow& row : problem.friction_rows()) friction[static_cast<std::size_t>(row.row)] = &row;
  Eigen::VectorXd& f = result->f;
  // The force nearest to `wanted` that the law allows beside the present normal forces.
  const auto clamped = [&](Index i, double wanted) {
    if (problem.is_bilateral(i)) return wanted;
    const FrictionRow* row = friction[static_cast<std::size_t>(i)];
    if (row == nullptr) return std::max(wanted, 0.0);
    const double bound = row->mu * f[row->normal];
    return std::clamp(wanted, -bound, bound);
  };
  double load = 0;
  for (Index i = 0; i < n; ++i) {
    if (D[i] > 0) load = std::max(load, std::abs(problem.b()[i]) / std::sqrt(D[i]));
    if (options.initial_f == nullptr) continue;
    f[i] = clamped(i, (*options.initial_f)[i]);
    if (f[i] != 0) push(i, f[i]);
  }
  // The change of D^1/2 f_i.
  const auto relax = [&](Index i) {
    if (!(D[i] > 0)) return 0.0;
    double w = problem.b()[i];
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) w += it.value() * v[static_cast<std::size_t>(it.col())];
    const double next = clamped(i, f[i] - w / D[i]);
    const double change = next - f[i];
    if (change != 0) push(i, change);
    f[i] = next;
    return std::abs(change) * std::sqrt(D[i]);
  };
  result->status = LcpStatus::kIterationLimit;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0;
    for (Index k = 0; k < n; ++k) change = std::max(change, relax(sweep % 2 == 0 ? k : n - 1 - k));
    ++result->iterations;
    if (change > kChange * load) continue;
    result->status = LcpStatus::kSolved;
    break;
  }
}

std::string FollowScene(const MovingScene& scene, LcpSolver& solver, int steps,
                        const std::function<bool(const MotionProblem& met)>& handle) {
  const std::unique_ptr<Motion> motion = StartMotion(scene, LcpOptions{}, solver);
  bool goes_on = true;
  bool acceleration_met = false;
  motion->set_observer([&](const MotionProblem& met) {
    const bool is_acceleration = met.kind == MotionProblemKind::kAcceleration;
    if (is_acceleration && acceleration_met) return;
    acceleration_met = acceleration_met || is_acceleration;
    goes_on = handle(met);
  });
  for (int k = 0; k < steps && goes_on; ++k) {
    acceleration_met = false;
    motion->Advance(scene.step);
    if (motion->status() != MotionStatus::kMoving) {
      return "stopped in step " + std::to_string(k + 1) + ": " + motion->detail();
    }
  }
  return {};
}

std::string ForEachSequenceProblem(
    const Recipe& start, int steps,
    const std::function<void(const LcpProblem& problem, const MotionProblem& met)>& handle) {
  ExactSolver exact;
  SweepSolver sweeps;
  const std::string id = RecipeId(start) + "-motion-";
  int number = 0;
  const MovingScene scene = LoadScene(start.scene, start.rows, start.seed);
  LcpSolver& solver = HasFriction(scene.world) ? static_cast<LcpSolver&>(sweeps) : exact;
  return FollowScene(scene, solver, steps, [&](const MotionProblem& met) {
    handle(WithId(met.problem, id + std::to_string(number++)), met);
    return true;
  });
}

std::string FollowMotion(const Recipe& start, int steps, const std::function<bool(const MotionStep& step)>& handle) {
  MovingScene scene = LoadScene(start.scene, start.rows, start.seed);
  scene.level = MotionLevel::kVelocity;
  SweepSolver solver;
  ClosingCount closings;
  Recipe recipe = start;
  return FollowScene(scene, solver, steps, [&](const MotionProblem& met) {
    closings.Follow(met);
    ++recipe.motion_step;
    return handle(
        {recipe.motion_step, closings.count(), Instance{met.system, met.rows, WithId(met.problem, RecipeId(recipe))}});
  });
}

void TakeSteps(const Recipe& start, int count, const std::function<bool(const MotionStep& step)>& accept) {
  constexpr std::int64_t kRowsPerClosing = 4;
  const std::int64_t wanted = std::max<std::int64_t>(1, start.rows / kRowsPerClosing);
  int taken = 0;
  int due = 0;  // the next step to try, once the motion has come to its first
  int tries = 0;
  FollowMotion(start, kLatestStep + count * kStepsBetween, [&](const MotionStep& step) {
    if (due == 0) {
      const bool has_closed = step.number >= kSettled && step.closings >= wanted;
      if (!has_closed && step.number < kLatestStep) return true;
      due = step.number;
    }
    if (step.number < due) return true;
    ++tries;
    if (accept(step)) {
      ++taken;
      tries = 0;
      due = step.number + kStepsBetween;
    }
    return taken < count && tries < kStepsTried;
  });
}

Instance MakeMotionStep(const Recipe& recipe) {
  if (!recipe.changes.empty()) throw InputError("a step of a motion with changes");
  Recipe start = recipe;
  start.motion_step = 0;
  std::optional<Instance> found;
  const std::string end = FollowMotion(start, recipe.motion_step, [&](const MotionStep& step) {
    if (step.number == recipe.motion_step) found = step.instance;
    return !found.has_value();
  });
  if (!found.has_value()) throw InputError(end);
  return *std::move(found);
}

}  // namespace lcpbench
