#include "benchmarks/motions/drift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

TEST(Drift, ChangesBByItsSizeAndLeavesEveryFamilySolvable) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("semismooth-newton");
  for (const SceneFamily& family : AllScenes()) {
    SCOPED_TRACE(family.key);
    const LcpProblem given = AssembleContactLcp(GenerateScene(family.key, 40, 1)).problem;
    const Eigen::VectorXd root = given.DiagonalA().cwiseSqrt().unaryExpr([](double r) { return r == 0 ? 1.0 : r; });
    for (const double size : {1e-3, 1e-2}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const LcpProblem drifted = Drift(given, size, seed);
        const double change = (drifted.b() - given.b()).cwiseQuotient(root).norm();
        EXPECT_NEAR(change, size * given.b().cwiseQuotient(root).norm(), 1e-9 * change);
        for (Index i = 0; i < given.size(); ++i) {
          EXPECT_NEAR(drifted.DiagonalA()[i], given.DiagonalA()[i], 1.0001 * size * given.DiagonalA()[i]);
        }
        LcpResult result;
        solver->Solve(drifted, {}, &result);
        EXPECT_TRUE(Verify(drifted, result, 1e-9).passes) << result.detail;
      }
    }
  }
}

TEST(Drift, OfSizeZeroIsTheGivenProblem) {
  const LcpProblem given = AssembleContactLcp(GenerateScene("gear-train", 30, 2)).problem;
  const LcpProblem same = Drift(given, 0, 5);
  EXPECT_EQ(same.b(), given.b());
  EXPECT_EQ(same.inverse_mass(), given.inverse_mass());
  EXPECT_EQ(same.bilateral_rows(), given.bilateral_rows());
}

TEST(Drift, IsTheSameForTheSameSeedOnly) {
  const LcpProblem given = AssembleContactLcp(GenerateScene("disc-pile", 30, 2)).problem;
  EXPECT_EQ(Drift(given, 0.01, 1).b(), Drift(given, 0.01, 1).b());
  EXPECT_NE(Drift(given, 0.01, 1).b(), Drift(given, 0.01, 2).b());
}

TEST(PairsOfMotion, MatchRowsOfTheSameBodies) {
  const std::vector<ConsecutiveProblems> pairs = PairsOfMotion("disc-pile", 30, 1, 3, 5);
  ASSERT_EQ(pairs.size(), 3U);
  for (const ConsecutiveProblems& pair : pairs) {
    ASSERT_EQ(static_cast<Index>(pair.row_before.size()), pair.after.size());
    int matched = 0;
    for (Index i = 0; i < pair.after.size(); ++i) {
      const int before = pair.row_before[static_cast<size_t>(i)];
      if (before < 0) continue;
      ++matched;
      // Within one step a contact's row hardly turns.
      const Eigen::VectorXd turned = pair.after.J().row(i) - pair.before.J().row(before);
      EXPECT_LE(turned.norm(), 0.05 * pair.after.J().row(i).norm()) << i;
    }
    EXPECT_GE(matched, static_cast<int>(pair.after.size()) - 2);
  }
}

TEST(LoseContacts, RowsAreThoseOfTheGivenProblemAndMatched) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const LcpProblem given = AssembleContactLcp(GenerateScene("chain-of-links", 300, 1)).problem;
    const ConsecutiveProblems pair = LoseContacts(given, 0.1, seed);
    EXPECT_EQ(pair.before.bilateral_rows().size(), given.bilateral_rows().size());
    EXPECT_EQ(pair.after.bilateral_rows().size(), given.bilateral_rows().size());
    ASSERT_EQ(static_cast<Index>(pair.row_before.size()), pair.after.size());
    for (Index i = 0; i < pair.after.size(); ++i) {
      const int before = pair.row_before[static_cast<size_t>(i)];
      if (before < 0) continue;
      EXPECT_EQ(pair.before.b()[before], pair.after.b()[i]);
      EXPECT_EQ(Eigen::VectorXd(pair.before.J().row(before)), Eigen::VectorXd(pair.after.J().row(i)));
    }
  }
  const LcpProblem given = AssembleContactLcp(GenerateScene("disc-pile", 300, 1)).problem;
  EXPECT_EQ(LoseContacts(given, 0, 1).after.b(), given.b());
  const ConsecutiveProblems pair = LoseContacts(given, 0.1, 1);
  EXPECT_LT(pair.after.size(), given.size());
  EXPECT_GT(std::count(pair.row_before.begin(), pair.row_before.end(), -1), 0);
}

}  // namespace
}  // namespace lcpbench
