// An elimination order for a graph that has changed a little.

#include "solvers/linear_algebra/kept_order.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "solvers/lcp/in_sequence.h"
#include "solvers/linear_algebra/active_block.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Graph = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Name = KeptOrder::Name;

Graph RandomGraph(int n, std::mt19937* random) {
  Triplets edges;
  for (int e = 0; e < 3 * n; ++e) {
    const auto a = static_cast<int>((*random)() % static_cast<unsigned>(n));
    const auto b = static_cast<int>((*random)() % static_cast<unsigned>(n));
    if (a != b) edges.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  }
  Graph graph(n, n);
  graph.setFromTriplets(edges.begin(), edges.end());
  return graph;
}

TEST(KeptOrder, KnownNodesKeepTheirOrderAndNewOnesFollowTheirNeighbours) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    const int before = 40 + static_cast<int>(random() % 100);
    std::vector<Name> names(static_cast<size_t>(before));
    for (int i = 0; i < before; ++i) names[static_cast<size_t>(i)] = static_cast<Name>(7 * i + 3);
    Eigen::VectorXi order(before);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    KeptOrder kept;
    kept.Keep(names, order, 100);
    std::vector<int> place_of_name(static_cast<size_t>(7 * before), -1);
    for (int k = 0; k < before; ++k) {
      place_of_name[static_cast<size_t>(names[static_cast<size_t>(order[k])])] = k;
    }

    // A third of the nodes are gone, one in fifty is new, and their numbers are others.
    std::vector<Name> now;
    for (const Name name : names) {
      if (random() % 3 != 0) now.push_back(name);
      if (random() % 50 == 0) now.push_back(name + 1);
    }
    std::shuffle(now.begin(), now.end(), random);
    const auto n = static_cast<int>(now.size());
    const auto place = [&](int node) { return place_of_name[static_cast<size_t>(now[static_cast<size_t>(node)])]; };
    int fresh = 0;
    for (int i = 0; i < n; ++i) fresh += place(i) < 0 ? 1 : 0;
    const Graph graph = RandomGraph(n, &random);
    const Eigen::VectorXi found = kept.Find(now, graph.outerIndexPtr(), graph.innerIndexPtr());
    if (fresh > KeptOrder::kMostNew * n) {
      EXPECT_EQ(found.size(), 0);
      continue;
    }
    ASSERT_EQ(found.size(), n);
    std::vector<int> position(static_cast<size_t>(n), -1);
    for (int k = 0; k < n; ++k) position[static_cast<size_t>(found[k])] = k;
    EXPECT_EQ(std::count(position.begin(), position.end(), -1), 0);
    int last = -1;
    for (const int node : found) {
      if (place(node) < 0) continue;
      EXPECT_GT(place(node), last);
      last = place(node);
    }
    for (int j = 0; j < n; ++j) {
      for (Graph::InnerIterator it(graph, j); it; ++it) {
        const int i = static_cast<int>(it.row());
        const int ahead = position[static_cast<size_t>(i)] - position[static_cast<size_t>(j)];
        if (place(i) < 0 && place(j) >= 0) {
          EXPECT_GT(ahead, 0);
        } else if (place(j) < 0 && place(i) >= 0) {
          EXPECT_LT(ahead, 0);
        }
      }
    }
  }
}

TEST(KeptOrder, AnOrderThatHasWornOutIsNotAskedForAgainAtOnce) {
  KeptOrder kept;
  const std::vector<Name> names = {1, 2, 3};
  const Graph graph(3, 3);
  const auto find = [&] { return kept.Find(names, graph.outerIndexPtr(), graph.innerIndexPtr()).size(); };
  EXPECT_EQ(find(), 0);
  kept.Keep(names, Eigen::Vector3i(2, 0, 1), 100);
  EXPECT_EQ(find(), 3);
  EXPECT_TRUE(kept.Serves(KeptOrder::kMostWork * 100));
  EXPECT_EQ(find(), 3);
  EXPECT_FALSE(kept.Serves(KeptOrder::kMostWork * 100 + 1));
  for (int k = 0; k < KeptOrder::kPause; ++k) EXPECT_EQ(find(), 0);
  EXPECT_EQ(find(), 3);
}

constexpr Index kRows = KeptOrder::kLeastRows;

TEST(KeptOrder, RowsAreNamedByTheirBodiesWhateverTheirNumbers) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const LcpProblem problem = PlantedProblem(kRows, 200, seed, 5, 4).problem;
    const std::vector<Name> names = NamesOfRows(problem);
    ASSERT_EQ(names.size(), size_t{kRows});
    EXPECT_EQ(std::set<Name>(names.begin(), names.end()).size(), size_t{kRows});
    // The same bodies in another order of the rows.
    std::vector<Index> reversed = EveryRow(kRows);
    std::reverse(reversed.begin(), reversed.end());
    const std::vector<Name> others = NamesOfRows(PermuteRows(problem, reversed));
    EXPECT_TRUE(std::is_permutation(others.begin(), others.end(), names.begin(), names.end()));
  }
  EXPECT_TRUE(
      NamesOfRows(LcpProblem::FromDense("dense", Eigen::Matrix2d::Identity(), Eigen::Vector2d::Ones())).empty());
}

// A chain long enough for orders to be kept, without every `missing`-th row: the factor is right whatever was before.
TEST(SparseActiveBlock, FactorsARelatedProblemAsAFreshOneDoes) {
  const auto chain = [](int bodies, int missing) {
    Triplets entries;
    int rows = 0;
    for (int i = 0; i + 1 < bodies; ++i) {
      if (missing > 0 && i % missing == missing - 1) continue;
      for (int a = 0; a < 3; ++a) {
        entries.emplace_back(rows, 3 * i + a, 1.0 + (i + a) % 3);
        entries.emplace_back(rows, 3 * (i + 1) + a, -1.0 - (i + 2 * a) % 4);
      }
      ++rows;
    }
    return LcpProblem::FromFactors("chain-" + std::to_string(missing), MatrixOf(rows, 3 * bodies, entries),
                                   Eigen::VectorXd::Ones(3 * bodies), Eigen::VectorXd::Ones(rows));
  };
  const InSequence::Scope sequence(true);
  SparseActiveBlock kept;
  for (const int missing : {0, 0, 40, 50, 0, 2, 90, 90, 40}) {
    const LcpProblem problem = chain(1500, missing);
    const Index n = problem.size();
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
    const std::vector<char> active(static_cast<size_t>(n), 1);
    kept.Analyze(problem);
    kept.Load(problem, ones);
    ASSERT_TRUE(kept.Factor(active, 1e-3, nullptr));
    Eigen::VectorXd x = ones, y(n);
    kept.Solve(x.data());
    kept.Multiply(x.data(), y.data());
    const Eigen::VectorXd residual = y + 1e-3 * problem.DiagonalA().cwiseProduct(x) - ones;
    EXPECT_LE(residual.cwiseAbs().maxCoeff(), 1e-9 * (1 + x.cwiseAbs().maxCoeff())) << missing;
    SparseActiveBlock fresh;
    fresh.Analyze(problem);
    EXPECT_LE(kept.factor_time(), KeptOrder::kMostWork * fresh.factor_time() * 1.05) << missing;
  }
}

}  // namespace
}  // namespace lcpbench
