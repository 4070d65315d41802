#include "solvers/first_order/apgd.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "solvers/lcp/verify.h"
#include "solvers/pivoting/dantzig.h"
#include "support/input_error.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr auto Iterate = [](const LcpProblem& problem, const ApgdOptions& options, double tolerance, std::int64_t k) {
  return IterateNew<ApgdSolver>(problem, options, tolerance, k);
};

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
      ApgdOptions options;
      options.restart = false;
      const LcpResult result = Iterate(problem, options, 1e-15, k);
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
  ApgdOptions without;
  without.restart = false;
  const LcpResult with_restart = Iterate(chain.problem, {}, 1e-9, 0);
  const LcpResult without_restart = Iterate(chain.problem, without, 1e-9, 0);
  EXPECT_EQ(with_restart.status, LcpStatus::kSolved);
  EXPECT_LT(2 * with_restart.iterations, without_restart.iterations);
}

TEST(Apgd, FormsAgreeOnAnIterate) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const LcpProblem problem = PlantedProblem(20, 12, seed, seed % 2 == 0 ? 5 : 0, 0).problem;
    for (const std::int64_t k : {1, 3, 8}) {
      const VectorXd a = Iterate(problem, {RowForm::kAssembled, true}, 1e-15, k).f;
      const VectorXd m = Iterate(problem, {RowForm::kMatrixFree, true}, 1e-15, k).f;
      EXPECT_LE((a - m).cwiseAbs().maxCoeff(), 1e-9 * (1e-300 + a.cwiseAbs().maxCoeff())) << problem.id();
    }
  }
}

TEST(Apgd, UnknownOptionsAreRefused) { EXPECT_THROW(ApgdOptions::FromSettings({{"restart", "maybe"}}), InputError); }

}  // namespace
}  // namespace lcpbench
