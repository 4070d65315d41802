#include "benchmarks/collection/recipes/motion_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "benchmarks/collection/content_hash.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

TEST(SweepSolver, SolvesWhatSweepsSolve) {
  SweepSolver solver;
  for (const char* scene : {"disc-pile", "chain-of-links", "rounded-wall"}) {
    const LcpProblem problem = MakeInstance({scene, 12, 1, {}}).problem;
    LcpResult result;
    solver.Solve(problem, {}, &result);
    if (result.status == LcpStatus::kSolved) {
      EXPECT_LE(ComputeMetrics(problem, result.f).rho, 1e-5) << scene;
    }
    EXPECT_LE(result.iterations, SweepSolver::kMostSweeps);
    // From its own answer it goes no further than from anywhere else.
    LcpOptions warm;
    const Eigen::VectorXd f = result.f;
    warm.initial_f = &f;
    solver.Solve(problem, warm, &result);
    EXPECT_LE((result.f - f).cwiseAbs().maxCoeff(), 1e-3 * (1e-300 + f.cwiseAbs().maxCoeff())) << scene;
  }
}

TEST(MotionSteps, AreTakenByTheRule) {
  for (const char* scene : {"disc-pile", "oval-train"}) {
    const Recipe start{scene, 45, 1, {}};
    std::vector<int> numbers;
    std::vector<std::int64_t> closings;
    TakeSteps(start, 2, [&](const MotionStep& step) {
      numbers.push_back(step.number);
      closings.push_back(step.closings);
      return numbers.size() != 2;  // the second one offered is refused
    });
    ASSERT_EQ(numbers.size(), 3U) << scene;
    EXPECT_TRUE(numbers[0] == kLatestStep || (numbers[0] >= kSettled && closings[0] >= 45 / 4)) << scene;
    EXPECT_EQ(numbers[1], numbers[0] + kStepsBetween) << scene;
    EXPECT_EQ(numbers[2], numbers[1] + 1) << scene;
    int offered = 0;
    TakeSteps(start, 2, [&](const MotionStep&) { return ++offered < 0; });
    EXPECT_EQ(offered, kStepsTried);
  }
}

TEST(MotionSteps, AreThoseOfTheirRecipes) {
  const Recipe recipe{"rounded-wall", 45, 3, {}, 7};
  const LcpProblem made = MakeInstance(recipe).problem;
  EXPECT_EQ(made.id(), "rounded-wall-n45-s3-motion-step7");
  std::string hash;
  Recipe start = recipe;
  start.motion_step = 0;
  FollowMotion(start, 10, [&](const MotionStep& step) {
    if (step.number == 7) hash = ContentHash(step.instance.problem);
    return true;
  });
  EXPECT_EQ(ContentHash(made), hash);
  Recipe changed = recipe;
  changed.changes = {{"slack", 1}};
  EXPECT_THROW(MakeInstance(changed), InputError);
}

// What is met on the way are contacts that have met, not overlaps that a bad solver left.
TEST(MotionSteps, KeepTheirContactsApart) {
  for (const SceneFamily& family : AllScenes()) {
    double deepest = 0;
    const std::string end = FollowMotion({std::string(family.key), 12, 1, {}}, 60, [&](const MotionStep& step) {
      for (const RowInfo& row : step.instance.rows) {
        if (!row.bilateral) deepest = std::max(deepest, -row.d);
      }
      return true;
    });
    EXPECT_EQ(end, "") << family.key;
    EXPECT_LE(deepest, 5e-3) << family.key;
  }
}

}  // namespace
}  // namespace lcpbench
