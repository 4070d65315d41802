#include "tests/solvers/exact_problems.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// How often a row is a joint, how often a contact has f = w = 0, and how often one of the others carries a force.
struct Shares {
  double joints = 0;
  double degenerate = 0;
  double active = 0.5;
};

TestProblem Plant(const std::string& name, const MatrixXd& A, const Shares& shares, TestRandom* random) {
  const Index n = A.rows();
  std::vector<Index> bilateral;
  VectorXd f = VectorXd::Zero(n);
  VectorXd w = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const int value = random->Integer(1, 9);
    if (random->Chance(shares.joints)) {
      bilateral.push_back(i);
      f[i] = random->Chance(0.5) ? value : -value;
    } else if (!random->Chance(shares.degenerate)) {
      (random->Chance(shares.active) ? f : w)[i] = value;
    }
  }
  const VectorXd b = w - A * f;
  TestProblem planted{LcpProblem::FromDense(name, A, b, RowBounds::WithBilateralRows(n, bilateral), SymmetricPsd()),
                      {}};
  planted.reference.status = LcpReference::Status::kSolved;
  planted.reference.w = w;
  return planted;
}

MatrixXd IntegerMatrix(Index rows, Index columns, int largest, TestRandom* random) {
  MatrixXd G(rows, columns);
  for (Index i = 0; i < G.size(); ++i) G(i) = random->Integer(-largest, largest);
  return G;
}

std::string Name(const char* family, unsigned seed) { return std::string(family) + "-" + std::to_string(seed); }

TestProblem EveryRank(unsigned seed) { return PlantedExactly(seed, 30, false); }
TestProblem WideMasses(unsigned seed) { return PlantedExactly(seed, 30, true); }

TestProblem CopiedRows(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(2, 30);
  const Index distinct = random.Integer(1, static_cast<int>((n + 2) / 3));
  MatrixXd G(n, random.Integer(1, static_cast<int>(distinct) + 1));
  G.topRows(distinct) = IntegerMatrix(distinct, G.cols(), 3, &random);
  for (Index i = distinct; i < n; ++i) {
    G.row(i) = G.row(random.Integer(0, static_cast<int>(distinct) - 1)) * (random.Chance(0.5) ? 1 : -1);
  }
  const Shares shares{random.Chance(0.3) ? 0.2 : 0.0, random.Chance(0.3) ? 0.3 : 0.0, random.Integer(0, 10) / 10.0};
  return Plant(Name("copied-rows", seed), G * G.transpose(), shares, &random);
}

TestProblem MostlyDegenerate(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(2, 30);
  const MatrixXd G = IntegerMatrix(n, random.Integer(1, static_cast<int>(n)), 2, &random);
  return Plant(Name("mostly-degenerate", seed), G * G.transpose(), {random.Chance(0.3) ? 0.2 : 0.0, 0.85, 0.6},
               &random);
}

// Singular, with w = 0 for all its many solutions: f = 1, and each of the many other f with the same A f.
TestProblem AllDegenerate(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(2, 30);
  const MatrixXd G = IntegerMatrix(n, random.Integer(1, 4), 1, &random);
  const MatrixXd A = G * G.transpose();
  return {LcpProblem::FromDense("degenerate", A, -A * VectorXd::Ones(n), {}, SymmetricPsd()),
          {LcpReference::Status::kSolved, VectorXd::Zero(n), std::nullopt}};
}

// Bodies in a row, each touching the next: A is tridiagonal.
TestProblem Chain(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(1, 120);
  MatrixXd A = MatrixXd::Zero(n, n);
  double left = random.Integer(0, 4);
  for (Index i = 0; i < n; ++i) {
    const double right = random.Integer(i + 1 < n ? 1 : 0, 4);
    A(i, i) = left + right;
    if (i + 1 < n) A(i, i + 1) = A(i + 1, i) = -right;
    left = right;
  }
  return Plant(Name("chain", seed), A,
               {random.Chance(0.3) ? 0.2 : 0.0, random.Chance(0.3) ? 0.3 : 0.0, random.Integer(0, 10) / 10.0}, &random);
}

