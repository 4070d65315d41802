#include "tests/solvers/test_problems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "support/array_index.h"
#include "tests/solvers/io/read_lcp_file.h"

namespace lcpbench {
namespace {

int Integer(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

// A chain: row i couples bodies i and i + 1 along x, as discs in a row do; A is tridiagonal.
TestProblem Chain(Index n, unsigned seed) {
  std::mt19937 random(seed);
  SparseMatrix J(n, 3 * (n + 1));
  for (Index i = 0; i < n; ++i) {
    J.insert(i, 3 * i) = 1;
    J.insert(i, 3 * i + 3) = -1;
  }
  Eigen::VectorXd inverse_mass(3 * (n + 1));
  for (double& m : inverse_mass) m = Integer(random, 1, 4);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) (Integer(random, 0, 3) > 0 ? f : w)[i] = Integer(random, 1, 9);
  const LcpProblem homogeneous = LcpProblem::FromFactors("", J, inverse_mass, Eigen::VectorXd::Zero(n));
  const Eigen::VectorXd b = w - homogeneous.DenseA() * f;
  LcpReference reference{LcpReference::Status::kSolved, w, std::nullopt};
  return {LcpProblem::FromFactors("chain-" + std::to_string(n), J, inverse_mass, b), reference};
}

}  // namespace

SparseMatrix MatrixOf(Index rows, Index columns, const Triplets& entries) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

std::vector<Index> EveryRow(Index n) {
  std::vector<Index> rows(static_cast<size_t>(n));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

double Uniform(std::mt19937_64* random, double low, double high) {
  return low + (high - low) * static_cast<double>((*random)() >> 11) * 0x1p-53;
}

Eigen::VectorXd UniformVector(std::mt19937_64* random, Index n, double low, double high) {
  return Eigen::VectorXd::NullaryExpr(n, [&] { return Uniform(random, low, high); });
}

MatrixFacts SymmetricPsd() {
  MatrixFacts facts;
  facts.symmetric = facts.positive_semidefinite = true;
  return facts;
}

std::ostream& operator<<(std::ostream& out, const TestProblem& test) { return out << test.problem.id(); }

std::vector<TestProblem> OracleProblems() {
  std::vector<TestProblem> problems;
  for (LcpRecord& record : ReadLcpFile(LCPBENCH_SOURCE_DIR "/tests/data/oracle/lcp.jsonl")) {
    problems.push_back({record.problem, record.reference});
  }
  return problems;
}

std::vector<TestProblem> TextbookProblems() {
  std::vector<TestProblem> problems;
  for (const LcpRecord& record : ReadLcpFile(LCPBENCH_SOURCE_DIR "/tests/data/textbook.jsonl")) {
    const LcpProblem& given = record.problem;
    problems.push_back({LcpProblem::FromDense(given.id(), given.DenseA(), given.b(), given.bounds(), SymmetricPsd()),
                        record.reference});
  }
  return problems;
}

TestProblem PlantedProblem(Index n, int bodies, unsigned seed, int bilateral_every, int degenerate_every) {
  std::mt19937 random(seed);
  SparseMatrix J(n, 3 * bodies);
  for (Index i = 0; i < n; ++i) {
    const int first = Integer(random, 0, bodies - 1);
    const int second = bodies > 1 ? (first + Integer(random, 1, bodies - 1)) % bodies : first;
    for (int k = 0; k < 3; ++k) {
      J.coeffRef(i, 3 * first + k) = Integer(random, -3, 3);
      if (second != first) J.coeffRef(i, 3 * second + k) = Integer(random, -3, 3);
    }
    if (J.row(i).norm() == 0) J.coeffRef(i, 3 * first) = 1;
  }
  Eigen::VectorXd inverse_mass(3 * bodies);
  for (double& m : inverse_mass) m = Integer(random, 1, 4);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    if (bilateral_every > 0 && i % bilateral_every == 0) {
      bilateral.push_back(i);
      f[i] = Integer(random, -5, 5);
    } else if (degenerate_every > 0 && i % degenerate_every == 1) {
      continue;
    } else {
      (Integer(random, 0, 1) == 0 ? f : w)[i] = Integer(random, 1, 9);
    }
  }
  const LcpProblem homogeneous = LcpProblem::FromFactors("", J, inverse_mass, Eigen::VectorXd::Zero(n));
  const Eigen::VectorXd b = w - homogeneous.DenseA() * f;  // integers: exact
  const std::string name = "planted-n" + std::to_string(n) + "-bodies" + std::to_string(bodies) + "-s" +
                           std::to_string(seed) + "-b" + std::to_string(bilateral_every) + "-d" +
                           std::to_string(degenerate_every);
  return {LcpProblem::FromFactors(name, J, inverse_mass, b, RowBounds::WithBilateralRows(n, bilateral)),
          {LcpReference::Status::kSolved, w, std::nullopt}};
}

std::vector<TestProblem> GeneratedProblems() {
  std::vector<TestProblem> problems;
  unsigned seed = 1;
  for (const Index n : {2, 3, 5, 8, 13, 21, 34}) {
    for (const int bodies : {1, 2, 4, 12}) {  // rank 3, 6, 12, full
      for (const int bilateral_every : {0, 4}) {
        for (const int degenerate_every : {0, 3}) {
          problems.push_back(PlantedProblem(n, bodies, seed++, bilateral_every, degenerate_every));
        }
      }
    }
  }
  // Joints only: a consistent linear system.
  for (const Index n : {1, 4, 9}) problems.push_back(PlantedProblem(n, 4, seed++, 1, 0));
  for (const Index n : {3, 10, 60}) problems.push_back(Chain(n, seed++));
  return problems;
}

LcpProblem RowsOf(const LcpProblem& problem, const std::vector<Index>& rows, Eigen::VectorXd factor) {
  const auto m = static_cast<Index>(rows.size());
  if (factor.size() == 0) factor.setOnes(m);
  std::vector<std::vector<Index>> places(At(problem.size()));
  Triplets picked;
  Eigen::VectorXd b(m);
  std::vector<Index> bilateral;
  for (Index k = 0; k < m; ++k) {
    const Index row = rows[At(k)];
    places[At(row)].push_back(k);
    picked.emplace_back(static_cast<int>(k), static_cast<int>(row), factor[k]);
    b[k] = factor[k] * problem.b()[row];
    if (problem.is_bilateral(row)) bilateral.push_back(k);
  }
  RowBounds bounds = RowBounds::WithBilateralRows(m, bilateral);
  for (const FrictionRow& row : problem.friction_rows()) {
    for (size_t j = 0; j < places[At(row.row)].size(); ++j) {
      const Index tangent = places[At(row.row)][j], normal = places[At(row.normal)].at(j);
      const double ratio = factor[normal] / factor[tangent];
      bounds.friction.push_back(
          {tangent, normal, row.mu * std::abs(ratio), static_cast<signed char>(ratio < 0 ? -row.slip : row.slip)});
    }
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    for (const Index k : places[At(row.row)]) {
      const auto [lower, upper] = std::minmax({row.lower / factor[k], row.upper / factor[k]});
      bounds.bounded.push_back({k, lower, upper});
    }
  }
  return problem.WithRows(MatrixOf(m, problem.size(), picked), b, bounds);
}

LcpProblem ScaleRows(const LcpProblem& problem, const Eigen::VectorXd& scale, double mass_scale) {
  const LcpProblem scaled = RowsOf(problem, EveryRow(problem.size()), scale);
  RowBounds bounds = scaled.bounds();
  for (BoundedRow& row : bounds.bounded) {
    row.lower /= mass_scale;
    row.upper /= mass_scale;
  }
  if (!problem.has_factors()) {
    return LcpProblem::FromDense(problem.id(), mass_scale * scaled.DenseA(), scaled.b(), bounds, problem.facts());
  }
  return LcpProblem::FromFactors(problem.id(), scaled.J(), mass_scale * problem.inverse_mass(), scaled.b(), bounds);
}

LcpProblem Compose(const std::vector<LcpProblem>& parts, unsigned seed) {
  Index rows = 0;
  Index columns = 0;
  for (const LcpProblem& part : parts) {
    rows += part.size();
    columns += part.J().cols();
  }
  Triplets entries;
  Eigen::VectorXd inverse_mass(columns);
  Eigen::VectorXd b(rows);
  std::vector<Index> bilateral;
  Index row = 0;
  Index column = 0;
  for (const LcpProblem& part : parts) {
    for (Index i = 0; i < part.size(); ++i) {
      for (SparseMatrix::InnerIterator it(part.J(), i); it; ++it) {
        entries.emplace_back(static_cast<int>(row + i), static_cast<int>(column + it.col()), it.value());
      }
      if (part.is_bilateral(i)) bilateral.push_back(row + i);
    }
    b.segment(row, part.size()) = part.b();
    inverse_mass.segment(column, part.J().cols()) = part.inverse_mass();
    row += part.size();
    column += part.J().cols();
  }
  const LcpProblem ordered =
      LcpProblem::FromFactors("composed-" + std::to_string(seed), MatrixOf(rows, columns, entries), inverse_mass, b,
                              RowBounds::WithBilateralRows(rows, bilateral));
  std::vector<Index> order = EveryRow(rows);
  std::mt19937 random(seed);
  for (size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
  return RowsOf(ordered, order);
}

LcpProblem Column(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  Triplets entries;
  Eigen::VectorXd acceleration(3 * n);
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, 3 * k + 1, 1.0);
    if (k > 0) entries.emplace_back(k, 3 * (k - 1) + 1, -1.0);
    acceleration.segment<3>(Index{3} * k) << 0.0, -10.0 + Uniform(&random, -8.0, 8.0), 0.0;
  }
  const SparseMatrix J = MatrixOf(n, 3 * n, entries);
  return LcpProblem::FromFactors("column-" + std::to_string(n), J, Eigen::VectorXd::Ones(3 * n), J * acceleration);
}

