#include "solvers/linear_algebra/sparse_lu.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace lcpbench {
namespace {

// One pattern, many matrices: the second and later factors may take the pivots of the one before.
TEST(SparseLu, SolvesAndTellsTheSignOfTheDeterminant) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> column(0, 29);
  int negative = 0, all = 0;
  for (int pattern = 0; pattern < 20; ++pattern) {
    Eigen::SparseMatrix<double> K(30, 30);
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < 30; ++i) {
      entries.emplace_back(i, i, 0);
      for (int k = 0; k < 3; ++k) entries.emplace_back(i, column(random), 0);
    }
    K.setFromTriplets(entries.begin(), entries.end());
    SparseLu lu;
    ASSERT_TRUE(lu.SetPattern(K));
    for (int values = 0; values < 10; ++values) {
      for (double& value : K.coeffs()) value = normal(random);
      ASSERT_TRUE(lu.FactorizeValues(K));
      const Eigen::MatrixXd dense = K;
      const Eigen::VectorXd x = Eigen::VectorXd::Ones(30);
      // Pivots of another matrix may grow by what SparseLu allows.
      const double lost = 1e-14 * 1e4 / Eigen::FullPivLU<Eigen::MatrixXd>(dense).rcond();
      EXPECT_LE((lu.Solve(dense * x) - x).lpNorm<Eigen::Infinity>(), lost);
      EXPECT_LE((lu.SolveTransposed(dense.transpose() * x) - x).lpNorm<Eigen::Infinity>(), lost);
      EXPECT_EQ(lu.has_negative_determinant(), dense.determinant() < 0);
      negative += dense.determinant() < 0 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(negative, all / 4);
  EXPECT_LT(negative, all - all / 4);
}

}  // namespace
}  // namespace lcpbench
