// Dividing a problem: islands against breadth-first search, parts against blocks of A, idle rows against full solves.

#include "solvers/linear_algebra/islands.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <queue>
#include <vector>

#include "solvers/pivoting/dantzig.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<std::vector<Index>> IslandsBySearch(const MatrixXd& A, const std::vector<char>& keep) {
  const Index n = A.rows();
  std::vector<char> seen(static_cast<size_t>(n), 0);
  std::vector<std::vector<Index>> islands;
  for (Index first = 0; first < n; ++first) {
    if (seen[static_cast<size_t>(first)] != 0 || keep[static_cast<size_t>(first)] == 0) continue;
    std::vector<Index> island;
    std::queue<Index> next;
    next.push(first);
    seen[static_cast<size_t>(first)] = 1;
    while (!next.empty()) {
      const Index i = next.front();
      next.pop();
      island.push_back(i);
      for (Index j = 0; j < n; ++j) {
        if (A(i, j) == 0 || seen[static_cast<size_t>(j)] != 0 || keep[static_cast<size_t>(j)] == 0) continue;
        seen[static_cast<size_t>(j)] = 1;
        next.push(j);
      }
    }
    std::sort(island.begin(), island.end());
    islands.push_back(island);
  }
  return islands;
}

LcpProblem RandomParts(unsigned seed) {
  TestRandom random(seed);
  std::vector<LcpProblem> parts;
  const int count = random.Integer(1, 6);
  parts.reserve(static_cast<size_t>(count));
  for (int k = 0; k < count; ++k) {
    parts.push_back(PlantedProblem(random.Integer(1, 12), random.Integer(1, 6), 31 * seed + static_cast<unsigned>(k),
                                   random.Integer(0, 4), random.Integer(0, 3))
                        .problem);
  }
  return Compose(parts, seed);
}

TEST(Islands, AreTheConnectedComponentsOfA) {
  Islands islands;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const LcpProblem problem = RandomParts(seed);
    TestRandom random(seed);
    std::vector<char> keep(static_cast<size_t>(problem.size()), 1);
    for (char& k : keep) k = random.Chance(0.15) ? 0 : 1;
    islands.Reserve(problem.size());
    islands.Find(problem.SparseA(), keep);
    const auto expected = IslandsBySearch(problem.DenseA(), keep);
    ASSERT_EQ(islands.count(), static_cast<Index>(expected.size())) << seed;
    size_t largest = 0;
    for (size_t k = 0; k < expected.size(); ++k) {
      const auto rows = islands.rows(static_cast<Index>(k));
      EXPECT_EQ(std::vector<Index>(rows.begin(), rows.end()), expected[k]) << seed;
      largest = std::max(largest, expected[k].size());
    }
    EXPECT_EQ(islands.largest(), static_cast<Index>(largest));
  }
}

// With J >= 0 no products cancel, and the islands are those of A; else they are unions of those of A.
TEST(Islands, ByColumnsNeedNoA) {
  Islands by_columns;
  Islands by_A;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const LcpProblem given = RandomParts(seed);
    const std::vector<char> all(static_cast<size_t>(given.size()), 1);
    const LcpProblem positive =
        LcpProblem::FromFactors("positive", given.J().cwiseAbs(), given.inverse_mass(), given.b());
    for (const LcpProblem& problem : {given, positive}) {
      by_columns.FindByColumns(problem.J(), problem.inverse_mass());
      by_A.Find(problem.SparseA(), all);
      ASSERT_LE(by_columns.count(), by_A.count()) << seed;
      std::vector<Index> island(all.size());
      Index rows = 0;
      for (Index k = 0; k < by_columns.count(); ++k) {
        for (const Index i : by_columns.rows(k)) island[static_cast<size_t>(i)] = k;
        rows += static_cast<Index>(by_columns.rows(k).size());
      }
      EXPECT_EQ(rows, problem.size());
      for (Index i = 0; i < problem.size(); ++i) {
        for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
          if (it.value() == 0) continue;
          EXPECT_EQ(island[static_cast<size_t>(i)], island[static_cast<size_t>(it.col())]) << seed;
        }
      }
    }
    EXPECT_EQ(by_columns.count(), by_A.count()) << seed;
    EXPECT_EQ(by_columns.largest(), by_A.largest()) << seed;
  }
}

