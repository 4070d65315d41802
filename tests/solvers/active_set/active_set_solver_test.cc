// What is particular to block principal pivoting, alone and followed by continuation, and to the proximal semismooth
// Newton method: few factorizations where block pivoting cycles, forces that stay positive on redundant contacts, the
// clock. What they share with the other direct solvers is in direct_solvers_test.cc, the contract of all solvers in
// contract_test.cc.

#include "solvers/active_set/bpp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <string>

#include "solvers/active_set/semismooth_newton.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Form = BppOptions::Form;

LcpResult SolveWith(const BppOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  BppSolver solver(method);
  return SolveWith(&solver, problem, options);
}

LcpResult SolveWith(const SemismoothNewtonOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  SemismoothNewtonSolver solver(method);
  return SolveWith(&solver, problem, options);
}

BppOptions ByContinuation() { return {.continuation_rows = 1}; }

// Blocks alone come back to a set F that they had before.
LcpProblem CyclingProblem() {
  Eigen::Matrix3d A;
  A << 5, -9, -8,  //
      -9, 19, 15,  //
      -8, 15, 13;
  return LcpProblem::FromDense("cycling", A, Eigen::Vector3d(2, -1, -3), {}, SymmetricPsd());
}

// Both remedies lead out.
TEST(Bpp, LeavesACycleOfBlocks) {
  const LcpProblem problem = CyclingProblem();
  BppOptions blocks_only;
  blocks_only.patience = 100;
  blocks_only.largest_proximal = blocks_only.proximal;
  EXPECT_EQ(SolveWith(blocks_only, problem, {.max_iterations = 90}).status, LcpStatus::kIterationLimit);

  BppOptions papers = blocks_only;
  papers.patience = 3;
  const LcpResult by_single_exchanges = SolveWith(papers, problem);
  ExpectSolved(problem, by_single_exchanges);
  EXPECT_NE(by_single_exchanges.detail.find("single exchange"), std::string::npos);
  EXPECT_LE(by_single_exchanges.iterations, 12);

  const LcpResult by_a_heavier_term = SolveWith(BppOptions{}, problem);
  ExpectSolved(problem, by_a_heavier_term);
  EXPECT_EQ(by_a_heavier_term.detail, "");
}

TEST(Bpp, TakesOneFactorizationWhereAllRowsAct) {
  for (const Index n : {1, 5, 40}) {
    const MatrixXd A = 2 * MatrixXd::Identity(n, n) + MatrixXd::Ones(n, n);
    const LcpResult result =
        SolveWith(BppOptions{}, LcpProblem::FromDense("all-act", A, -VectorXd::Ones(n), {}, SymmetricPsd()));
    EXPECT_EQ(result.status, LcpStatus::kSolved);
    EXPECT_EQ(result.iterations, 1);
    EXPECT_LE((result.f.array() - 1 / (2 + static_cast<double>(n))).abs().maxCoeff(), 1e-15);
  }
}

TEST(Bpp, TakesTheSparseFormWhereTheDenseOneIsTooLarge) {
  BppOptions small;
  small.max_dense_rows = 7;
  EXPECT_EQ(SolveWith(small, PlantedProblem(8, 4, 1, 0, 0).problem).status, LcpStatus::kSolved);
}

TEST(ActiveSet, LeavesACycleOfBlocksByContinuation) {
  const LcpProblem problem = CyclingProblem();
  BppOptions impatient;
  impatient.end_when_cycling = true;
  const LcpResult cycling = SolveWith(impatient, problem);
  ASSERT_EQ(cycling.status, LcpStatus::kNumericalFailure);
  EXPECT_EQ(cycling.detail, "blocks cycle");

  const LcpResult result = SolveWith(ByContinuation(), problem);
  ExpectSolved(problem, result);
  EXPECT_GT(result.iterations, cycling.iterations);
}

TEST(ActiveSet, CountsTheIterationsOfBothMethodsAgainstTheLimit) {
  const LcpProblem problem = CyclingProblem();
  const LcpResult all = SolveWith(ByContinuation(), problem);
  LcpOptions options;
  for (options.max_iterations = 1; options.max_iterations < all.iterations; ++options.max_iterations) {
    const LcpResult result = SolveWith(ByContinuation(), problem, options);
    EXPECT_LE(result.iterations, options.max_iterations);
    EXPECT_TRUE(result.status == LcpStatus::kSolved || result.status == LcpStatus::kIterationLimit) << result.status;
  }
}

