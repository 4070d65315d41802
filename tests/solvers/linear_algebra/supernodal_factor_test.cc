#include "solvers/linear_algebra/supernodal_factor.h"
#include "support/array_index.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace lcpbench {
namespace {

// What CHOLMOD's analysis would say of a dense picture of A: the pattern of L by elimination, columns of like structure
// together.
struct Analysis {
  std::vector<int> order, first_column{0}, row_start{0}, value_start{0}, rows;
  std::size_t values = 0;

  Analysis(const Eigen::MatrixXd& A, std::vector<int> the_order) : order(std::move(the_order)) {
    const Eigen::Index n = A.rows();
    Eigen::MatrixXi L = (A(order, order).array() != 0).cast<int>();
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index i = k + 1; i < n; ++i) {
        if (L(i, k) == 0) continue;
        for (Eigen::Index j = k + 1; j <= i; ++j) L(i, j) |= L(j, k);
      }
    }
    for (Eigen::Index begin = 0; begin < n;) {
      Eigen::Index end = begin + 1;
      while (end < n && L(end, end - 1) != 0 && L.col(end).tail(n - end - 1) == L.col(end - 1).tail(n - end - 1)) ++end;
      for (Eigen::Index i = begin; i < n; ++i) {
        if (i < end || L(i, begin) != 0) rows.push_back(static_cast<int>(i));
      }
      values += (rows.size() - At(row_start.back())) * At(end - begin);
      first_column.push_back(static_cast<int>(end));
      row_start.push_back(static_cast<int>(rows.size()));
      value_start.push_back(static_cast<int>(values));
      begin = end;
    }
  }

  SupernodalFactor::Structure View() const {
    const std::size_t n = order.size();
    return {.n = static_cast<int>(n),
            .supernodes = static_cast<int>(first_column.size()) - 1,
            .first_column = first_column.data(),
            .row_start = row_start.data(),
            .value_start = value_start.data(),
            .rows = rows.data(),
            .values = values,
            .largest_update = n * n,
            .order = order.data()};
  }
};

// The lower triangle by columns, rows of a column in any order.
struct Lower {
  std::vector<int> starts{0}, rows;
  std::vector<double> values;

  Lower(const Eigen::MatrixXd& A, std::mt19937* random) {
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      for (Eigen::Index i = j; i < A.rows(); ++i) {
        if (A(i, j) != 0) rows.push_back(static_cast<int>(i));
      }
      std::shuffle(rows.begin() + starts.back(), rows.end(), *random);
      for (std::size_t e = At(starts.back()); e < rows.size(); ++e) values.push_back(A(rows[e], j));
      starts.push_back(static_cast<int>(rows.size()));
    }
  }
};

// From diagonal to full, so that panels are narrow and wide, by plain loops and by the BLAS.
TEST(SupernodalFactor, SolvesAsEigen) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t widest = 0;
  for (int seed = 0; seed < 60; ++seed) {
    const Eigen::Index n = 1 + 3 * seed;
    const double share = seed % 4 == 0 ? 0.5 : 2.0 / static_cast<double>(n);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j + 1; i < n; ++i) {
        if (std::abs(uniform(random)) < share) A(i, j) = A(j, i) = uniform(random);
      }
    }
    A.diagonal() = A.cwiseAbs().rowwise().sum().array() + 0.1;
    std::vector<int> order(At(n));
    std::iota(order.begin(), order.end(), 0);
    if (seed % 2 == 1) std::shuffle(order.begin(), order.end(), random);
    const Analysis analysis(A, order);
    for (std::size_t s = 1; s < analysis.first_column.size(); ++s) {
      widest = std::max(widest, At(analysis.first_column[s] - analysis.first_column[s - 1]));
    }
    const Lower lower(A, &random);
    SupernodalFactor factor;
    factor.Prepare(analysis.View(), lower.starts.data(), lower.rows.data());
    for (const double scale : {1.0, 3.0}) {  // the same structure again
      std::vector<double> values = lower.values;
      for (double& value : values) value *= scale;
      ASSERT_TRUE(factor.Factorize(values.data()));
      Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return uniform(random); });
      const Eigen::VectorXd expected = (scale * A).eval().llt().solve(x);
      factor.Solve(x.data());
      EXPECT_LT((x - expected).norm(), 1e-13 * static_cast<double>(n) * expected.norm()) << seed;
    }
  }
  EXPECT_GT(widest, 60U);
}

TEST(SupernodalFactor, RefusesPivotsThatAreNotPositive) {
  std::mt19937 random(4);
  for (const Eigen::Index n : {Eigen::Index{5}, Eigen::Index{60}}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, n, 0.5);
    A.diagonal().setConstant(1);
    A(n - 1, n - 1) = -1;
    std::vector<int> order(At(n));
    std::iota(order.begin(), order.end(), 0);
    const Analysis analysis(A, order);
    const Lower lower(A, &random);
    SupernodalFactor factor;
    factor.Prepare(analysis.View(), lower.starts.data(), lower.rows.data());
    EXPECT_FALSE(factor.Factorize(lower.values.data()));
  }
}

}  // namespace
}  // namespace lcpbench
