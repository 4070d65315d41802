#include "tests/solvers/derivative/derivative_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "solvers/exact/exact_solver.h"
#include "solvers/exact/mode_system.h"
#include "solvers/exact/modes/mode_search.h"
#include "support/array_index.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

constexpr int kColumns = 3;  // a body

SparseMatrix RandomMatrix(Index rows, Index columns, int most, TestRandom* random) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = random->Integer(-most, most);
  return matrix.sparseView();
}

Eigen::VectorXd RandomVector(Index size, int least, int most, TestRandom* random) {
  Eigen::VectorXd vector(size);
  for (double& entry : vector) entry = random->Integer(least, most);
  return vector;
}

// b such that f has these gaps; all numbers are exact in doubles.
LcpProblem Plant(const std::string& id, const SparseMatrix& J, const Eigen::VectorXd& inverse_mass,
                 const Eigen::VectorXd& f, const Eigen::VectorXd& w, const RowBounds& bounds) {
  const Eigen::VectorXd b = w - J * inverse_mass.cwiseProduct(J.transpose() * f);
  return LcpProblem::FromFactors(id, J, inverse_mass, b, bounds);
}

// A change of all data.
ProblemChange RandomChange(const LcpProblem& problem, TestRandom* random) {
  ProblemChange change;
  change.J = RandomMatrix(problem.size(), problem.J().cols(), 2, random);
  change.inverse_mass = RandomVector(problem.J().cols(), -1, 1, random);
  change.b = RandomVector(problem.size(), -9, 9, random);
  return change;
}

}  // namespace

DerivativeCase PlainCase(unsigned seed) {
  TestRandom random(seed);
  const bool is_degenerate = seed % 2 == 1, has_copies = seed % 4 >= 2, has_joints = seed % 8 >= 4;
  const Index distinct = random.Integer(2, 9), bodies = (distinct + 2) / 3 + 1;
  enum class State { kClosed, kOpen, kTouching, kJoint };
  std::vector<State> states(At(distinct), State::kClosed);
  std::vector<Index> copied;  // row -> distinct row
  for (Index i = 0; i < distinct; ++i) {
    copied.push_back(i);
    for (int k = random.Integer(i == 0 ? 1 : 0, 2); has_copies && k > 0; --k) copied.push_back(i);
    if (i == 0) continue;
    if (random.Chance(0.3)) states[At(i)] = State::kOpen;
    if (is_degenerate && (i == 1 || random.Chance(0.3))) states[At(i)] = State::kTouching;
    if (has_joints && i > 1 && random.Chance(0.3)) states[At(i)] = State::kJoint;
  }
  const Index n = static_cast<Index>(copied.size());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n), w = f, opening = f;
  std::vector<Index> joints;
  for (Index i = 0; i < n; ++i) {
    const State state = states[At(copied[At(i)])];
    if (state == State::kClosed) f[i] = random.Integer(1, 9);
    if (state == State::kOpen) w[i] = 1 + static_cast<int>(copied[At(i)]);  // copies have the same gap
    if (state == State::kTouching) opening[i] = 1000;
    if (state != State::kJoint) continue;
    joints.push_back(i);
    f[i] = random.Integer(-9, 9);
  }
  SparseMatrix P(n, distinct);
  for (Index i = 0; i < n; ++i) P.insert(i, copied[At(i)]) = 1;
  const SparseMatrix J = P * RandomMatrix(distinct, kColumns * bodies, 3, &random);
  const Eigen::VectorXd inverse_mass = RandomVector(kColumns * bodies, 1, 4, &random);
  const LcpProblem problem =
      Plant("plain-" + std::to_string(seed), J, inverse_mass, f, w, RowBounds::WithBilateralRows(n, joints));
  ProblemChange change;
  change.J = P * RandomMatrix(distinct, J.cols(), 2, &random);
  change.inverse_mass = RandomVector(J.cols(), -1, 1, &random);
  change.b = P * RandomVector(distinct, -9, 9, &random);
  const std::string kind = std::string(has_joints ? "contacts and joints" : "contacts") +
                           (has_copies ? ", not unique" : "") + (is_degenerate ? ", degenerate" : ", strict");
  return {kind, problem, f, std::move(change), opening};
}

