// What pgs, psor, nncg and apgd have in common beyond the contract of all solvers.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class FirstOrder : public testing::TestWithParam<std::string> {
 protected:
  static LcpResult Solve(const LcpProblem& problem, LcpOptions options, const Settings& settings = {}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam(), settings);
    LcpResult result;
    solver->Solve(problem, options, &result);
    return result;
  }
  static LcpOptions At(double tolerance) {
    LcpOptions options;
    options.tolerance = tolerance;
    return options;
  }
};

INSTANTIATE_TEST_SUITE_P(Keys, FirstOrder, testing::Values("pgs", "psor", "nncg", "apgd"),
                         [](const auto& key) { return key.param; });

// Full rank and no chain: every first-order method gets there.
std::vector<TestProblem> EasyProblems() {
  std::vector<TestProblem> problems;
  for (unsigned seed = 1; seed <= 6; ++seed) problems.push_back(PlantedProblem(20, 12, seed, seed % 2 == 0 ? 5 : 0, 0));
  return problems;
}

TEST_P(FirstOrder, SolvesEasyProblemsToEveryTierInEveryForm) {
  for (const TestProblem& test : EasyProblems()) {
    for (const char* form : {"auto", "assembled", "matrix-free"}) {
      for (const double tolerance : kTiers) {
        const LcpResult result = Solve(test.problem, At(tolerance), {{"form", form}});
        EXPECT_EQ(result.status, LcpStatus::kSolved) << test.problem.id() << " " << form << " " << tolerance;
        EXPECT_TRUE(Verify(test.problem, result, tolerance, &test.reference).passes) << test.problem.id();
      }
    }
  }
}

TEST_P(FirstOrder, UnitsChangeNothingButTheUnits) {
  for (const TestProblem& test : EasyProblems()) {
    const LcpProblem& problem = test.problem;
    const RowBounds bounds = RowBounds::WithBilateralRows(problem.size(), problem.bilateral_rows());
    const LcpResult plain = Solve(problem, At(1e-6));
    for (const double of_mass : {1e-12, 1.0, 1e12}) {
      for (const double of_b : {1e-12, 1.0, 1e12}) {
        const LcpProblem scaled =
            LcpProblem::FromFactors("units", problem.J(), of_mass * problem.inverse_mass(), of_b * problem.b(), bounds);
        const LcpResult result = Solve(scaled, At(1e-6));
        EXPECT_EQ(result.status, plain.status) << problem.id() << " " << of_mass << " " << of_b;
        // Powers of ten round; a stopping test may then see the tolerance met one iteration earlier or later.
        EXPECT_NEAR(static_cast<double>(result.iterations), static_cast<double>(plain.iterations), 2);
        if (result.iterations != plain.iterations) continue;
        const double size = plain.f.cwiseAbs().maxCoeff();
        EXPECT_LE((result.f * (of_mass / of_b) - plain.f).cwiseAbs().maxCoeff(), 1e-9 * size);
      }
    }
    for (const int exponent : {-40, 40}) {
      const double s = std::ldexp(1.0, exponent);
      const LcpProblem scaled =
          LcpProblem::FromFactors("exact", problem.J(), s * s * problem.inverse_mass(), s * problem.b(), bounds);
      const LcpResult result = Solve(scaled, At(1e-6));
      EXPECT_EQ(result.iterations, plain.iterations);
      EXPECT_EQ(result.f * s, plain.f) << problem.id();
    }
  }
}

TEST_P(FirstOrder, AllocatesNothingOncePrepared) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted here";
  CountAllocations(true);
  std::vector<LcpProblem> problems;
  for (const TestProblem& test : EasyProblems()) {
    problems.push_back(test.problem);
    problems.push_back(LcpProblem::FromSparse("sparse", test.problem.SparseA(), test.problem.b()));
  }
  for (const LcpProblem& problem : problems) {
    for (const char* form : {"auto", "matrix-free"}) {
      if (!problem.has_factors() && std::string(form) != "auto") continue;
      const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam(), {{"form", form}});
      LcpResult result;
      result.f.setZero(problem.size());
      solver->Prepare(problem);
      const long before = AllocationCount();
      solver->Solve(problem, At(1e-9), &result);
      EXPECT_EQ(AllocationCount(), before) << problem.id() << " " << form;
      EXPECT_GT(result.iterations, 0);
    }
  }
}

