#include "solvers/first_order/apgd.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include "solvers/pivoting/dantzig.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ApgdOptions WithoutRestart() {
  ApgdOptions options;
  options.restart = false;
  return options;
}

TEST(Apgd, EnergyFallsWithTheSquareOfTheIterations) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const LcpProblem problem = PlantedProblem(24, 5, seed, seed % 2 == 0 ? 6 : 0, 3).problem;
    DantzigSolver exact;
    LcpResult solution;
    exact.Solve(problem, {}, &solution);
    ASSERT_EQ(solution.status, LcpStatus::kSolved);
    // In the Jacobi-scaled variables: step sizes are bounded through the largest eigenvalue there.
    const VectorXd root = problem.DiagonalA().cwiseSqrt();
    const MatrixXd scaled = root.cwiseInverse().asDiagonal() * problem.DenseA() * root.cwiseInverse().asDiagonal();
    const double largest = Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled).eigenvalues().maxCoeff();
    const double distance = root.cwiseProduct(solution.f).squaredNorm();
    const double least = Energy(problem, solution.f);
    for (const std::int64_t k : {1, 2, 4, 8, 16, 31}) {
      const LcpResult result = IterateNew<ApgdSolver>(problem, WithoutRestart(), 1e-15, k);
      // The start is returned where its residual is less than that of the last iterate.
      if (result.iterations < k || result.f.isZero(0)) continue;
      ++compared;
      const double bound = 2 * ApgdOptions::kGrowth * largest * distance / static_cast<double>(k * k);
      EXPECT_LE(Energy(problem, result.f) - least, bound) << problem.id() << ", " << k << " iterations";
    }
  }
  EXPECT_GE(compared, 40);
}

TEST(Apgd, RestartPaysOnAChain) {
  const TestProblem chain = GeneratedProblems().back();
  const LcpResult with_restart = IterateNew<ApgdSolver>(chain.problem, {}, 1e-9, 0);
  const LcpResult without_restart = IterateNew<ApgdSolver>(chain.problem, WithoutRestart(), 1e-9, 0);
  EXPECT_EQ(with_restart.status, LcpStatus::kSolved);
  EXPECT_LT(2 * with_restart.iterations, without_restart.iterations);
}

}  // namespace
}  // namespace lcpbench
