// Warm starts, limits, refusals and allocations of all direct solvers.

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "tests/solvers/direct_solvers.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class DirectSolversLimits : public DirectSolverTest {
 protected:
  struct Iterations {
    std::int64_t cold = 0;
    std::int64_t warm = 0;
  };
  Iterations SolveTwice(const TestProblem& test) {
    const LcpResult cold = Solve(test.problem);
    LcpOptions options;
    options.initial_f = &cold.f;
    const LcpResult warm = Solve(test.problem, options);
    ExpectSolved(test, warm);
    return {cold.iterations, warm.iterations};
  }
};

std::vector<DirectSolver> Those(bool (*are_meant)(const DirectSolver& direct)) {
  std::vector<DirectSolver> those;
  std::copy_if(DirectSolvers().begin(), DirectSolvers().end(), std::back_inserter(those), are_meant);
  return those;
}

class DirectSolversRowLimit : public DirectSolverTest {};
class DirectSolversAllocations : public DirectSolverTest {};

INSTANTIATE_TEST_SUITE_P(All, DirectSolversLimits, testing::ValuesIn(DirectSolvers()), NameOf);
INSTANTIATE_TEST_SUITE_P(WhereThereIsOne, DirectSolversRowLimit,
                         testing::ValuesIn(Those([](const DirectSolver& d) { return d.row_limit != nullptr; })),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(OfThoseThatPromiseNone, DirectSolversAllocations,
                         testing::ValuesIn(Those([](const DirectSolver& d) { return !d.allocates; })), NameOf);

TEST_P(DirectSolversLimits, AStartFromTheAnswerTakesFewIterations) {
  constexpr unsigned kProblems = 300;
  Iterations full_rank;
  Iterations redundant;
  for (unsigned seed = 0; seed < kProblems; ++seed) {
    SCOPED_TRACE(seed);
    const Iterations full = SolveTwice(PlantedProblem(30, 40, seed, seed % 2 == 0 ? 5 : 0, 0));
    full_rank.cold += full.cold;
    full_rank.warm += full.warm;
    const Iterations other = SolveTwice(PlantedExactly(seed, 30, false));
    redundant.cold += other.cold;
    redundant.warm += other.warm;
  }
  EXPECT_GE(full_rank.cold, kProblems / 2);  // some start from blocks of rows, and count these as none
  EXPECT_LE(static_cast<double>(full_rank.warm), GetParam().warm_iterations * kProblems);
  EXPECT_LE(static_cast<double>(redundant.warm), GetParam().warm_part * static_cast<double>(redundant.cold));
}

TEST_P(DirectSolversLimits, AWrongStartDoesNoHarm) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const TestProblem test = PlantedExactly(seed, 30, false);
    TestRandom random(seed + 1000);
    VectorXd start(test.problem.size());
    for (Index i = 0; i < start.size(); ++i) start[i] = random.Integer(-3, 3);
    LcpOptions options;
    options.initial_f = &start;
    Judge(test, Solve(test.problem, options));
  }
  ExpectUndecided(GetParam().undecided);
}

TEST_P(DirectSolversLimits, ALimitOfIterationsIsMetAndLeavesNonnegativeForces) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const TestProblem test = PlantedProblem(60, 30, seed, 0, 0);
    const std::int64_t needed = Solve(test.problem).iterations;
    for (std::int64_t limit = 1; limit < needed; limit += 1 + needed / 10) {
      LcpOptions options;
      options.max_iterations = limit;
      const LcpResult result = Solve(test.problem, options);
      if (result.status == LcpStatus::kSolved) continue;
      EXPECT_EQ(result.status, LcpStatus::kIterationLimit) << limit << ": " << result.detail;
      EXPECT_EQ(result.iterations, limit);
      EXPECT_TRUE(result.f.allFinite());
      EXPECT_GE(result.f.minCoeff(), 0) << limit;
    }
  }
}

TEST_P(DirectSolversLimits, AnExpiredClockEndsTheSolve) {
  const TestProblem test = PlantedProblem(60, 30, 4, 0, 0);
  LcpOptions options;
  options.time_limit_s = 1;
  options.now = [] {
    static double time = 0;
    return time += 2;
  };
  const LcpResult result = Solve(test.problem, options);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << result.detail;
  EXPECT_TRUE(result.f.allFinite());
  EXPECT_GE(result.f.minCoeff(), 0);
}

