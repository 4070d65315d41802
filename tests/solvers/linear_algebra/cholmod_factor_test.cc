#include "solvers/linear_algebra/cholmod_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Definiteness = CholmodFactor::Definiteness;
using ColumnMatrix = CholmodFactor::ColumnMatrix;

ColumnMatrix LowerTriangle(const Eigen::MatrixXd& dense) {
  return Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
}

// Row and column `hub` full, otherwise diagonal.
Eigen::MatrixXd Arrow(Eigen::Index n, Eigen::Index hub) {
  Eigen::MatrixXd arrow = Eigen::MatrixXd::Identity(n, n) * static_cast<double>(n);
  arrow.row(hub).array() += 1;
  arrow.col(hub).array() += 1;
  return arrow;
}

Eigen::VectorXi GivenOrder(Eigen::Index n) { return Eigen::VectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1); }

TEST(CholmodFactor, SolvesInAnyGivenOrder) {
  std::mt19937_64 random(3);
  for (Eigen::Index n = 1; n <= 40; ++n) {
    Eigen::MatrixXd root(n, n);
    for (double& value : root.reshaped()) value = random() % 3 == 0 ? Uniform(&random, -2, 2) : 0.0;
    Eigen::MatrixXd matrix = root * root.transpose();
    matrix.diagonal().array() += 1;
    Eigen::VectorXi order = GivenOrder(n);
    std::shuffle(order.begin(), order.end(), random);
    const Eigen::VectorXd expected = UniformVector(&random, n, -1, 1);
    for (const Definiteness definiteness : {Definiteness::kPositiveDefinite, Definiteness::kQuasidefinite}) {
      CholmodFactor factor;
      factor.Analyze(definiteness, LowerTriangle(matrix), order);
      ASSERT_TRUE(factor.Factorize()) << factor.why();
      Eigen::VectorXd x;
      factor.Solve(matrix * expected, &x);
      EXPECT_LE((x - expected).norm(), 1e-10 * expected.norm()) << n;
    }
  }
}

// The factor of an arrow is full if its hub goes first, and as sparse as the arrow if it goes last.
TEST(CholmodFactor, EliminatesInTheGivenOrder) {
  const Eigen::Index n = 20;
  const ColumnMatrix lower = LowerTriangle(Arrow(n, 0));
  CholmodFactor factor;
  factor.Analyze(Definiteness::kPositiveDefinite, lower, GivenOrder(n));
  EXPECT_EQ(factor.fill(), static_cast<double>(n * (n + 1)) / 2);
  factor.Analyze(Definiteness::kPositiveDefinite, lower, GivenOrder(n).reverse());
  EXPECT_EQ(factor.fill(), static_cast<double>(2 * n - 1));
  // A later analysis without an order is AMD's again.
  factor.Analyze(Definiteness::kPositiveDefinite, lower);
  EXPECT_EQ(factor.fill(), static_cast<double>(2 * n - 1));
}

// The Laplacian of a square grid, shifted; large enough that CHOLMOD's analysis asks for supernodes.
ColumnMatrix GridLaplacian(int side, double shift) {
  Triplets entries;
  for (int i = 0; i < side * side; ++i) {
    entries.emplace_back(i, i, 4 + shift);
    if (i % side + 1 < side) entries.emplace_back(i + 1, i, -1.0);
    if (i + side < side * side) entries.emplace_back(i + side, i, -1.0);
  }
  return MatrixOf(side * side, side * side, entries);
}

TEST(CholmodFactor, SolvesBySupernodesInEveryOrderAndAgainAfterTheValuesChanged) {
  const ColumnMatrix lower = GridLaplacian(120, 0.01);
  const Eigen::Index n = lower.cols();
  std::mt19937_64 random(5);
  const Eigen::VectorXd expected = UniformVector(&random, n, -1, 1);
  for (const int way : {0, 1, 2}) {
    CholmodFactor factor;
    if (way == 0) factor.Analyze(Definiteness::kPositiveDefinite, lower);
    if (way == 1) factor.Analyze(Definiteness::kPositiveDefinite, lower, GivenOrder(n).reverse());
    if (way == 2) factor.AnalyzeAsOrdered(lower);
    for (const double diagonal : {4.01, 5.0, 1e9}) {
      ColumnMatrix changed = lower;
      for (Eigen::Index i = 0; i < n; i += 7) {
        changed.coeffRef(i, i) = diagonal;
        factor.SetDiagonal(i, diagonal);
      }
      ASSERT_TRUE(factor.Factorize()) << factor.why();
      Eigen::VectorXd x = changed.selfadjointView<Eigen::Lower>() * expected;
      factor.Solve(x, &x);
      EXPECT_LE((x - expected).norm(), 1e-11 * expected.norm()) << way << ' ' << diagonal;
    }
  }
}

// A factorization that has failed leaves nothing behind that the next one would see.
TEST(CholmodFactor, RefusesAPivotThatIsNotPositiveAndRecovers) {
  const ColumnMatrix lower = GridLaplacian(120, 0.01);
  const Eigen::Index n = lower.cols();
  CholmodFactor factor;
  CholmodFactor fresh;
  factor.Analyze(Definiteness::kPositiveDefinite, lower);
  fresh.Analyze(Definiteness::kPositiveDefinite, lower);
  for (const Eigen::Index row : {Eigen::Index{0}, n / 2, n - 1}) {
    factor.SetDiagonal(row, -1.0);
    EXPECT_FALSE(factor.Factorize());
    EXPECT_NE(factor.why().find("not positive"), std::string::npos) << factor.why();
    factor.SetDiagonal(row, 4.01);
    ASSERT_TRUE(factor.Factorize());
    ASSERT_TRUE(fresh.Factorize());
    Eigen::VectorXd x;
    Eigen::VectorXd y;
    factor.Solve(Eigen::VectorXd::Ones(n), &x);
    fresh.Solve(Eigen::VectorXd::Ones(n), &y);
    EXPECT_EQ(x, y);
  }
}

TEST(CholmodFactor, RefusesWhatIsNoPermutation) {
  const ColumnMatrix lower = LowerTriangle(Arrow(3, 0));
  CholmodFactor factor;
  for (const std::vector<int>& nodes : std::vector<std::vector<int>>{{0, 1}, {0, 1, 1}, {0, 1, 3}}) {
    const Eigen::VectorXi order = Eigen::VectorXi::Map(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
    EXPECT_THROW(factor.Analyze(Definiteness::kPositiveDefinite, lower, order), std::runtime_error);
  }
}

}  // namespace
}  // namespace lcpbench