// A block on the ground: its tangent and its normal do not act on each other.
TEST(Islands, AFrictionRowIsWithItsNormal) {
  const SparseMatrix J = MatrixOf(4, 6, {{0, 1, 1}, {1, 4, 1}, {2, 0, 1}, {3, 3, 1}});
  RowBounds bounds;
  bounds.friction = {{2, 0, 0.5}, {3, 1, 0.25, -1}};
  const Eigen::Vector4d b(-1, -2, -3, -4);
  const LcpProblem whole = LcpProblem::FromFactors("blocks", J, Eigen::VectorXd::Ones(6), b, bounds);
  Islands islands;
  const std::vector<char> all(4, 1);
  islands.Find(whole.SparseA(), all);
  EXPECT_EQ(islands.count(), 4);
  const auto expect = [&] {
    ASSERT_EQ(islands.count(), 2);
    for (const Index k : {Index{0}, Index{1}}) {
      const auto rows = islands.rows(k);
      EXPECT_EQ(std::vector<Index>(rows.begin(), rows.end()), (std::vector<Index>{k, k + 2}));
      const LcpProblem part = Subproblem(whole, rows);
      EXPECT_EQ(part.kind(1), RowKind::kFriction);
      FrictionRow moved = whole.friction_rows()[static_cast<size_t>(k)];
      moved.row = 1;
      moved.normal = 0;
      EXPECT_EQ(part.friction_rows(), std::vector<FrictionRow>{moved});
    }
  };
  islands.Find(whole.SparseA(), all, whole.friction_rows());
  expect();
  islands.FindByColumns(whole.J(), whole.inverse_mass(), whole.friction_rows());
  expect();
  const std::vector<std::int32_t> bodies = {0, -1, 1, -1, 2, -1, 3, -1};  // the two directions of a block as bodies
  const std::vector<double> inverse_mass(12, 1);
  StepRows step;
  step.rows = 4;
  step.bodies = 4;
  step.body = bodies.data();
  step.inverse_mass = inverse_mass.data();
  step.friction = whole.friction_rows();
  islands.Reserve(4, 4);
  islands.Find(step);
  expect();

  RowBounds bounded;
  bounded.bilateral = {1, 0, 0, 0};
  bounded.bounded = {{1, 0, 2}, {3, -1, 1}};
  const LcpProblem part = Subproblem(whole.WithBounds(bounded), std::vector<Index>{0, 3});
  EXPECT_EQ(part.bilateral_rows(), std::vector<Index>{0});
  EXPECT_EQ(part.bounded_rows(), (std::vector<BoundedRow>{{1, -1, 1}}));
}

TEST(Islands, APartIsTheBlockOfItsRows) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const LcpProblem by_factors = RandomParts(seed);
    const LcpProblem by_A =
        LcpProblem::FromSparse("sparse", by_factors.SparseA(), by_factors.b(), by_factors.bounds(), SymmetricPsd());
    TestRandom random(seed);
    std::vector<Index> rows;
    for (Index i = 0; i < by_factors.size(); ++i) {
      if (random.Chance(0.6)) rows.push_back(i);
    }
    if (rows.empty()) continue;
    for (const LcpProblem& whole : {by_factors, by_A}) {
      const LcpProblem part = Subproblem(whole, rows);
      ASSERT_EQ(part.size(), static_cast<Index>(rows.size()));
      EXPECT_EQ(part.has_factors(), whole.has_factors());
      EXPECT_EQ(part.b(), whole.b()(rows));
      EXPECT_EQ(part.DenseA(), by_factors.DenseA()(rows, rows));
      for (size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(part.is_bilateral(static_cast<Index>(i)), whole.is_bilateral(rows[i]));
      }
    }
  }
}

// Solves what is left, sets f = 0 for idle rows, and lets the whole problem judge.
TEST(IdleRows, LeavingThemOutIsExact) {
  Index idle_in_all = 0;
  Index twins = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    TestRandom random(seed);
    const LcpProblem planted = PlantedExactly(seed, 25, false).problem;
    // Rows that are pushed apart, and repeated rows with the same or a larger b.
    const Index n = planted.size();
    std::vector<Index> source = EveryRow(n);
    for (int k = 0; k < 4; ++k) source.push_back(random.Integer(0, static_cast<int>(n) - 1));
    const MatrixXd A = planted.DenseA()(source, source);
    VectorXd b = planted.b()(source);
    for (double& value : b.tail(4)) value += random.Integer(0, 2);
    const LcpProblem problem = LcpProblem::FromDense(
        "idle", A, b, RowBounds::WithBilateralRows(n + 4, planted.bilateral_rows()), SymmetricPsd());
    IdleRows idle;
    idle.Prepare(problem);
    const Index count = idle.Find(problem);
    std::vector<Index> rest;
    for (Index i = 0; i < problem.size(); ++i) {
      if (idle.keep()[static_cast<size_t>(i)] != 0) {
        rest.push_back(i);
      } else {
        EXPECT_FALSE(problem.is_bilateral(i));
        twins += i >= n ? 1 : 0;
      }
    }
    ASSERT_EQ(count + static_cast<Index>(rest.size()), problem.size());
    idle_in_all += count;
    LcpResult whole;
    whole.f = VectorXd::Zero(problem.size());
    whole.status = LcpStatus::kSolved;
    if (!rest.empty()) {
      DantzigSolver solver;
      const LcpResult result = SolveWith(&solver, Subproblem(problem, rest));
      ASSERT_EQ(result.status, LcpStatus::kSolved) << seed << ": " << result.detail;
      whole.f(rest) = result.f;
    }
    ExpectSolved(problem, whole);
  }
  EXPECT_GT(idle_in_all, 1000);
  EXPECT_GT(twins, 500);
}

}  // namespace
}  // namespace lcpbench