// Unit masses in a row pushed along it by random loads: what one of them does reaches far, which makes plain exchange
// of all wrong rows cycle.
LcpProblem Chain(Index n, unsigned seed) {
  const LcpProblem column = Column(n, seed);
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(3 * n);
  std::mt19937_64 random(seed);
  for (Index k = 0; k < n; ++k) acceleration[3 * k + 1] = Uniform(&random, -9, 7);
  return column.WithB(column.J() * acceleration);
}

// A bar on supports in line at these arms: rank 2, and every split of its weight is a solution.
LcpProblem Bar(const std::string& id, const Eigen::VectorXd& arms, const Eigen::VectorXd& b) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(arms.size(), 3);
  J.col(1).setOnes();
  J.col(2) = arms;
  return LcpProblem::FromFactors(id, J.sparseView(), Eigen::Vector3d(1, 1, 3), b);
}

TEST(SemismoothNewton, NeedsFewFactorizationsOnLongChains) {
  for (const int n : {100, 1000, 10000}) {
    const LcpProblem problem = Chain(n, 5);
    const LcpResult result = SolveWith(SemismoothNewtonOptions{}, problem);
    ExpectSolved(problem, result);
    // Continuation, from 2000 rows on, takes more but shorter ways.
    EXPECT_LT(result.iterations, n < SemismoothNewtonOptions().continuation_rows ? 60 : 120) << n;
  }
}

TEST(SemismoothNewton, WeightsChangeThePathAndNotTheAnswer) {
  for (const TestProblem& test : GeneratedProblems()) {
    if (test.reference.status != LcpReference::Status::kSolved) continue;
    for (const double first : {1.0, 1e-2, 1e-6}) {
      SCOPED_TRACE(first);
      ExpectSolved(test.problem, SolveWith(SemismoothNewtonOptions{.first_weight = first}, test.problem));
    }
  }
}

TEST(SemismoothNewton, ForcesOnRedundantContactsArePositiveWhereTheyCanBe) {
  for (const int k : {3, 5, 20}) {  // the proximal split is spread
    const LcpProblem problem = Bar("bar", Eigen::VectorXd::LinSpaced(k, -1, 1), Eigen::VectorXd::Constant(k, -9.81));
    const LcpResult result = SolveWith(SemismoothNewtonOptions{}, problem);
    ExpectSolved(problem, result);
    EXPECT_GT(result.f.minCoeff(), 0);
    EXPECT_NEAR(result.f.sum(), 9.81, 1e-9);
  }
}

// What b says of dependent rows contradicts itself by rounding, so that no f solves the problem exactly and the nearest
// ones differ by large multiples of the null space.
TEST(SemismoothNewton, SolvesWhatIsConsistentUpToRoundingOnly) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    const int supports = 3 + static_cast<int>(seed % 8);
    Eigen::VectorXd arms(supports), b(supports);
    for (int i = 0; i < supports; ++i) {
      arms[i] = i < 2 ? 2.0 * i - 1 : Uniform(&random, -1, 1);
      b[i] = -9.81 + 3 * arms[i] + 1e-13 * Uniform(&random, -1, 1);
    }
    const LcpProblem problem = Bar("bar-" + std::to_string(seed), arms, b);
    ExpectSolved(problem, SolveWith(SemismoothNewtonOptions{}, problem));
  }
}

TEST(SemismoothNewton, ReadsTheClockWithinAFactorization) {
  const LcpProblem problem = Chain(200, 1);
  for (const double limit : {0.5, 3.0, 7.0}) {
    ticks = 0;
    const LcpResult result =
        SolveWith(SemismoothNewtonOptions{}, problem, {.time_limit_s = limit, .now = &TickingClock});
    EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << limit;
    EXPECT_LE(ticks, limit + 3) << "every read of the clock counts one, and the limit must end it at once";
    EXPECT_TRUE(result.f.allFinite());
  }
}

}  // namespace
}  // namespace lcpbench
