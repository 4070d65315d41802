#include "tests/solvers/exact_problems.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

MatrixFacts SymmetricPsd() {
  MatrixFacts facts;
  facts.symmetric = true;
  facts.positive_semidefinite = true;
  return facts;
}

TestProblem PlantedExactly(unsigned seed, Index largest, bool wide_masses) {
  TestRandom random(seed);
  const Index n = random.Integer(1, static_cast<int>(largest));
  const Index rank = random.Integer(1, static_cast<int>(n));
  const double density = random.Integer(2, 10) / 10.0;
  const bool copies = random.Chance(0.4);
  MatrixXd G(n, rank);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < rank; ++k) G(i, k) = random.Chance(density) ? random.Integer(-3, 3) : 0;
    if (copies && i > 0 && random.Chance(0.3)) {
      G.row(i) = G.row(random.Integer(0, static_cast<int>(i) - 1)) * (random.Chance(0.5) ? 1 : -1);
    }
  }
  VectorXd m = VectorXd::Ones(rank);
  if (wide_masses) {
    for (Index k = 0; k < rank; ++k) m[k] = std::ldexp(1.0, random.Integer(-13, 13));
  }
  const MatrixXd A = G * m.asDiagonal() * G.transpose();
  const double degenerate = random.Chance(0.3) ? 0.5 : 0.0;
  const double joints = random.Chance(0.3) ? 0.3 : 0.0;
  const double active = random.Integer(0, 10) / 10.0;
  std::vector<Index> bilateral;
  VectorXd f = VectorXd::Zero(n);
  VectorXd w = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const int value = random.Integer(1, 9);
    if (random.Chance(joints)) {
      bilateral.push_back(i);
      f[i] = random.Chance(0.5) ? value : -value;
    } else if (!random.Chance(degenerate)) {
      (random.Chance(active) ? f : w)[i] = value;
    }
  }
  const VectorXd b = w - A * f;
  TestProblem planted{LcpProblem::FromDense("planted-" + std::to_string(seed), A, b,
                                            RowBounds::WithBilateralRows(n, bilateral), SymmetricPsd()),
                      {}};
  planted.reference.status = LcpReference::Status::kSolved;
  planted.reference.w = w;
  return planted;
}

LcpProblem InfeasibleExactly(unsigned seed, Index largest) {
  TestRandom random(seed);
  const Index n = random.Integer(2, static_cast<int>(largest));
  const Index rank = random.Integer(1, static_cast<int>(n));
  MatrixXd G(n, rank);
  for (Index i = 0; i < G.size(); ++i) G(i) = random.Integer(-3, 3);
  // The last row closes a nonnegative combination of rows: y = (y_0, ..., 1), G^T y = 0.
  VectorXd y = VectorXd::Zero(n);
  y[n - 1] = 1;
  G.row(n - 1).setZero();
  for (Index i = 0; i + 1 < n; ++i) {
    if (!random.Chance(0.3)) continue;
    y[i] = random.Integer(1, 3);
    G.row(n - 1) -= y[i] * G.row(i);
  }
  const MatrixXd A = G * G.transpose();
  VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = random.Integer(-9, 9);
  b[n - 1] -= b.dot(y) + random.Integer(1, 9);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    if (random.Chance(0.2)) bilateral.push_back(i);
  }
  return LcpProblem::FromDense("infeasible", A, b, RowBounds::WithBilateralRows(n, bilateral), SymmetricPsd());
}

LcpProblem FullyDegenerate(unsigned seed, Index largest) {
  TestRandom random(seed);
  const Index n = random.Integer(2, static_cast<int>(largest));
  MatrixXd G(n, random.Integer(1, 4));
  for (Index i = 0; i < G.size(); ++i) G(i) = random.Integer(-1, 1);
  const MatrixXd A = G * G.transpose();
  // Every w is 0 at f = 1, and for each of the many other f with the same A f.
  return LcpProblem::FromDense("degenerate", A, -A * VectorXd::Ones(n), {}, SymmetricPsd());
}

}  // namespace lcpbench