TestProblem IsolatedRows(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(1, 30);
  MatrixXd A = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) A(i, i) = random.Chance(0.2) ? 0 : std::ldexp(1.0, random.Integer(-20, 20));
  // A pair that couples, so that rows without neighbours stand beside rows with them.
  if (n > 4) A.topLeftCorner(2, 2) << 2, 1, 1, 2;
  return Plant(Name("isolated-rows", seed), A, {random.Chance(0.3) ? 0.3 : 0.0, 0.2, 0.5}, &random);
}

TestProblem JointsOnly(unsigned seed) {
  TestRandom random(seed);
  const Index n = random.Integer(1, 30);
  const MatrixXd G = IntegerMatrix(n, random.Integer(1, static_cast<int>(n)), 3, &random);
  return Plant(Name("joints-only", seed), G * G.transpose(), {1, 0, 0}, &random);
}

TestProblem Unsolvable(const LcpProblem& problem) {
  return {problem, {LcpReference::Status::kInfeasible, std::nullopt, std::nullopt}};
}

TestProblem ClosedCombination(unsigned seed) { return Unsolvable(InfeasibleExactly(seed, 30)); }

// A solvable problem, and row i of its G once more, times `factor`, as the last row: bilateral as row i is where
// `joint`. The last b misses what row i demands by `miss`.
TestProblem WithContradiction(const char* family, unsigned seed, double factor, bool joint) {
  TestRandom random(seed);
  const Index n = random.Integer(2, 30);
  MatrixXd G = IntegerMatrix(n, random.Integer(1, static_cast<int>(n)), 3, &random);
  const Index i = random.Integer(0, static_cast<int>(n) - 2);
  G.row(n - 1) = factor * G.row(i);
  VectorXd b(n);
  for (Index k = 0; k < n; ++k) b[k] = random.Integer(-9, 9);
  b[n - 1] = factor * b[i] - random.Integer(1, 9);
  std::vector<Index> bilateral;
  if (joint) bilateral = {i, n - 1};
  return Unsolvable(LcpProblem::FromDense(Name(family, seed), G * G.transpose(), b,
                                          RowBounds::WithBilateralRows(n, bilateral), SymmetricPsd()));
}

TestProblem Squeezed(unsigned seed) { return WithContradiction("squeezed", seed, -1, false); }
TestProblem ContradictingJoints(unsigned seed) { return WithContradiction("contradicting-joints", seed, 2, true); }
TestProblem Immovable(unsigned seed) { return WithContradiction("immovable", seed, 0, false); }

constexpr ExactFamily kSolvable[] = {
    {"every-rank", &EveryRank},         {"wide-masses", &WideMasses},
    {"copied-rows", &CopiedRows},       {"mostly-degenerate", &MostlyDegenerate},
    {"all-degenerate", &AllDegenerate}, {"chain", &Chain},
    {"isolated-rows", &IsolatedRows},   {"joints-only", &JointsOnly},
};
constexpr ExactFamily kUnsolvable[] = {
    {"closed-combination", &ClosedCombination},
    {"squeezed", &Squeezed},
    {"contradicting-joints", &ContradictingJoints},
    {"immovable", &Immovable},
};

}  // namespace

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
  Shares shares;
  shares.degenerate = random.Chance(0.3) ? 0.5 : 0.0;
  shares.joints = random.Chance(0.3) ? 0.3 : 0.0;
  shares.active = random.Integer(0, 10) / 10.0;
  return Plant("planted-" + std::to_string(seed), A, shares, &random);
}

LcpProblem InfeasibleExactly(unsigned seed, Index largest) {
  TestRandom random(seed);
  const Index n = random.Integer(2, static_cast<int>(largest));
  MatrixXd G = IntegerMatrix(n, random.Integer(1, static_cast<int>(n)), 3, &random);
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

std::span<const ExactFamily> SolvableFamilies() { return kSolvable; }
std::span<const ExactFamily> UnsolvableFamilies() { return kUnsolvable; }

TestProblem Rescaled(const TestProblem& test, const VectorXd& rows, double of_A, double of_b) {
  TestProblem rescaled{ScaleRows(test.problem, rows, of_A), {test.reference.status, std::nullopt, std::nullopt}};
  rescaled.problem = rescaled.problem.WithB(of_b * rescaled.problem.b());
  if (test.reference.w.has_value()) rescaled.reference.w = of_b * rows.cwiseProduct(*test.reference.w);
  return rescaled;
}

}  // namespace lcpbench
