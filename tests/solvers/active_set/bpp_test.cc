// What is particular to block principal pivoting; what it shares with the other direct solvers is in
// direct_solvers_*test.cc, the contract of all solvers in contract_test.cc.

#include "solvers/active_set/bpp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Form = BppOptions::Form;

LcpResult SolveWith(const BppOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  BppSolver solver(method);
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

// Blocks alone come back to a set F that they had before; both remedies lead out.
TEST(Bpp, LeavesACycleOfBlocks) {
  MatrixXd A(3, 3);
  A << 5, -9, -8,  //
      -9, 19, 15,  //
      -8, 15, 13;
  const LcpProblem problem = LcpProblem::FromDense("cycling", A, Eigen::Vector3d(2, -1, -3), {}, SymmetricPsd());

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

  const LcpResult by_a_heavier_term = SolveWith({}, problem);
  EXPECT_EQ(by_a_heavier_term.status, LcpStatus::kSolved);
  EXPECT_EQ(by_a_heavier_term.detail, "");
  EXPECT_TRUE(Verify(problem, by_a_heavier_term, 1e-9).passes);
}

TEST(Bpp, TakesOneFactorisationWhereAllRowsAct) {
  for (const Index n : {1, 5, 40}) {
    const MatrixXd A = 2 * MatrixXd::Identity(n, n) + MatrixXd::Ones(n, n);
    const LcpResult result = SolveWith({}, LcpProblem::FromDense("all-act", A, -VectorXd::Ones(n), {}, SymmetricPsd()));
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
  const LcpResult result = SolveWith({}, test.problem, options);
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

}  // namespace
}  // namespace lcpbench