LcpProblem DiscPile(Index n, unsigned seed) {
  constexpr int kWidth = 10;
  const double half = 0.5;
  const double height = std::sqrt(0.75);
  std::mt19937_64 random(seed);
  Triplets entries;
  int row = 0;
  int disc = 0;
  for (; row < n; ++disc) {
    const int below = disc - kWidth;
    for (const double side : {-half, half}) {
      if (row >= n) break;
      entries.emplace_back(row, 3 * disc, -side);
      entries.emplace_back(row, 3 * disc + 1, height);
      const int neighbour = below + (side > 0 ? 1 : 0);
      if (neighbour >= 0 && neighbour < disc) {
        entries.emplace_back(row, 3 * neighbour, side);
        entries.emplace_back(row, 3 * neighbour + 1, -height);
      }
      ++row;
    }
  }
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(Index{3} * disc);
  for (Index k = 0; k < disc; ++k) {
    acceleration[3 * k] = Uniform(&random, -3.0, 3.0);
    acceleration[3 * k + 1] = -10.0;
  }
  const SparseMatrix J = MatrixOf(n, Index{3} * disc, entries);
  return LcpProblem::FromFactors("pile-" + std::to_string(n), J, Eigen::VectorXd::Ones(Index{3} * disc),
                                 J * acceleration);
}

