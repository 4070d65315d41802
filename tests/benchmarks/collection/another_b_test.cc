#include "benchmarks/collection/recipes/another_b.h"

#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/collection/recipes/recipe.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

TEST(AnotherB, LeavesProblemsSolvableAndMovesTheirForces) {
  for (const SceneFamily& family : AllScenes()) {
    const LcpProblem given = MakeInstance({std::string(family.key), 25, 1, {}}).problem;
    const Eigen::VectorXd b = AnotherB(given, 5);
    EXPECT_EQ(AnotherB(given, 5), b);
    EXPECT_NE(AnotherB(given, 6), b);
    const LcpProblem problem = given.WithB(b);
    LcpResult before;
    LcpResult after;
    MakeSolver("dantzig")->Solve(given, {}, &before);
    MakeSolver("dantzig")->Solve(problem, {}, &after);
    EXPECT_TRUE(Verify(problem, after, 1e-9).passes) << family.key << ": " << after.detail;
    const double change = (after.f - before.f).norm() / before.f.norm();
    EXPECT_GT(change, 1e-3) << family.key;
    EXPECT_LT(change, 10) << family.key;
  }
}

// b' + A d = b, with forces d that only press.
TEST(AnotherB, IsWhatMoreForceWouldUndo) {
  const LcpProblem given = LcpProblem::FromDense("d", Eigen::Vector3d(2, 8, 0).asDiagonal(), Eigen::Vector3d(-4, 1, 1),
                                                 RowBounds::WithBilateralRows(3, {1}));
  const Eigen::VectorXd change = given.b() - AnotherB(given, 1);
  const double load = 4 / std::sqrt(2.0);
  EXPECT_GE(change[0], 0);
  EXPECT_LE(change[0], 0.1 * load * std::sqrt(2.0));
  EXPECT_LE(std::abs(change[1]), 0.1 * load * std::sqrt(8.0));
  EXPECT_EQ(change[2], 0);
}

}  // namespace
}  // namespace lcpbench
