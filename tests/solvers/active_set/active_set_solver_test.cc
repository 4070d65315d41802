// What is particular to the active-set solver; what it shares with the other direct solvers is in
// direct_solvers_*test.cc, the contract of all solvers in contract_test.cc.

#include "solvers/active_set/active_set_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

LcpResult SolveWith(const ActiveSetOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  ActiveSetSolver solver(method);
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

LcpProblem CyclingProblem() {
  Eigen::MatrixXd A(3, 3);
  A << 5, -9, -8,  //
      -9, 19, 15,  //
      -8, 15, 13;
  return LcpProblem::FromDense("cycling", A, Eigen::Vector3d(2, -1, -3), {}, SymmetricPsd());
}

TEST(ActiveSet, LeavesACycleOfBlocksByContinuation) {
  const LcpProblem problem = CyclingProblem();
  BppOptions impatient;
  impatient.end_when_cycling = true;
  BppSolver blocks(impatient);
  LcpResult cycling;
  blocks.Solve(problem, {}, &cycling);
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
