// What is particular to dantzig, lemke and their factor; what they share with the other direct solvers is in
// direct_solvers_test.cc, the contract of all solvers in contract_test.cc.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "solvers/linear_algebra/dense_ldlt.h"
#include "solvers/pivoting/dantzig.h"
#include "solvers/pivoting/lemke.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LcpResult Solve(const LcpProblem& problem) {
  LemkeSolver solver;
  return SolveWith(&solver, problem);
}

TEST(Dantzig, MakesOneMoreRowRightWithEveryPivotWhereNoForceBlocks) {
  const Index n = 12;
  const MatrixXd A = MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Ones(n, n);
  const LcpProblem problem = LcpProblem::FromDense("limits", A, -VectorXd::Ones(n), {}, SymmetricPsd());
  DantzigOptions one_by_one;
  one_by_one.block_start = false;
  DantzigSolver solver(one_by_one);
  for (Index pivots = 1; pivots < n; ++pivots) {
    const LcpResult result = SolveWith(&solver, problem, {.max_iterations = pivots});
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

MatrixXd Lower(const DenseLdlt& factor) {
  MatrixXd L = MatrixXd::Identity(factor.size(), factor.size());
  for (Index k = 0; k < factor.size(); ++k) {
    for (Index i = k + 1; i < factor.size(); ++i) L(i, k) = factor.lower(i, k);
  }
  return L;
}

void Enter(const MatrixXd& A, const std::vector<Index>& rows, Index row, DenseLdlt* factor) {
  VectorXd z = A(rows, row);
  factor->ForwardSolve(z.data());
  factor->Append(z.data(), factor->PivotOf(z.data(), A(row, row)));
}

TEST(DenseLdlt, AFactorUpdatedManyTimesEqualsAFreshOne) {
  for (const Index n : {1, 2, 7, 8, 40}) {
    TestRandom random(static_cast<unsigned>(n));
    MatrixXd G(n, n + 2);
    for (Index i = 0; i < G.size(); ++i) G(i) = random.Integer(-9, 9);
    const MatrixXd A = G * G.transpose() + MatrixXd::Identity(n, n);
    DenseLdlt updated;
    updated.Reserve(n);
    updated.Reset(n);
    std::vector<Index> inside;
    std::vector<Index> outside = EveryRow(n);
    for (int change = 0; change < 400; ++change) {
      if (inside.empty() || (!outside.empty() && random.Chance(0.6))) {
        const auto pick = static_cast<size_t>(random.Integer(0, static_cast<int>(outside.size()) - 1));
        Enter(A, inside, outside[pick], &updated);
        inside.push_back(outside[pick]);
        outside.erase(outside.begin() + static_cast<std::ptrdiff_t>(pick));
      } else {
        const int pick = random.Integer(0, static_cast<int>(inside.size()) - 1);
        updated.Remove(pick);
        outside.push_back(inside[static_cast<size_t>(pick)]);
        inside.erase(inside.begin() + pick);
      }
    }
    DenseLdlt fresh;
    fresh.Reserve(n);
    fresh.Reset(n);
    std::vector<Index> entered;
    for (const Index row : inside) {
      Enter(A, entered, row, &fresh);
      entered.push_back(row);
    }
    ASSERT_EQ(updated.size(), fresh.size());
    if (fresh.size() == 0) continue;
    const double scale = A.diagonal().maxCoeff();
    for (Index k = 0; k < fresh.size(); ++k) EXPECT_NEAR(updated.pivot(k), fresh.pivot(k), 1e-11 * scale);
    EXPECT_LE((Lower(updated) - Lower(fresh)).cwiseAbs().maxCoeff(), 1e-11) << "n = " << n;
    VectorXd x = VectorXd::LinSpaced(fresh.size(), 1, 2);
    const VectorXd right = x;
    updated.Solve(x.data());
    EXPECT_LE((A(inside, inside) * x - right).cwiseAbs().maxCoeff(), 1e-9);
  }
}

}  // namespace
}  // namespace lcpbench