DerivativeCase FrictionCase(unsigned seed, bool degenerate) {
  TestRandom random(seed);
  const int contacts = random.Integer(1, 3), others = random.Integer(0, 2);
  const Index n = 2 * contacts + others, bodies = contacts + 1;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n), w = f, opening = f;
  RowBounds bounds;
  bounds.bilateral.assign(At(n), 0);
  Eigen::VectorXd dmu(contacts);
  for (Index k = 0; k < contacts; ++k) {
    const Index normal = 2 * k, tangent = normal + 1;
    double mu = random.Integer(1, 4) / 4.0;
    const int sign = random.Chance(0.5) ? 1 : -1;
    signed char slip = 0;
    f[normal] = 8 * random.Integer(1, 3);
    dmu[k] = random.Integer(-4, 4) / 4.0;
    const bool strict = !degenerate || (k > 0 && random.Chance(0.4));
    switch (strict ? random.Integer(0, 3) : random.Integer(4, 8)) {
      case 0:  // open
        f[normal] = 0;
        w[normal] = random.Integer(1, 9);
        w[tangent] = random.Integer(-9, 9);
        break;
      case 1:  // sticks
        f[tangent] = mu * f[normal] / 2 * random.Integer(-1, 1);
        break;
      case 2:  // slips
        f[tangent] = -sign * mu * f[normal];
        w[tangent] = sign * random.Integer(1, 9);
        break;
      case 3:  // slides
        slip = static_cast<signed char>(sign);
        f[tangent] = -sign * mu * f[normal];
        w[tangent] = random.Integer(-9, 9);
        break;
      case 4:  // touches, and slips or slides
        f[normal] = 0;
        w[tangent] = sign * random.Integer(1, 9);
        opening[normal] = 1000;
        slip = static_cast<signed char>(random.Chance(0.3) ? sign : 0);
        break;
      case 5:  // touches
        f[normal] = 0;
        opening[normal] = 1000;
        break;
      case 6:
      case 7:  // about to slip
        f[tangent] = -sign * mu * f[normal];
        opening[tangent] = sign * 1000;
        break;
      default:  // no slip, and mu = 0
        mu = 0;
        opening[tangent] = 1000;
        dmu[k] = random.Integer(0, 4) / 4.0;
    }
    bounds.friction.push_back({tangent, normal, mu, slip});
  }
  for (Index i = 2 * contacts; i < n; ++i) {
    f[i] = random.Integer(-3, 3);
    const int at = random.Integer(0, degenerate ? 4 : 2);
    if (at == 0) {
      bounds.bilateral[At(i)] = 1;
    } else if (at == 1) {
      bounds.bounded.push_back({i, f[i] - 1, f[i] + 2});
    } else {
      const int side = random.Chance(0.5) ? 1 : -1;  // of w: > 0 at the lower bound
      bounds.bounded.push_back({i, f[i] - (side > 0 ? 0 : 4), f[i] + (side > 0 ? 4 : 0)});
      (at == 2 ? w : opening)[i] = side * (at == 2 ? 5 : 1000);
    }
  }
  const SparseMatrix J = RandomMatrix(n, kColumns * bodies, 3, &random);
  const LcpProblem problem =
      Plant("friction-" + std::to_string(seed), J, RandomVector(kColumns * bodies, 1, 4, &random), f, w, bounds);
  ProblemChange change = RandomChange(problem, &random);
  change.mu = dmu;
  return {degenerate ? "friction, degenerate" : "friction, strict", problem, f, std::move(change), opening};
}

