// What is particular to block principal pivoting, alone and followed by continuation; what it shares with the other
// direct solvers is in direct_solvers_test.cc, the contract of all solvers in contract_test.cc.

#include "solvers/active_set/active_set_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

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

LcpResult SolveWith(const ActiveSetOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  ActiveSetSolver solver(method);
  return SolveWith(&solver, problem, options);
}

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
  LcpOptions limited;
  limited.max_iterations = 90;
  EXPECT_EQ(SolveWith(blocks_only, problem, limited).status, LcpStatus::kIterationLimit);

  BppOptions papers = blocks_only;
  papers.patience = 3;
  const LcpResult by_single_exchanges = SolveWith(papers, problem);
  EXPECT_EQ(by_single_exchanges.status, LcpStatus::kSolved);
  EXPECT_NE(by_single_exchanges.detail.find("single exchange"), std::string::npos);
  EXPECT_TRUE(Verify(problem, by_single_exchanges, 1e-9).passes);
  EXPECT_LE(by_single_exchanges.iterations, 12);

  const LcpResult by_a_heavier_term = SolveWith(BppOptions{}, problem);
  EXPECT_EQ(by_a_heavier_term.status, LcpStatus::kSolved);
  EXPECT_EQ(by_a_heavier_term.detail, "");
  EXPECT_TRUE(Verify(problem, by_a_heavier_term, 1e-9).passes);
}

TEST(Bpp, TakesOneFactorisationWhereAllRowsAct) {
  for (const Index n : {1, 5, 40}) {
    const MatrixXd A = 2 * MatrixXd::Identity(n, n) + MatrixXd::Ones(n, n);
    const LcpResult result =
        SolveWith(BppOptions{}, LcpProblem::FromDense("all-act", A, -VectorXd::Ones(n), {}, SymmetricPsd()));
    EXPECT_EQ(result.status, LcpStatus::kSolved);
    EXPECT_EQ(result.iterations, 1);
    EXPECT_LE((result.f.array() - 1 / (2 + static_cast<double>(n))).abs().maxCoeff(), 1e-15);
  }
}

TEST(Bpp, ReadsTheClockBeforeEachFactorisation) {
  const TestProblem test = PlantedProblem(60, 30, 4, 0, 0);
  // One that passes the limit at the third read stops the second.
  static int reads;
  reads = 0;
  LcpOptions options;
  options.time_limit_s = 1;
  options.now = [] { return ++reads > 2 ? 2.0 : 0.0; };
  const LcpResult result = SolveWith(BppOptions{}, test.problem, options);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_GE(result.f.minCoeff(), 0);
}

TEST(Bpp, TakesTheSparseFormWhereTheDenseOneIsTooLarge) {
  BppOptions small;
  small.max_dense_rows = 7;
  EXPECT_EQ(SolveWith(small, PlantedProblem(8, 4, 1, 0, 0).problem).status, LcpStatus::kSolved);
}

TEST(Bpp, ReadsItsSettings) {
  const BppOptions options = BppOptions::FromSettings(
      {{"form", "sparse"}, {"proximal", "1e-5"}, {"largest_proximal", "1e-3"}, {"patience", "7"}});
  EXPECT_EQ(options.form, Form::kSparse);
  EXPECT_EQ(options.proximal, 1e-5);
  EXPECT_EQ(options.largest_proximal, 1e-3);
  EXPECT_EQ(options.patience, 7);
  EXPECT_THROW(BppOptions::FromSettings({{"form", "banded"}}), InputError);
}

TEST(ActiveSet, LeavesACycleOfBlocksByContinuation) {
  const LcpProblem problem = CyclingProblem();
  BppOptions impatient;
  impatient.end_when_cycling = true;
  const LcpResult cycling = SolveWith(impatient, problem);
  ASSERT_EQ(cycling.status, LcpStatus::kNumericalFailure);
  EXPECT_EQ(cycling.detail, "blocks cycle");

  ActiveSetOptions method;
  method.newton.continuation_rows = 1;
  const LcpResult result = SolveWith(method, problem);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
  EXPECT_GT(result.iterations, cycling.iterations);
  EXPECT_TRUE(Verify(problem, result, 1e-9).passes);
}

TEST(ActiveSet, CountsTheIterationsOfBothMethodsAgainstTheLimit) {
  ActiveSetOptions method;
  method.newton.continuation_rows = 1;
  const LcpProblem problem = CyclingProblem();
  const LcpResult all = SolveWith(method, problem);
  LcpOptions options;
  for (options.max_iterations = 1; options.max_iterations < all.iterations; ++options.max_iterations) {
    const LcpResult result = SolveWith(method, problem, options);
    EXPECT_LE(result.iterations, options.max_iterations);
    EXPECT_TRUE(result.status == LcpStatus::kSolved || result.status == LcpStatus::kIterationLimit) << result.status;
  }
}

TEST(ActiveSet, GivesTheSameBitsEveryTime) {
  ActiveSetOptions method;
  method.newton.continuation_rows = 1;
  method.blocks.form = BppOptions::Form::kBodies;
  const TestProblem test = PlantedProblem(60, 30, 4, 0, 0);
  const LcpResult first = SolveWith(method, test.problem);
  const LcpResult second = SolveWith(method, test.problem);
  EXPECT_EQ(first.iterations, second.iterations);
  EXPECT_TRUE(first.f == second.f);
}

TEST(ActiveSet, ReadsItsSettings) {
  const ActiveSetOptions options =
      ActiveSetOptions::FromSettings({{"continuation_rows", "70"}, {"patience", "7"}, {"form", "bodies"}});
  EXPECT_EQ(options.newton.continuation_rows, 70);
  EXPECT_EQ(options.blocks.patience, 7);
  EXPECT_EQ(options.blocks.form, BppOptions::Form::kBodies);
  EXPECT_EQ(ActiveSetOptions::FromSettings({}).blocks.form, BppOptions::Form::kAny);
  EXPECT_THROW(ActiveSetOptions::FromSettings({{"form", "banded"}}), InputError);
}

}  // namespace
}  // namespace lcpbench
