#include "benchmarks/measure/oracle.h"

#include <Eigen/Dense>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

LcpProblem Scene(std::string_view key, int rows, std::uint64_t seed) {
  return AssembleContactLcp(GenerateScene(key, rows, seed)).problem;
}

// As many rows as the rank, and A nonsingular on them: so no further row could be added.
TEST(Oracle, IndependentRowsAreAMaximalSet) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = 1 + trial % 25;
    const Index rank = 1 + trial % 7;
    Eigen::MatrixXd factor(n, rank);
    for (double& value : factor.reshaped()) value = random() % 2 == 0 ? normal(random) : 0.0;
    const Eigen::MatrixXd A = factor * factor.transpose();
    std::vector<Index> rows;
    for (Index i = 0; i < n; ++i) {
      if (A(i, i) > 0) rows.push_back(i);
    }
    const SparseMatrix sparse = A.sparseView();
    const std::vector<Index> independent = IndependentRows(sparse, rows);
    const Index expected = rows.empty() ? 0 : Eigen::FullPivLU<Eigen::MatrixXd>(factor).rank();
    EXPECT_EQ(static_cast<Index>(independent.size()), expected) << trial;
    if (independent.empty()) continue;
    EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(A(independent, independent)).rank(), expected) << trial;
  }
}

TEST(Oracle, SolvesTheProblemThatItIsToldTheActiveSetOf) {
  if (!FindSolver("ipm").available) GTEST_SKIP() << "ipm is not in this build";
  for (const char* key : {"discs-in-v", "disc-pile", "boxes-and-discs"}) {
    const LcpProblem problem = Scene(key, 120, 3);
    LcpResult result;
    MakeSolver("dantzig")->Solve(problem, {}, &result);
    const Metrics metrics = ComputeMetrics(problem, result.f);
    const std::vector<Index> rows = IndependentRows(problem.SparseA(), ActiveRows(problem, result.f, metrics.w));
    // On the independent active rows w = 0 determines a force that gives the same w everywhere.
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem.size());
    const Eigen::MatrixXd A = problem.DenseA()(rows, rows);
    const Eigen::VectorXd b = problem.b()(rows);
    f(rows) = Eigen::VectorXd(A.ldlt().solve(-b));
    const Eigen::VectorXd w = problem.DenseA() * f + problem.b();
    EXPECT_LE((w - metrics.w).cwiseAbs().maxCoeff(), 1e-7 * problem.b().cwiseAbs().maxCoeff()) << key;

    EXPECT_GT(TimeOracle(problem, result.f, metrics.w), 0);
  }
}

// A tree of bodies is ordered without fill: L has the entries of the matrix.
TEST(Oracle, OfAChainHasNoFill) {
  if (!FindSolver("ipm").available) GTEST_SKIP() << "orders come from CHOLMOD, which is not in this build";
  const LcpProblem problem = Scene("chain-of-links", 200, 1);
  const std::vector<Factorization> times = TimeBodySpace(problem, problem.bilateral_rows());
  ASSERT_FALSE(times.empty());
  EXPECT_EQ(times.front().fill,
            static_cast<double>(MakeBodySystem(problem, problem.bilateral_rows()).lower.nonZeros()));
  EXPECT_GT(times.front().seconds, 0);
  for (const Factorization& time : TimeBodySpace(problem, {})) EXPECT_EQ(time.seconds, 0);
}

// Every third row is left out, so that some bodies are coupled to nothing.
std::vector<Index> SomeRows(const LcpProblem& problem) {
  std::vector<Index> rows;
  for (Index i = 0; i < problem.size(); ++i) {
    if (i % 3 != 1) rows.push_back(i);
  }
  return rows;
}

TEST(BodySystem, IsMassPlusStiffnessOfTheActiveRows) {
  for (const SceneFamily& family : AllScenes()) {
    SCOPED_TRACE(family.key);
    const LcpProblem problem = Scene(family.key, 25, 2);
    const std::vector<Index> rows = SomeRows(problem);
    const BodySystem system = MakeBodySystem(problem, rows);
    const Eigen::MatrixXd J = Eigen::MatrixXd(problem.J())(rows, system.column_of);
    const Eigen::VectorXd stiffness = kStiffness * problem.DenseA().diagonal()(rows).cwiseInverse();
    Eigen::MatrixXd expected = J.transpose() * stiffness.asDiagonal() * J;
    expected.diagonal() += problem.inverse_mass()(system.column_of).cwiseInverse();
    const Eigen::MatrixXd lower = system.lower;
    EXPECT_EQ(lower.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().norm(), 0);
    const Eigen::MatrixXd difference = lower - expected.triangularView<Eigen::Lower>().toDenseMatrix();
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-14 * expected.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace lcpbench