DerivativeCase CopiedFrictionCase(unsigned seed) {
  DerivativeCase test = FrictionCase(seed, false);
  for (unsigned next = seed + 1000; test.f[0] == 0 || test.change.mu->size() > 2; next += 1000) {
    test = FrictionCase(next, false);
  }
  std::vector<Index> rows = EveryRow(test.problem.size());
  rows.insert(rows.end(), {0, 1});
  SparseMatrix P(static_cast<Index>(rows.size()), test.problem.size());
  for (size_t k = 0; k < rows.size(); ++k) P.insert(static_cast<Index>(k), rows[k]) = 1;
  test.problem = RowsOf(test.problem, rows);
  test.f = test.f(rows).eval();
  test.f.head(2) *= 0.75;
  test.f.tail(2) *= 0.25;
  test.change.J = SparseMatrix(P * *test.change.J);
  test.change.b = (P * *test.change.b).eval();
  Eigen::VectorXd dmu(test.change.mu->size() + 1);
  dmu << *test.change.mu, (*test.change.mu)[0];
  test.change.mu = dmu;
  test.kind = "friction, not unique, strict";
  return test;
}

ExactLcp PerturbedExactly(const LcpProblem& problem, const ProblemChange& change, const Rational& t) {
  ExactLcp exact = ExactFrom(problem);
  const Index n = problem.size(), m = problem.J().cols();
  const Eigen::MatrixXd J = problem.J(), dJ = *change.J;
  const auto at = [&](const auto& value, const auto& by) { return Rational(value) + t * Rational(by); };
  for (Index i = 0; i < n; ++i) {
    exact.b[At(i)] += t * Rational((*change.b)[i]);
    for (Index j = 0; j < n; ++j) {
      Rational sum = 0;
      for (Index k = 0; k < m; ++k) {
        sum += at(J(i, k), dJ(i, k)) * at(problem.inverse_mass()[k], (*change.inverse_mass)[k]) * at(J(j, k), dJ(j, k));
      }
      exact.A[At(i * n + j)] = sum;
    }
  }
  for (size_t k = 0; k < exact.friction.size(); ++k) {
    exact.friction[k].mu += t * Rational((*change.mu)[static_cast<Index>(k)]);
  }
  return exact;
}

std::vector<ExactChange> ExactChanges(const DerivativeCase& test) {
  const Rational t = Shifted(Rational(1), -120), near = Shifted(Rational(1), -60);
  const auto quotient = [&t](const RationalVector& from, const RationalVector& to) {
    Eigen::VectorXd change(static_cast<Index>(from.size()));
    for (Index i = 0; i < change.size(); ++i) change[i] = RoundToNearest((to[At(i)] - from[At(i)]) / t);
    return change;
  };
  const ExactLcp at_0 = ExactFrom(test.problem), at_t = PerturbedExactly(test.problem, test.change, t);
  if (test.problem.is_plain()) {
    const ExactAnswer from = SolveExactly(at_0, {}), to = SolveExactly(at_t, {});
    if (to.status != ExactAnswer::Status::kSolved) return {};
    return {{quotient(from.f_least_norm, to.f_least_norm), quotient(from.w, to.w)}};
  }
  RationalVector f;
  for (const double force : test.f) f.emplace_back(force);
  const RationalVector w = GapsOf(at_0, f);
  const bool is_unique = test.kind.find("not unique") == std::string::npos;
  std::vector<ExactChange> changes;
  for (const ModePiece& piece : SolveByModes(at_t, {}).pieces) {
    if (is_unique && piece.dimension > 0) continue;
    const RationalVector& f_t = piece.f.vertices.front();
    const RationalVector w_t = GapsOf(at_t, f_t);
    bool is_near = true;
    for (size_t i = 0; i < f.size(); ++i) is_near = is_near && abs(is_unique ? f_t[i] - f[i] : w_t[i] - w[i]) < near;
    if (is_near) changes.push_back({is_unique ? quotient(f, f_t) : Eigen::VectorXd(), quotient(w, w_t)});
  }
  return changes;
}

}  // namespace lcpbench
