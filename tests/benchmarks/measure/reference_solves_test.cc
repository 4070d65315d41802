#include "benchmarks/measure/reference_solves.h"

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

constexpr double kStrictest = 1e-9;

// A reference that knows the floor alone.
LcpReference ReferenceOf(const LcpProblem& problem) {
  constexpr double kTimeLimit = 20;
  LcpReference reference;
  reference.floor = FindReferenceFloor(problem, kStrictest, kTimeLimit);
  EXPECT_TRUE(reference.floor.has_value()) << problem.id();
  return reference;
}

TEST(ReferenceFloor, IsKnownOnEveryFamilyAndBelowEveryTier) {
  for (const SceneFamily& scene : AllScenes()) {
    for (const std::uint64_t seed : {1U, 2U}) {
      const LcpProblem problem = AssembleContactLcp(GenerateScene(std::string(scene.key), 40, seed)).problem;
      const double floor = ReferenceOf(problem).floor.value_or(0);
      EXPECT_GT(floor, 0);
      EXPECT_LT(floor, 1e-11) << scene.key;
    }
  }
}

// What the exact answer rounds to passes, and so does what solvers reach.
TEST(ReferenceFloor, MakesHonestAnswersPassWhereMassesDifferByAMillion) {
  for (const double ratio : {1e4, 1e6}) {
    const StackedColumn column = MakeStackedColumn(500, ratio);
    const LcpReference reference = ReferenceOf(column.problem);
    EXPECT_GT(*reference.floor, kStrictest);

    LcpResult exact;
    exact.status = LcpStatus::kSolved;
    exact.f.resize(500);
    for (Index i = 0; i < 500; ++i) exact.f[i] = static_cast<double>(column.f[static_cast<size_t>(i)]);
    EXPECT_NEAR(*reference.floor, RoundingFloor(column.problem, exact.f), 1e-3 * *reference.floor);
    EXPECT_FALSE(Verify(column.problem, exact, kStrictest).passes);
    const Verdict verdict = Verify(column.problem, exact, kStrictest, &reference);
    EXPECT_TRUE(verdict.passes) << verdict.reason;
    EXPECT_TRUE(verdict.at_floor);

    for (const char* key : {"auto", "dantzig"}) {
      LcpResult result = SolveBy(key, column.problem, kStrictest);
      const Verdict judged = Verify(column.problem, result, kStrictest, &reference);
      EXPECT_TRUE(judged.passes) << key << ": " << judged.reason;
      // One part in a thousand of the load is no rounding.
      result.f *= 0.999;
      EXPECT_FALSE(Verify(column.problem, result, kStrictest, &reference).passes);
    }
  }
}

TEST(ReferenceFloor, IsTheSameWhateverAJudgedSolverReturns) {
  // Redundant: a wall of bricks with two contacts at every face, where self-stress is free.
  const LcpProblem problem = AssembleContactLcp(GenerateScene("boxes-and-discs", 60, 1)).problem;
  const LcpReference reference = ReferenceOf(problem);
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available || entry.origin != SolverOrigin::kOwn) continue;
    const LcpResult result = SolveBy(entry.key, problem, kStrictest);
    const Verdict verdict = Verify(problem, result, kStrictest, &reference);
    EXPECT_EQ(verdict.metrics.floor, *reference.floor) << entry.key;
    EXPECT_EQ(verdict.passes, Verify(problem, result, kStrictest).passes) << entry.key;
    EXPECT_FALSE(verdict.at_floor) << entry.key;
  }
}

TEST(ReferenceFloor, IsNotKnownWhereNothingIsVerified) {
  // Two walls that close on a body.
  const Eigen::MatrixXd A = (Eigen::MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  const LcpProblem problem = LcpProblem::FromDense("closing", A, Eigen::Vector2d(-1, -1), {}, SymmetricPsd());
  LcpReference reference;
  reference.floor = FindReferenceFloor(problem, kStrictest, 1);
  EXPECT_FALSE(reference.floor.has_value());
  EXPECT_EQ(Verify(problem, LcpResult{}, kStrictest, &reference).metrics.floor, -1);
}

}  // namespace
}  // namespace lcpbench
