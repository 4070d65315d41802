#include "tests/attack/nearly_dependent.h"

#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// In [-1, 1].
double Number(TestRandom* random) {
  constexpr int kMost = 1 << 24;
  return static_cast<double>(random->Integer(-kMost, kMost)) / kMost;
}

RowVectorXd Row(Index columns, TestRandom* random) {
  RowVectorXd row(columns);
  do {
    for (double& entry : row) entry = Number(random);
  } while (row.norm() < 0.1);
  return row.normalized();
}

// One of length 1, perpendicular to the rows of `base`, which are independent.
RowVectorXd Perpendicular(const MatrixXd& base, TestRandom* random) {
  for (;;) {
    RowVectorXd row = Row(base.cols(), random);
    for (int twice = 0; twice < 2; ++twice) {
      row -= (base.transpose().colPivHouseholderQr().solve(row.transpose())).transpose() * base;
      if (row.norm() < 0.1) break;
      row.normalize();
    }
    if (row.norm() > 0.5) return row;
  }
}

// `count` rows of length 1, the last of which is `angle` off the span of the others.
MatrixXd Dependent(Index count, Index columns, double angle, TestRandom* random) {
  MatrixXd rows(count, columns);
  RowVectorXd last = RowVectorXd::Zero(columns);
  for (Index i = 0; i + 1 < count; ++i) {
    do {
      rows.row(i) = Row(columns, random);
    } while (i > 0 && std::abs(rows.row(0).dot(rows.row(i))) > 0.8);
    last += (random->Chance(0.5) ? 1 : -1) * (0.3 + std::abs(Number(random))) * rows.row(i);
  }
  rows.row(count - 1) =
      std::cos(angle) * last.normalized() + std::sin(angle) * Perpendicular(rows.topRows(count - 1), random);
  return rows;
}

LcpReference::Status StatusOf(const LcpProblem& problem) {
  const ExactLcp exact = ExactFrom(problem);
  ExactOptions options;
  options.answer_only = true;
  const ExactAnswer answer = SolveExactly(exact, options);
  const std::string fault = FindFault(exact, answer);
  if (!fault.empty()) throw std::runtime_error(problem.id() + ": " + fault);
  if (answer.status == ExactAnswer::Status::kSolved) return LcpReference::Status::kSolved;
  if (answer.status == ExactAnswer::Status::kInfeasible) return LcpReference::Status::kInfeasible;
  return LcpReference::Status::kUnknown;  // A is no longer semidefinite, once it is rounded
}

LcpProblem Draw(unsigned seed, double angle, bool has_factors, TestRandom* random) {
  const Index count = random->Integer(2, 3);
  const Index others = random->Integer(0, 2);
  const Index n = count + others;
  const Index columns = n + random->Integer(0, 3) + (others > 0 ? 1 : 0);
  MatrixXd J(n, columns);
  J.topRows(count) = Dependent(count, columns, angle, random);
  for (Index i = count; i < n; ++i) J.row(i) = Row(columns, random);
  const bool is_plain = random->Chance(0.2);
  VectorXd inverse_mass = VectorXd::Ones(columns);
  VectorXd b(n);
  std::vector<Index> bilateral;
  const double joints = 0.5 * random->Integer(0, 2);
  for (Index i = 0; i < n; ++i) {
    if (!is_plain) J.row(i) *= std::pow(10.0, 2 * Number(random));
    b[i] = Number(random) * J.row(i).norm();
    if (random->Chance(joints)) bilateral.push_back(i);
  }
  if (!is_plain) inverse_mass = VectorXd::NullaryExpr(columns, [&] { return std::pow(10.0, 1.5 * Number(random)); });
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  char id[64];
  std::snprintf(id, sizeof id, "%u-%s-%.0e-%s", seed, count == 2 ? "pair" : "triple", angle,
                has_factors ? "factors" : "dense");
  if (has_factors) return LcpProblem::FromFactors(id, J.sparseView(1.0, 0.0), inverse_mass, b, std::move(bounds));
  const MatrixXd A = J * inverse_mass.asDiagonal() * J.transpose();
  return LcpProblem::FromDense(id, A.selfadjointView<Eigen::Lower>(), b, std::move(bounds), SymmetricPsd());
}

}  // namespace

AttackProblem MakeNearlyDependentProblem(unsigned seed) {
  TestRandom random(seed);
  const double angle = std::pow(10.0, -9.5 + 6.5 * Number(&random));
  const bool has_factors = random.Chance(0.5);
  AttackProblem attack{.test = {Draw(seed, angle, has_factors, &random), {}}, .proof = {}};
  attack.test.reference.status = StatusOf(attack.test.problem);
  attack.may_fail = true;
  attack.is_nearly_infeasible = !has_factors || angle <= kClearAngle;
  return attack;
}

}  // namespace lcpbench
