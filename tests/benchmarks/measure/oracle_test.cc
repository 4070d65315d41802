#include "benchmarks/measure/oracle.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "benchmarks/measure/body_system.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

Eigen::MatrixXd Restricted(const Eigen::MatrixXd& A, const std::vector<Index>& rows) {
  const auto n = static_cast<Index>(rows.size());
  Eigen::MatrixXd sub(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) sub(i, j) = A(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
  }
  return sub;
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
    EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(Restricted(A, independent)).rank(), expected) << trial;
  }
}

TEST(Oracle, SolvesTheProblemThatItIsToldTheActiveSetOf) {
  if (!FindSolver("ipm").available) GTEST_SKIP() << "ipm is not in this build";
  for (const char* key : {"discs-in-v", "disc-pile", "boxes-and-discs"}) {
    const LcpProblem problem = AssembleContactLcp(GenerateScene(key, 120, 3)).problem;
    LcpResult result;
    MakeSolver("dantzig")->Solve(problem, {}, &result);
    const Metrics metrics = ComputeMetrics(problem, result.f);
    const std::vector<Index> rows = IndependentRows(problem.SparseA(), ActiveRows(problem, result.f, metrics.w));
    // On the independent active rows w = 0 determines a force that gives the same w everywhere.
    Eigen::VectorXd b(static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) b[static_cast<Index>(i)] = problem.b()[rows[i]];
    const Eigen::VectorXd solved = Restricted(problem.DenseA(), rows).ldlt().solve(-b);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem.size());
    for (std::size_t i = 0; i < rows.size(); ++i) f[rows[i]] = solved[static_cast<Index>(i)];
    const Eigen::VectorXd w = problem.DenseA() * f + problem.b();
    EXPECT_LE((w - metrics.w).cwiseAbs().maxCoeff(), 1e-7 * problem.b().cwiseAbs().maxCoeff()) << key;

    EXPECT_GT(TimeOracle(problem, result.f, metrics.w), 0);
  }
}

// A tree of bodies is ordered without fill: L has the entries of the matrix.
TEST(Oracle, OfAChainHasNoFill) {
  if (!FindSolver("ipm").available) GTEST_SKIP() << "orders come from CHOLMOD, which is not in this build";
  const LcpProblem problem = AssembleContactLcp(GenerateScene("chain-of-links", 200, 1)).problem;
  const std::vector<Factorization> times = TimeBodySpace(problem, problem.bilateral_rows());
  ASSERT_FALSE(times.empty());
  EXPECT_EQ(times.front().fill,
            static_cast<double>(MakeBodySystem(problem, problem.bilateral_rows()).lower.nonZeros()));
  EXPECT_GT(times.front().seconds, 0);
  for (const Factorization& time : TimeBodySpace(problem, {})) EXPECT_EQ(time.seconds, 0);
}

}  // namespace
}  // namespace lcpbench
