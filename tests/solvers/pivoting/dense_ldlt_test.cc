#include "solvers/pivoting/dense_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Lower(const DenseLdlt& factor) {
  MatrixXd L = MatrixXd::Identity(factor.size(), factor.size());
  for (Index k = 0; k < factor.size(); ++k) {
    for (Index i = k + 1; i < factor.size(); ++i) L(i, k) = factor.lower(i, k);
  }
  return L;
}

void Enter(const MatrixXd& A, const std::vector<Index>& rows, Index row, DenseLdlt* factor) {
  VectorXd z(static_cast<Index>(rows.size()));
  for (Index k = 0; k < z.size(); ++k) z[k] = A(rows[static_cast<size_t>(k)], row);
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
    std::vector<Index> outside(static_cast<size_t>(n));
    for (Index i = 0; i < n; ++i) outside[static_cast<size_t>(i)] = i;
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
    VectorXd back = VectorXd::Zero(fresh.size());
    const VectorXd right = x;
    updated.Solve(x.data());
    for (Index i = 0; i < x.size(); ++i) {
      for (Index j = 0; j < x.size(); ++j)
        back[i] += A(inside[static_cast<size_t>(i)], inside[static_cast<size_t>(j)]) * x[j];
    }
    EXPECT_LE((back - right).cwiseAbs().maxCoeff(), 1e-9);
  }
}

}  // namespace
}  // namespace lcpbench
