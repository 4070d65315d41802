#include "benchmarks/collection/recipes/changes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

LcpProblem Scene(std::string_view key, int rows) { return AssembleContactLcp(GenerateScene(key, rows, 1)).problem; }

TEST(MassSpread, MultipliesBodiesBetweenOneAndTheRatio) {
  for (const SceneFamily& family : AllScenes()) {
    SCOPED_TRACE(family.key);
    const LcpProblem given = Scene(family.key, 60);
    for (const double ratio : {10.0, 1e6}) {
      const LcpProblem spread = SpreadMasses(given, ratio, 3);
      double least = std::numeric_limits<double>::infinity();
      double most = 0;
      int movable = 0;
      for (Index body = 0; body < given.inverse_mass().size() / 3; ++body) {
        const Eigen::Vector3d before = given.inverse_mass().segment<3>(3 * body);
        const Eigen::Vector3d after = spread.inverse_mass().segment<3>(3 * body);
        if (before.isZero(0)) {
          EXPECT_TRUE(after.isZero(0)) << body;
          continue;
        }
        ++movable;
        const double factor = before.maxCoeff() / after.maxCoeff();
        // Mass and inertia of a body by the same factor: its shape stays.
        EXPECT_LE((factor * after - before).norm(), 1e-14 * before.norm()) << body;
        least = std::min(least, factor);
        most = std::max(most, factor);
      }
      if (movable < 2) continue;
      EXPECT_NEAR(least, 1, 1e-14);
      EXPECT_NEAR(most, ratio, 1e-13 * ratio);
      EXPECT_EQ(spread.b(), given.b());
      EXPECT_EQ(Eigen::MatrixXd(spread.J()), Eigen::MatrixXd(given.J()));
      EXPECT_EQ(spread.bilateral_rows(), given.bilateral_rows());
    }
  }
}

TEST(MassSpread, LeavesEveryFamilySolvable) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("dantzig");
  for (const SceneFamily& family : AllScenes()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const LcpProblem spread = SpreadMasses(Scene(family.key, 40), 1e6, seed);
      LcpResult result;
      solver->Solve(spread, {}, &result);
      EXPECT_TRUE(Verify(spread, result, 1e-6).passes) << family.key << ": " << result.detail;
    }
  }
}

TEST(MassSpread, IsTheSameForTheSameSeedOnly) {
  const LcpProblem given = Scene("disc-pile", 60);
  EXPECT_EQ(SpreadMasses(given, 1e6, 1).inverse_mass(), SpreadMasses(given, 1e6, 1).inverse_mass());
  EXPECT_NE(SpreadMasses(given, 1e6, 1).inverse_mass(), SpreadMasses(given, 1e6, 2).inverse_mass());
  EXPECT_EQ(SpreadMasses(given, 1, 1).inverse_mass(), given.inverse_mass());
}

TEST(MassSpread, RefusesRatiosBelowOne) {
  const LcpProblem given = Scene("disc-pile", 10);
  for (const double ratio : {0.5, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(SpreadMasses(given, ratio, 1), InputError) << ratio;
  }
}

}  // namespace
}  // namespace lcpbench