TEST_P(DirectSolversLimits, AsymmetricMatricesAndNegativeDiagonalsAreUnsupported) {
  MatrixXd A = MatrixXd::Identity(2, 2);
  A(0, 1) = 0.5;
  EXPECT_EQ(Solve(LcpProblem::FromDense("asymmetric", A, VectorXd::Ones(2))).status, LcpStatus::kUnsupported);
  const LcpResult negative = Solve(LcpProblem::FromDense("negative", -MatrixXd::Identity(2, 2), VectorXd::Ones(2)));
  EXPECT_EQ(negative.status, LcpStatus::kUnsupported) << negative.detail;
  EXPECT_FALSE(negative.detail.empty());
}

TEST_P(DirectSolversRowLimit, MoreRowsThanItsArraysAreMeantForAreUnsupported) {
  const LcpProblem problem = PlantedProblem(8, 4, 1, 0, 0).problem;
  Settings settings = GetParam().settings;
  for (const bool fits : {false, true}) {
    settings[GetParam().row_limit] = fits ? "8" : "7";
    LcpResult result;
    MakeSolver(GetParam().key, settings)->Solve(problem, {}, &result);
    EXPECT_EQ(result.status, fits ? LcpStatus::kSolved : LcpStatus::kUnsupported);
    EXPECT_TRUE(fits || result.detail.find(GetParam().row_limit) != std::string::npos) << result.detail;
  }
}

TEST_P(DirectSolversLimits, NothingWrongIsClaimedForAMatrixThatIsNotPsd) {
  MatrixXd A(2, 2);
  A << 1, -2, -2, 1;  // indefinite, without a solution
  const LcpProblem problem = LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -1));
  const LcpResult result = Solve(problem);
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  EXPECT_TRUE(result.status == LcpStatus::kIterationLimit || !result.detail.empty());
  for (unsigned seed = 1; seed <= 50; ++seed) {
    TestRandom random(seed);
    MatrixXd B = MatrixXd::Identity(6, 6);
    VectorXd b(6);
    for (Index i = 0; i < 6; ++i) {
      for (Index j = 0; j < i; ++j) B(i, j) = B(j, i) = random.Integer(-200, 200) / 100.0;
      b[i] = random.Integer(-100, 100) / 100.0;
    }
    const LcpProblem other = LcpProblem::FromDense("indefinite-" + std::to_string(seed), B, b);
    const LcpResult claim = Solve(other);
    const Verdict verdict = Verify(other, claim, 1e-9);
    EXPECT_FALSE(verdict.false_success) << seed;
    EXPECT_FALSE(verdict.false_infeasible) << seed;
  }
}

TEST_P(DirectSolversAllocations, SolvingAgainDoesNotAllocate) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  CountAllocations(true);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const TestProblem dense = PlantedExactly(seed, 60, false);
    const Index n = dense.problem.size();
    // The same kind of problem by factors, where w goes through body space.
    SparseMatrix J = MatrixXd(MatrixXd::Identity(n, n)).sparseView();
    for (Index i = 0; i + 1 < n; ++i) J.coeffRef(i, i + 1) = -0.5;
    const LcpProblem by_factors =
        LcpProblem::FromFactors("chain", J, VectorXd::Ones(n), VectorXd::LinSpaced(n, -1, 0.5));
    for (const LcpProblem& problem : {dense.problem, by_factors, PlantedProblem(40, 30, seed, 5, 3).problem}) {
      const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam().key, GetParam().settings);
      solver->Reserve(problem.size());
      solver->Prepare(problem);
      LcpResult result;
      solver->Solve(problem, {}, &result);
      ASSERT_EQ(result.status, LcpStatus::kSolved);
      const VectorXd f = result.f;
      LcpOptions warm;
      warm.initial_f = &f;
      const long before = AllocationCount();
      solver->Solve(problem, {}, &result);
      solver->Solve(problem, warm, &result);
      EXPECT_EQ(AllocationCount() - before, 0) << "seed " << seed << ", " << problem.id();
      EXPECT_EQ(result.status, LcpStatus::kSolved);
    }
  }
}

}  // namespace
}  // namespace lcpbench