LcpProblem JammedColumn(Index n, unsigned seed) {
  const LcpProblem column = Column(n, seed);
  SparseMatrix J = column.J();
  J.conservativeResize(n + 2, J.cols());
  J.coeffRef(n, 3 * (n - 1)) = 1;
  J.coeffRef(n + 1, 3 * (n - 1)) = -1;
  Eigen::VectorXd b(n + 2);
  b << column.b(), -1.0, 0.5;
  return LcpProblem::FromFactors("jam", J, column.inverse_mass(), b);
}

StackedColumn MakeStackedColumn(Index n, double ratio) {
  constexpr double kGravity = 9.81;
  Eigen::VectorXd inverse_mass(3 * n);
  std::vector<long double> f(static_cast<size_t>(n));
  long double above = 0;
  for (Index i = n - 1; i >= 0; --i) {
    const double mass = i % 2 == 0 ? 1 : ratio;
    inverse_mass.segment(3 * i, 3).setConstant(1 / mass);
    above += 1 / static_cast<long double>(1 / mass);  // the mass that the problem holds, not the one it was made from
    f[static_cast<size_t>(i)] = kGravity * above;
  }
  // Between bodies that fall alike gaps do not change.
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  b[0] = -kGravity;
  return {LcpProblem::FromFactors("column", Column(n, 0).J(), inverse_mass, b), f};
}

}  // namespace lcpbench
