// The factors behind block pivoting: both forms against Eigen's, for sets of active rows that change by a few.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "solvers/linear_algebra/dense_active_block.h"
#include "solvers/linear_algebra/sparse_active_block.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows coupled at random: trees, chains and full blocks all occur in the factor.
LcpProblem RandomProblem(Index n, int couplings, unsigned seed) {
  TestRandom random(seed);
  MatrixXd A = MatrixXd::Zero(n, n);
  for (int k = 0; k < couplings; ++k) {
    const Index i = random.Integer(0, static_cast<int>(n) - 1);
    const Index j = random.Integer(0, static_cast<int>(n) - 1);
    VectorXd g = VectorXd::Zero(n);
    g[i] += random.Integer(1, 3);
    g[j] -= random.Integer(1, 3);
    A += g * g.transpose();
  }
  A.diagonal().array() += 0.5;
  return LcpProblem::FromDense("coupled-" + std::to_string(seed), A, VectorXd::Ones(n), {}, SymmetricPsd());
}

template <typename Block>
void ExpectSolvesForChangingSets() {
  for (const Index n : {1, 2, 7, 16, 17, 40, 75}) {
    for (const int couplings : {0, 1, 3, 12}) {
      const LcpProblem problem = RandomProblem(n, couplings * static_cast<int>(n) / 2, static_cast<unsigned>(n));
      SCOPED_TRACE(problem.id() + " with " + std::to_string(couplings));
      TestRandom random(static_cast<unsigned>(n));
      VectorXd scale(n);
      for (double& s : scale) s = random.Integer(1, 4);
      const MatrixXd A = scale.asDiagonal() * problem.DenseA() * scale.asDiagonal();
      Block block;
      block.Analyze(problem);
      block.Load(problem, scale);
      std::vector<char> active(static_cast<size_t>(n), 1);
      double shift = 0.25;
      for (int change = 0; change < 30; ++change) {
        if (change % 10 == 9) shift /= 4;
        block.Factor(active, shift, nullptr);
        VectorXd right(n);
        for (double& value : right) value = random.Integer(-9, 9);
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
        for (int k = random.Integer(1, 3); k > 0; --k) {
          char& flag = active[static_cast<size_t>(random.Integer(0, static_cast<int>(n) - 1))];
          flag = flag == 0 ? 1 : 0;
        }
      }
    }
  }
}

TEST(SparseActiveBlock, SolvesForChangingSets) { ExpectSolvesForChangingSets<SparseActiveBlock>(); }

TEST(DenseActiveBlock, SolvesForChangingSets) { ExpectSolvesForChangingSets<DenseActiveBlock>(); }

TEST(SparseActiveBlock, AnUpdatedFactorIsTheFreshOneToTheLastBit) {
  const Index n = 60;
  const LcpProblem problem = RandomProblem(n, 90, 5);
  const VectorXd scale = VectorXd::Ones(n);
  SparseActiveBlock updated;
  updated.Analyze(problem);
  updated.Load(problem, scale);
  SparseActiveBlock fresh;
  fresh.Analyze(problem);
  TestRandom random(7);
  std::vector<char> active(static_cast<size_t>(n), 1);
  for (int change = 0; change < 50; ++change) {
    updated.Factor(active, 1e-6, nullptr);
    fresh.Load(problem, scale);
    fresh.Factor(active, 1e-6, nullptr);
    VectorXd x = VectorXd::LinSpaced(n, -1, 1);
    VectorXd y = x;
    updated.Solve(x.data());
    fresh.Solve(y.data());
    EXPECT_TRUE(x == y) << "change " << change;
    char& flag = active[static_cast<size_t>(random.Integer(0, static_cast<int>(n) - 1))];
    flag = flag == 0 ? 1 : 0;
  }
}

// Singular blocks: pivots are held to the shift, and the residual is small though x is not determined by A.
template <typename Block>
void ExpectSmallResidualOnSingularBlocks() {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = FullyDegenerate(seed, 40);
    const Index n = problem.size();
    std::vector<char> active(static_cast<size_t>(n));
    for (Index i = 0; i < n; ++i) active[static_cast<size_t>(i)] = problem.DiagonalA()[i] > 0 ? 1 : 0;
    Block block;
    block.Analyze(problem);
    block.Load(problem, VectorXd::Ones(n));
    block.Factor(active, 1e-8, nullptr);
    const VectorXd right = problem.DenseA() * VectorXd::Ones(n);
    VectorXd x = right;
    block.Solve(x.data());
    EXPECT_LE((problem.DenseA() * x - right).norm(), 1e-6 * (1 + right.norm())) << "seed " << seed;
  }
}

TEST(SparseActiveBlock, HoldsPivotsOfSingularBlocksToTheShift) {
  ExpectSmallResidualOnSingularBlocks<SparseActiveBlock>();
}

TEST(DenseActiveBlock, HoldsPivotsOfSingularBlocksToTheShift) {
  ExpectSmallResidualOnSingularBlocks<DenseActiveBlock>();
}

TEST(ActiveBlock, OnlyAnalyzeAllocates) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  CountAllocations(true);
  const Index n = 300;  // above what a library would keep on the stack
  const LcpProblem problem = RandomProblem(n, 600, 3);
  const VectorXd scale = VectorXd::Ones(n);
  const std::vector<char> active(static_cast<size_t>(n), 1);
  SparseActiveBlock sparse;
  DenseActiveBlock dense;
  VectorXd x = VectorXd::Ones(n);
  VectorXd y = x;
  for (ActiveBlock* block : {static_cast<ActiveBlock*>(&sparse), static_cast<ActiveBlock*>(&dense)}) {
    block->Analyze(problem);
    const long before = AllocationCount();
    block->Load(problem, scale);
    block->Factor(active, 1e-6, nullptr);
    block->Solve(x.data());
    block->Multiply(x.data(), y.data());
    EXPECT_EQ(AllocationCount() - before, 0);
  }
}

}  // namespace
}  // namespace lcpbench
