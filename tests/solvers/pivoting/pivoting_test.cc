// What is particular to dantzig and lemke; what they share with the other direct solvers is in direct_solvers_test.cc,
// the contract of all solvers in contract_test.cc.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "solvers/lcp/verify.h"
#include "solvers/pivoting/dantzig.h"
#include "solvers/pivoting/lemke.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LcpResult Solve(const LcpProblem& problem, const LcpOptions& options = {}) {
  LemkeSolver solver;
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

TEST(Dantzig, MakesOneMoreRowRightWithEveryPivotWhereNoForceBlocks) {
  const Index n = 12;
  const MatrixXd A = MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Ones(n, n);
  const LcpProblem problem = LcpProblem::FromDense("limits", A, -VectorXd::Ones(n), {}, SymmetricPsd());
  DantzigOptions one_by_one;
  one_by_one.block_start = false;
  DantzigSolver solver(one_by_one);
  for (Index pivots = 1; pivots < n; ++pivots) {
    LcpOptions options;
    options.max_iterations = pivots;
    LcpResult result;
    solver.Solve(problem, options, &result);
    EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(result.iterations, pivots);
    EXPECT_EQ((result.f.array() > 0).count(), pivots);
    EXPECT_GE(result.f.minCoeff(), 0);
  }
}

TEST(Lemke, FollowsThePathOfATwoByTwoProblemByHand) {
  // d = (1, 1), so b + d = (1.5, 0): row 1 enters at z = 1 and f_1 = 1 - z; w_0 = 0.5 + z + 0.5 f_1 stays positive.
  MatrixXd A(2, 2);
  A << 1, 0.5,  //
      0.5, 1;
  const LcpResult result = Solve(LcpProblem::FromDense("by-hand", A, Eigen::Vector2d(0.5, -1), {}, SymmetricPsd()));
  EXPECT_EQ(result.status, LcpStatus::kSolved);
  EXPECT_DOUBLE_EQ(result.f[0], 0);
  EXPECT_DOUBLE_EQ(result.f[1], 1);
  EXPECT_EQ(result.iterations, 2) << "one event at z = 1, and the step to z = 0";
}

TEST(Lemke, TakesFewPivotsOnFullyDegenerateProblems) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    const LcpProblem problem = FullyDegenerate(seed, 40);
    const LcpResult result = Solve(problem);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
    EXPECT_LE(result.iterations, 4 * problem.size() + 4) << "seed " << seed;
  }
}

// All contacts of a symmetric problem reach 0 at the same z, so that every pivot is a tie: without an order among tied
// rows the path may go round.
TEST(Lemke, ResolvesTiesOfEqualRows) {
  for (const Index n : {2, 3, 8, 25, 60}) {
    for (const double coupling : {0.0, 0.5, 1.0}) {
      const MatrixXd A = (1 - coupling) * MatrixXd::Identity(n, n) + coupling * MatrixXd::Ones(n, n);
      const LcpProblem problem = LcpProblem::FromDense("equal-rows", A, -VectorXd::Ones(n), {}, SymmetricPsd());
      const LcpResult result = Solve(problem);
      EXPECT_EQ(result.status, LcpStatus::kSolved) << n << " " << coupling << ": " << result.detail;
      EXPECT_LE(result.iterations, 2 * n + 2) << coupling;
      if (coupling == 1.0) {
        EXPECT_NEAR(result.f.sum(), 1, 1e-14);  // one row carries all
      } else {
        EXPECT_LE((result.f.array() - 1 / (1 + coupling * static_cast<double>(n - 1))).abs().maxCoeff(), 1e-14);
      }
    }
  }
}

TEST(Pivoting, ReadsItsSettings) {
  const DantzigOptions options =
      DantzigOptions::FromSettings({{"rank_tolerance", "1e-10"}, {"order", "most-negative"}});
  EXPECT_EQ(options.rank_tolerance, 1e-10);
  EXPECT_EQ(options.order, DantzigOrder::kMostNegative);
  EXPECT_TRUE(options.block_start);
  EXPECT_FALSE(LemkeOptions::FromSettings({}).block_start);
  EXPECT_THROW(LemkeOptions::FromSettings({{"rank_tolerance", "0"}}), InputError);
}

}  // namespace
}  // namespace lcpbench
