// What is particular to incremental pivoting; what it shares with the other direct solvers is in
// direct_solvers_*test.cc, the contract of all solvers in contract_test.cc.

#include "solvers/pivoting/dantzig.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

TEST(Dantzig, ReadsItsSettings) {
  const DantzigOptions options =
      DantzigOptions::FromSettings({{"rank_tolerance", "1e-10"}, {"order", "most-negative"}});
  EXPECT_EQ(options.rank_tolerance, 1e-10);
  EXPECT_EQ(options.order, DantzigOrder::kMostNegative);
  EXPECT_EQ(DantzigOptions::FromSettings({}).order, DantzigOrder::kIndex);
}

}  // namespace
}  // namespace lcpbench
