// The factors of the active block: both forms against Eigen's, for sets of active rows that change by a few.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/in_sequence.h"
#include "solvers/linear_algebra/active_block.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void FlipSome(int most, TestRandom* random, std::vector<char>* active) {
  for (int k = random->Integer(1, most); k > 0; --k) {
    char& flag = (*active)[static_cast<size_t>(random->Integer(0, static_cast<int>(active->size()) - 1))];
    flag = flag == 0 ? 1 : 0;
  }
}

VectorXd RandomSide(Index n, TestRandom* random) {
  VectorXd right(n);
  for (double& value : right) value = random->Integer(-9, 9);
  return right;
}

void LoadUnscaled(const LcpProblem& problem, ActiveBlock* block) {
  block->Analyze(problem);
  block->Load(problem, VectorXd::Ones(problem.size()));
}

template <typename Block>
class ActiveBlockTest : public testing::Test {};

using Forms = testing::Types<SparseActiveBlock, DenseActiveBlock>;
TYPED_TEST_SUITE(ActiveBlockTest, Forms);

TYPED_TEST(ActiveBlockTest, SolvesForChangingSets) {
  for (const Index n : {1, 2, 7, 16, 17, 40, 75, 95}) {
    for (const Index bodies : {1 + n / 4, 1 + n / 2, 2 * n}) {
      const LcpProblem problem = PlantedProblem(n, static_cast<int>(bodies), static_cast<unsigned>(n), 0, 0).problem;
      SCOPED_TRACE(problem.id() + " of " + std::to_string(bodies));
      TestRandom random(static_cast<unsigned>(n));
      VectorXd scale(n);
      for (double& s : scale) s = random.Integer(1, 4);
      const MatrixXd A = scale.asDiagonal() * problem.DenseA() * scale.asDiagonal();
      TypeParam block;
      block.Analyze(problem);
      block.Load(problem, scale);
      std::vector<char> active(static_cast<size_t>(n), 1);
      double shift = 0.25;
      for (int change = 0; change < 30; ++change) {
        if (change % 10 == 9) shift /= 4;
        ASSERT_TRUE(block.Factor(active, shift, nullptr));
        VectorXd right = RandomSide(n, &random);
        VectorXd x = right;
        block.Solve(x.data());
        // Rows outside: the unit matrix and a right-hand side of 0.
        MatrixXd K = A;
        K.diagonal() *= 1 + shift;
        for (Index i = 0; i < n; ++i) {
          if (active[static_cast<size_t>(i)] != 0) continue;
          K.row(i).setZero();
          K.col(i).setZero();
          K(i, i) = 1;
          right[i] = 0;
        }
        const VectorXd expected = K.llt().solve(right);
        EXPECT_LE((x - expected).norm(), 1e-11 * (1 + expected.norm())) << "change " << change;
        VectorXd product(n);
        block.Multiply(x.data(), product.data());
        EXPECT_LE((product - A * x).norm(), 1e-12 * (1 + (A * x).norm()));
        FlipSome(3, &random, &active);
      }
    }
  }
}

// Singular blocks: pivots are held to the shift, and the residual is small though x is not determined by A.
TYPED_TEST(ActiveBlockTest, HoldsPivotsOfSingularBlocksToTheShift) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = PlantedProblem(40, 4, seed, 0, 0).problem;
    const Index n = problem.size();
    const std::vector<char> active(static_cast<size_t>(n), 1);
    TypeParam block;
    LoadUnscaled(problem, &block);
    block.Factor(active, 1e-8, nullptr);
    const VectorXd right = problem.DenseA() * VectorXd::Ones(n);
    VectorXd x = right;
    block.Solve(x.data());
    EXPECT_LE((problem.DenseA() * x - right).norm(), 1e-6 * (1 + right.norm())) << "seed " << seed;
  }
}

TEST(SparseActiveBlock, AnUpdatedFactorIsTheFreshOneToTheLastBit) {
  const Index n = 60;
  const LcpProblem problem = PlantedProblem(n, 25, 5, 0, 0).problem;
  SparseActiveBlock updated;
  LoadUnscaled(problem, &updated);
  SparseActiveBlock fresh;
  LoadUnscaled(problem, &fresh);
  TestRandom random(7);
  std::vector<char> active(static_cast<size_t>(n), 1);
  for (int change = 0; change < 50; ++change) {
    updated.Factor(active, 1e-6, nullptr);
    fresh.Load(problem, VectorXd::Ones(n));
    fresh.Factor(active, 1e-6, nullptr);
    VectorXd x = VectorXd::LinSpaced(n, -1, 1);
    VectorXd y = x;
    updated.Solve(x.data());
    fresh.Solve(y.data());
    EXPECT_TRUE(x == y) << "change " << change;
    FlipSome(1, &random, &active);
  }
}

// In a sequence, where the analysis of equal patterns is kept: the factor is right whatever was before.
TEST(SparseActiveBlock, FactorsTheNextProblemOfASequenceAsAFreshOneDoes) {
  const InSequence::Scope sequence(true);
  SparseActiveBlock kept;
  for (const unsigned seed : {1U, 1U, 2U, 3U, 3U, 1U}) {
    const LcpProblem problem = PlantedProblem(100, 20, seed, 5, 4).problem;
    const Index n = problem.size();
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
    const std::vector<char> active(static_cast<size_t>(n), 1);
    SparseActiveBlock fresh;
    Eigen::VectorXd x = ones, y = ones;
    for (const auto& [block, solution] : {std::pair(&kept, &x), std::pair(&fresh, &y)}) {
      block->Analyze(problem);
      block->Load(problem, ones);
      ASSERT_TRUE(block->Factor(active, 1e-3, nullptr));
      block->Solve(solution->data());
    }
    EXPECT_EQ(x, y) << seed;
  }
}

}  // namespace
}  // namespace lcpbench
