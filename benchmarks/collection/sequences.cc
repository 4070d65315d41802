#include "benchmarks/collection/sequences.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/recipes/instance.h"
#include "benchmarks/motions/scene_source.h"
#include "benchmarks/motions/sequence.h"
#include "solvers/exact/exact_solver.h"
#include "support/input_error.h"

namespace lcpbench {
std::string SequenceId(const Recipe& start) { return RecipeId(start) + "-motion"; }

std::string ForEachSequenceProblem(
    const Recipe& start, int steps,
    const std::function<void(const LcpProblem& problem, const MotionProblem& met)>& handle) {
  const MovingScene scene = LoadScene(start.scene, start.rows, start.seed);
  ExactSolver solver;
  const std::unique_ptr<Motion> motion = StartMotion(scene, LcpOptions{}, solver);
  const std::string id = SequenceId(start);
  int number = 0;
  bool acceleration_met = false;
  motion->set_observer([&](const MotionProblem& met) {
    if (met.kind == MotionProblemKind::kAcceleration) {
      if (acceleration_met) return;
      acceleration_met = true;
    }
    handle(WithId(met.problem, id + "-" + std::to_string(number++)), met);
  });
  for (int k = 0; k < steps; ++k) {
    acceleration_met = false;
    motion->Advance(scene.step);
    if (motion->status() != MotionStatus::kMoving)
      return "stopped in step " + std::to_string(k) + ": " + motion->detail();
  }
  return {};
}

SequenceEntry MeasureSequence(const Recipe& start, int steps) {
  SequenceEntry entry;
  entry.id = SequenceId(start);
  entry.family = start.scene;
  entry.start = start;
  entry.steps = steps;
  SequenceHash hash;
  ActiveSetHistory history;
  std::vector<Index> rows;
  std::int64_t still = 0;
  double churn = 0;
  const std::string end =
      ForEachSequenceProblem(start, steps, [&](const LcpProblem& problem, const MotionProblem& met) {
        hash.Add(problem);
        rows.push_back(problem.size());
        if (met.result.status == LcpStatus::kInfeasible) ++entry.unsolvable;
        const ActiveSetChange change = history.Follow(met, ComputeMetrics(problem, met.result.f).w);
        if (rows.size() == 1) return;
        const auto count = [](const std::vector<int>& list) { return static_cast<std::int64_t>(list.size()); };
        entry.entered += count(change.entered);
        entry.left += count(change.left);
        entry.activated += count(change.activated);
        entry.deactivated += count(change.deactivated);
        const std::int64_t changes =
            count(change.entered) + count(change.left) + count(change.activated) + count(change.deactivated);
        if (changes == 0) ++still;
        churn += static_cast<double>(changes) / static_cast<double>(std::max<Index>(problem.size(), 1));
      });
  if (!end.empty()) throw InputError(entry.id + ": " + end);
  entry.problems = static_cast<std::int64_t>(rows.size());
  if (rows.size() > 1) {
    const auto others = static_cast<double>(rows.size() - 1);
    entry.churn = churn / others;
    entry.still_share = static_cast<double>(still) / others;
  }
  std::sort(rows.begin(), rows.end());
  if (!rows.empty()) {
    entry.least_rows = rows.front();
    entry.median_rows = rows[rows.size() / 2];
    entry.most_rows = rows.back();
  }
  entry.sha256 = hash.Result();
  return entry;
}

}  // namespace lcpbench
