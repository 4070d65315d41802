#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "solvers/ipopt/quadratic_program.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class Ipopt : public SolverTest {
 protected:
  static LcpResult Solve(const LcpProblem& problem, double tolerance, const Settings& settings = {},
                         const Eigen::VectorXd* start = nullptr) {
    return SolveWith(GetParam().make(settings).get(), problem, {.tolerance = tolerance, .initial_f = start});
  }
};

INSTANTIATE_TEST_SUITE_P(Backends, Ipopt, testing::Values(FindSolver("ipopt-qp"), FindSolver("ipopt-ncp")),
                         SolverTestName);

TEST_P(Ipopt, EveryFormReachesEveryTierOnPlantedProblems) {
  for (const double tolerance : kTiers) {
    for (const char* form : {"contact", "lifted", "auto"}) {
      for (unsigned seed = 0; seed < 6; ++seed) {
        const TestProblem test = PlantedProblem(12, 5, seed, 0, seed % 2 == 0 ? 0 : 3);
        const LcpResult result = Solve(test.problem, tolerance, {{"form", form}});
        SCOPED_TRACE(std::string(form) + " at " + std::to_string(tolerance));
        ExpectSolved(test.problem, result, tolerance);
      }
    }
  }
}

TEST_P(Ipopt, PrintsNothingNotEvenAtTheFirstSolve) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Solve(PlantedProblem(10, 4, 3, 4, 0).problem, 1e-9);
  Eigen::MatrixXd A(2, 2);
  A << 1, -1, -1, 1;
  Solve(LcpProblem::FromDense("jam", A, Eigen::Vector2d(-1, -1)), 1e-9);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(Ipopt, WarmStartAtTheSolutionTakesNoIterationAndNearItFewer) {
  std::mt19937_64 random(5);
  std::int64_t cold_iterations = 0;
  std::int64_t warm_iterations = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const LcpProblem problem = PlantedProblem(20, 8, seed, 0, 0).problem;
    const LcpResult cold = Solve(problem, 1e-6);
    ASSERT_EQ(cold.status, LcpStatus::kSolved);
    EXPECT_EQ(Solve(problem, 1e-6, {}, &cold.f).iterations, 0);
    const Eigen::VectorXd near = cold.f + 1e-4 * cold.f.cwiseProduct(UniformVector(&random, 20, -1, 1));
    const LcpResult warm = Solve(problem, 1e-6, {}, &near);
    EXPECT_EQ(warm.status, LcpStatus::kSolved) << warm.detail;
    cold_iterations += cold.iterations;
    warm_iterations += warm.iterations;
  }
  EXPECT_LT(warm_iterations, cold_iterations);
}

// A solve that ended early, in whatever way, must leave nothing behind in the objects that the next one uses.
TEST_P(Ipopt, SolvesAfterEveryKindOfEndingAreAsFresh) {
  const LcpProblem problem = PlantedProblem(15, 6, 8, 4, 3).problem;
  const LcpResult fresh = Solve(problem, 1e-9);
  const auto expect_as_fresh = [&](const char* after) {
    const LcpResult result = SolverTest::Solve(problem, LcpOptions{});
    EXPECT_EQ(result.status, LcpStatus::kSolved) << after;
    EXPECT_EQ(result.iterations, fresh.iterations) << after;
    EXPECT_TRUE((result.f.array() == fresh.f.array()).all()) << after;
  };
  const LcpResult limited = SolverTest::Solve(problem, {.max_iterations = 2});
  EXPECT_EQ(limited.status, LcpStatus::kIterationLimit);
  EXPECT_EQ(limited.iterations, 2);
  EXPECT_NE(limited.detail.find("Maximum_Iterations_Exceeded"), std::string::npos);
  expect_as_fresh("iteration limit");
  SolverTest::Solve(problem, {.tolerance = 1e-12, .initial_f = &fresh.f});
  expect_as_fresh("warm start");
  EXPECT_EQ(SolverTest::Solve(problem, {.time_limit_s = 1e-9}).status, LcpStatus::kTimeLimit);
  expect_as_fresh("time limit");
}

// Mehrotra mode used to crash in Ipopt's restoration phase; redundant joints lead there.
TEST_P(Ipopt, RedundantJointsNeverCrashAndNeverLie) {
  std::mt19937_64 random(7);
  int solved = 0;
  const int count = 60;
  for (int sample = 0; sample < count; ++sample) {
    const int bodies = 3 + sample % 6;
    Triplets entries;
    std::vector<Index> bilateral;
    int n = 0;
    for (int body = 0; body < bodies; ++body) {
      const Eigen::VectorXd row = UniformVector(&random, 6, -1, 1);
      for (const double scale : {1.0, -1.0, 2.0, 0.5}) {
        if (scale != 0.5) bilateral.push_back(n);
        for (int k = 0; k < 3; ++k) entries.emplace_back(n, 3 * body + k, scale * row[k]);
        for (int k = 0; k < 3 && body > 0; ++k) entries.emplace_back(n, 3 * (body - 1) + k, scale * row[k + 3]);
        ++n;
      }
    }
    const Index columns = Index{3} * bodies;
    const SparseMatrix J = MatrixOf(n, columns, entries);
    const Eigen::VectorXd inverse_mass =
        UniformVector(&random, columns, -2, 2).unaryExpr([](double x) { return std::pow(10.0, x); });
    const LcpProblem problem =
        LcpProblem::FromFactors("joints", J, inverse_mass, J * UniformVector(&random, columns, -1, 1),
                                RowBounds::WithBilateralRows(n, bilateral));
    for (const char* form : {"auto", "lifted"}) {
      const LcpResult result = Solve(problem, 1e-9, {{"form", form}});
      EXPECT_FALSE(Verify(problem, result, 1e-9).false_success) << sample << ' ' << form;
      EXPECT_NE(result.status, LcpStatus::kInfeasible) << sample << ' ' << form;
      if (std::string(form) == "auto" && result.status == LcpStatus::kSolved) ++solved;
    }
  }
  EXPECT_GE(solved, count * 9 / 10);
}

TEST(IpoptProgram, ItsDerivativesAreThoseOfTheDenseForm) {
  constexpr int n = 9, m = 4;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&](Index) { return uniform(random); };
  ipopt::QuadraticProgram program;
  program.c = Eigen::VectorXd::NullaryExpr(n, any);
  program.d = Eigen::VectorXd::Zero(m);
  program.nonnegative.assign(n, true);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n), G = Eigen::MatrixXd::Zero(m, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; j += 2) program.hessian.emplace_back(i, j, H(i, j) = H(j, i) = uniform(random));
  }
  for (int i = 0; i < m; ++i) {
    for (int j = i; j < n; j += 2) program.jacobian.emplace_back(i, j, G(i, j) = uniform(random));
  }
  const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, any);
  Eigen::VectorXd gradient(n), values(m);
  program.Gradient(x.data(), gradient.data());
  program.Constraints(x.data(), values.data());
  EXPECT_NEAR(program.Objective(x.data()), 0.5 * x.dot(H * x) + program.c.dot(x), 1e-14);
  EXPECT_LE((gradient - H * x - program.c).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LE((values - G * x).cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace lcpbench
