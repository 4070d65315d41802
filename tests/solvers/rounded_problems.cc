#include "tests/solvers/rounded_problems.h"

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SparseMatrix Sparse(const MatrixXd& dense) { return dense.sparseView(); }

}  // namespace

LcpProblem NearlyParallelRows(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(2, 8);
  const double angle = std::pow(10.0, -random.Uniform(3, 9));
  // Powers of ten make cells such as 1 + 1e-12, in which every sum ends on the same few bits.
  const double turn = random.Integer(0, 1) == 0 ? angle : std::pow(10.0, std::round(std::log10(angle)));
  MatrixXd J = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    const bool is_parallel = i > 0 && random.Integer(0, 2) > 0;
    if (is_parallel) {
      J.row(i) = J.row(random.Integer(0, i - 1));
      J(i, i) += turn;
    } else {
      for (Index k = 0; k < i; ++k) J(i, k) = static_cast<double>(random.Integer(-2, 2));
      J(i, i) = 1;
    }
  }
  VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = static_cast<double>(random.Integer(-2, 1));
  std::vector<Index> joints;
  const Index kind = random.Integer(0, 2);
  for (Index i = 0; i < n; ++i) {
    if (kind == 0 || (kind == 1 && random.Integer(0, 1) == 0)) joints.push_back(i);
  }
  const RowBounds bounds = RowBounds::WithBilateralRows(n, joints);
  MatrixXd A = J * J.transpose();
  A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
  const std::string id = "nearly-parallel-" + std::to_string(seed);
  switch (random.Integer(0, 2)) {
    case 0:
      return LcpProblem::FromDense(id, A, b, bounds, SymmetricPsd());
    case 1:
      return LcpProblem::FromSparse(id, Sparse(A), b, bounds, SymmetricPsd());
    default:
      return LcpProblem::FromFactors(id, Sparse(J), VectorXd::Ones(n), b, bounds);
  }
}

TwoJoints NearlyParallelJoints(unsigned seed) {
  TestRandom random(seed);
  const double angle = std::pow(10.0, -random.Uniform(2, 7));
  const double a = random.Uniform(0.5, 2);
  const double stretch = random.Uniform(0.5, 2);
  MatrixXd A(2, 2);
  A << a, a * stretch, a * stretch, a * stretch * stretch + angle * angle;
  const VectorXd b = Eigen::Vector2d(random.Uniform(-1, 1), random.Uniform(-1, 1));
  // x y - z t, rounded once or nearly so.
  const auto difference = [](double x, double y, double z, double t) {
    const double xy = x * y;
    const double zt = z * t;
    return (xy - zt) + (std::fma(x, y, -xy) - std::fma(z, t, -zt));
  };
  const double determinant = difference(A(0, 0), A(1, 1), A(0, 1), A(1, 0));
  const Eigen::Vector2d f(difference(b[1], A(0, 1), b[0], A(1, 1)) / determinant,
                          difference(b[0], A(1, 0), b[1], A(0, 0)) / determinant);
  return {LcpProblem::FromDense("nearly-parallel-joints-" + std::to_string(seed), A, b,
                                RowBounds::WithBilateralRows(2, {0, 1}), SymmetricPsd()),
          f};
}

LcpProblem RedundantLinkage(unsigned seed) {
  TestRandom random(seed);
  const double angle = std::pow(10.0, -random.Uniform(0, 8)) * (random.Integer(0, 1) == 0 ? 1 : -1);
  const double rate = random.Uniform(-5, 5);
  const double off = std::pow(10.0, -random.Uniform(11, 16));
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Index arms = random.Integer(1, 3);
  const Index n = 2 + 4 * arms;
  MatrixXd J = MatrixXd::Zero(n, 3 + 3 * arms);
  VectorXd velocity_terms(n);
  // A point at (x, y) from the centre of a body, along x (axis 0) or y.
  const auto point = [&](Index row, Index body, int axis, double x, double y, double sign) {
    J(row, 3 * body + axis) += sign;
    J(row, 3 * body + 2) += sign * (axis == 0 ? -y : x) * (1 + off * random.Uniform(-1, 1));
    velocity_terms[row] -= sign * rate * rate * (axis == 0 ? x : y) * (1 + off * random.Uniform(-1, 1));
  };
  velocity_terms.setZero();
  point(0, 0, 1, c, -s, 1);
  point(1, 0, 0, -c, s, 1);
  for (Index arm = 1; arm <= arms; ++arm) {
    for (const int axis : {0, 1}) {
      const Index row = 4 * arm - 2 + axis;
      point(row, arm, axis, -c / 2, -s / 2, 1);
      point(row + 2, arm, axis, c / 2, s / 2, 1);
      J(row + 2, axis) -= 1;
    }
  }
  VectorXd inverse_mass(J.cols());
  VectorXd weight = VectorXd::Zero(J.cols());
  for (Index body = 0; body <= arms; ++body) {
    inverse_mass.segment(3 * body, 2).setConstant(random.Uniform(0.1, 1));
    inverse_mass[3 * body + 2] = random.Uniform(0.5, 5);
    weight[3 * body + 1] = -9.81;
  }
  return LcpProblem::FromFactors("redundant-linkage-" + std::to_string(seed), Sparse(J), inverse_mass,
                                 J * weight + velocity_terms, RowBounds::WithBilateralRows(n, EveryRow(n)));
}

}  // namespace lcpbench