TEST_P(FirstOrder, WarmStartAtTheSolutionTakesNoIteration) {
  for (const TestProblem& test : EasyProblems()) {
    const LcpResult cold = Solve(test.problem, At(1e-9));
    ASSERT_EQ(cold.status, LcpStatus::kSolved);
    LcpOptions options = At(1e-6);
    options.initial_f = &cold.f;
    const LcpResult warm = Solve(test.problem, options);
    EXPECT_EQ(warm.status, LcpStatus::kSolved);
    EXPECT_EQ(warm.iterations, 0) << test.problem.id();
  }
}

double g_clock = 0;
double StepClock() { return g_clock += 1.0; }

// A long chain: tridiagonal A that is given as such.
LcpProblem LongChain(Index n) {
  SparseMatrix A(n, n);
  A.reserve(Eigen::VectorXi::Constant(static_cast<int>(n), 3));
  for (Index i = 0; i < n; ++i) {
    if (i > 0) A.insert(i, i - 1) = -0.5;
    A.insert(i, i) = 1.0;
    if (i + 1 < n) A.insert(i, i + 1) = -0.5;
  }
  MatrixFacts facts;
  facts.symmetric = facts.positive_semidefinite = true;
  return LcpProblem::FromSparse("long-chain", A, Eigen::VectorXd::Constant(n, -1.0), {}, facts);
}

TEST_P(FirstOrder, ReadsTheClockOftenWithinAnIteration) {
  constexpr Index kRows = 4 * PacedPasses::kEntriesPerClockRead;
  const LcpProblem problem = LongChain(kRows);
  LcpOptions options = At(1e-9);
  options.now = &StepClock;
  options.time_limit_s = 0.5;  // over at the first reading
  const LcpResult late = Solve(problem, options);
  EXPECT_EQ(late.status, LcpStatus::kTimeLimit);
  EXPECT_EQ(late.iterations, 0);
  EXPECT_TRUE(late.f.allFinite());

  options.time_limit_s = 1e9;
  options.max_iterations = 5;
  g_clock = 0;
  const LcpResult limited = Solve(problem, options);
  EXPECT_EQ(limited.status, LcpStatus::kIterationLimit);
  // Every iteration multiplies by every entry of A at least once, and two of three are off the diagonal.
  EXPECT_GE(g_clock, 5.0 * 2 * kRows / PacedPasses::kEntriesPerClockRead);
}

TEST_P(FirstOrder, InfeasibleProblemsEndAtALimitWithAFiniteIterate) {
  Eigen::MatrixXd A(2, 2);
  A << 1, -1, -1, 1;
  MatrixFacts facts;
  facts.symmetric = facts.positive_semidefinite = true;
  const LcpProblem jam = LcpProblem::FromDense("jam", A, Eigen::Vector2d(-1, -1), {}, facts);
  LcpOptions options = At(1e-6);
  options.max_iterations = 500;
  const LcpResult result = Solve(jam, options);
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  EXPECT_TRUE(result.f.allFinite());
}

TEST_P(FirstOrder, OnlySweepsTakeANonsymmetricA) {
  Eigen::MatrixXd A(2, 2);
  A << 1, 10, -10, 1;
  const LcpProblem problem = LcpProblem::FromDense("rotation", A, Eigen::Vector2d(-1, -1));
  const bool is_refused = Solve(problem, At(1e-6)).status == LcpStatus::kUnsupported;
  EXPECT_EQ(is_refused, GetParam() == "nncg" || GetParam() == "apgd");
}

}  // namespace
}  // namespace lcpbench
