#include "benchmarks/collection/sequences.h"

#include <algorithm>
#include <string>
#include <vector>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/motions/sequence.h"
#include "solvers/exact/exact_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

std::string SequenceId(const Recipe& start) { return RecipeId(start) + "-motion"; }

}  // namespace

std::string ForEachSequenceProblem(
    const Recipe& start, int steps,
    const std::function<void(const LcpProblem& problem, const MotionProblem& met)>& handle) {
  ExactSolver solver;
  const std::string id = SequenceId(start) + "-";
  int number = 0;
  const MovingScene scene = LoadScene(start.scene, start.rows, start.seed);
  return FollowScene(scene, solver, steps, [&](const MotionProblem& met) {
    handle(WithId(met.problem, id + std::to_string(number++)), met);
    return true;
  });
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
  const std::string end =
      ForEachSequenceProblem(start, steps, [&](const LcpProblem& problem, const MotionProblem& met) {
        hash.Add(problem);
        rows.push_back(problem.size());
        if (met.result.status == LcpStatus::kInfeasible) ++entry.unsolvable;
        const ActiveSetChange change = history.Follow(met, ComputeMetrics(problem, met.result.f).w);
        if (rows.size() == 1) return;
        std::int64_t changes = 0;
        const auto count = [&changes](const std::vector<int>& list, std::int64_t* sum) {
          *sum += static_cast<std::int64_t>(list.size());
          changes += static_cast<std::int64_t>(list.size());
        };
        count(change.entered, &entry.entered);
        count(change.left, &entry.left);
        count(change.activated, &entry.activated);
        count(change.deactivated, &entry.deactivated);
        if (changes == 0) ++still;
        entry.churn += static_cast<double>(changes) / static_cast<double>(std::max<Index>(problem.size(), 1));
      });
  if (!end.empty()) throw InputError(entry.id + ": " + end);
  entry.problems = static_cast<std::int64_t>(rows.size());
  if (rows.size() > 1) {
    const auto others = static_cast<double>(rows.size() - 1);
    entry.churn /= others;
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
