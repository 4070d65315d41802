#include "solvers/exact/sparse_rank.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <random>

namespace lcpbench {
namespace {

// Products of small integers: the rank is that of the narrow middle, but for bad luck that the seeds do not have.
TEST(SparseRank, IsThatOfTheFactors) {
  std::mt19937 random(1);
  const auto integer = [&random](int most) {
    return static_cast<int>(random() % (2 * static_cast<unsigned>(most) + 1)) - most;
  };
  for (int trial = 0; trial < 200; ++trial) {
    const Index rows = 1 + static_cast<Index>(random() % 20);
    const Index columns = 1 + static_cast<Index>(random() % 20);
    const Index middle = static_cast<Index>(random() % 12);
    Eigen::MatrixXd left(rows, middle);
    Eigen::MatrixXd right(middle, columns);
    for (double& value : left.reshaped()) value = integer(9);
    for (double& value : right.reshaped()) value = integer(9);
    const Eigen::MatrixXd product = left * right;
    // By doubles, which have room for these integers.
    const Index expected = product.size() == 0 || product.isZero(0) ? 0 : product.fullPivLu().rank();
    // Powers of two change nothing, and reach far beyond what a difference of doubles could show.
    Eigen::MatrixXd scaled = product;
    for (Index i = 0; i < rows; ++i) scaled.row(i) *= std::ldexp(1, integer(300));
    EXPECT_EQ(SparseRank(SparseMatrix(scaled.sparseView())), expected) << trial;
  }
}

TEST(SparseRank, SeesTheLastBit) {
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1, 0.1, 3, 3 * 0.1;  // 3 * 0.1 is rounded
  EXPECT_EQ(SparseRank(SparseMatrix(matrix.sparseView())), 2);
  matrix << 1, 0.1, 4, 4 * 0.1;  // exact
  EXPECT_EQ(SparseRank(SparseMatrix(matrix.sparseView())), 1);
  EXPECT_EQ(SparseRank(SparseMatrix(3, 5)), 0);
}

TEST(SparseRank, OfAProblemCountsColumnsThatCanMove) {
  Eigen::MatrixXd J(2, 6);
  J << 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const auto problem = [&J](double last) {
    const Eigen::VectorXd inverse_mass = (Eigen::VectorXd(6) << 0, 0, 0, 1, 1, last).finished();
    return LcpProblem::FromFactors("", SparseMatrix(J.sparseView()), inverse_mass, Eigen::VectorXd::Zero(2));
  };
  EXPECT_EQ(RankOf(problem(1), 10), 2);
  EXPECT_EQ(RankOf(problem(0), 10), 1);
  EXPECT_EQ(RankOf(problem(1), 1), 2);
  Eigen::MatrixXd A(2, 2);
  A << 1, 2, 2, 4;
  const auto dense = LcpProblem::FromDense("", A, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(RankOf(dense, 2), 1);
  EXPECT_EQ(RankOf(dense, 1), std::nullopt);
}

}  // namespace
}  // namespace lcpbench
