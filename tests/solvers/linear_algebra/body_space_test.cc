#include "solvers/linear_algebra/body_space.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>

#include "solvers/lcp/in_sequence.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

struct Scaled {
  LcpProblem problem;
  Eigen::VectorXd root;
  Eigen::MatrixXd A;  // unit diagonal
};

Scaled RandomScene(unsigned seed) {
  const int bodies = 1 + static_cast<int>(seed % 17);
  const Index rows = 1 + static_cast<Index>((seed * 7) % 60);
  Scaled scene{PlantedProblem(rows, bodies, seed, static_cast<int>(seed % 3), 4).problem, {}, {}};
  scene.root = scene.problem.DiagonalA().cwiseSqrt();
  scene.A = scene.root.cwiseInverse().asDiagonal() * scene.problem.DenseA() * scene.root.cwiseInverse().asDiagonal();
  return scene;
}

TEST(BodySpace, MultipliesAndSolvesWithAnyPositiveDiagonalWhateverTheRank) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Scaled scene = RandomScene(seed);
    const Index n = scene.problem.size();
    ASSERT_TRUE(BodySpace::Suits(scene.problem));
    BodySpace bodies;
    bodies.Prepare(scene.problem, {});
    bodies.Load(scene.problem, scene.root);
    std::mt19937_64 random(seed);
    const Eigen::VectorXd f = UniformVector(&random, n, -1, 1);
    Eigen::VectorXd y(n);
    bodies.Multiply(f.data(), y.data());
    EXPECT_LE((y - scene.A * f).cwiseAbs().maxCoeff(), 1e-13 * static_cast<double>(n)) << seed;
    for (const double spread : {0.0, 3.0, 6.0}) {  // theta from 10^-spread to 10^spread
      Eigen::VectorXd theta = UniformVector(&random, n, -spread, spread);
      for (double& t : theta) t = std::pow(10.0, t);
      ASSERT_TRUE(bodies.Factorize(theta)) << bodies.why();
      const Eigen::VectorXd r = UniformVector(&random, n, -1, 1);
      Eigen::VectorXd x;
      bodies.Solve(r, &x);
      const Eigen::MatrixXd shifted = scene.A + Eigen::MatrixXd(theta.asDiagonal());
      // eps / theta of the right-hand side is what the form loses.
      EXPECT_LE((shifted * x - r).cwiseAbs().maxCoeff(), 1e-13 * std::pow(10.0, 2 * spread)) << seed << " " << spread;
    }
  }
}

TEST(BodySpace, RowsThatAreOutDoNotMove) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Scaled scene = RandomScene(seed);
    const Index n = scene.problem.size();
    std::vector<char> taking_part(static_cast<size_t>(n), 1);
    Eigen::VectorXd theta = Eigen::VectorXd::Constant(n, 0.5);
    Eigen::MatrixXd kept = scene.A + 0.5 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd r = Eigen::VectorXd::Ones(n);
    for (Index i = 0; i < n; ++i) {
      if (i % 3 == 0) continue;
      if (i % 3 == 1) taking_part[static_cast<size_t>(i)] = 0;
      if (i % 3 == 2) theta[i] = BodySpace::kOut;
      kept.row(i).setZero();
      kept.col(i).setZero();
      kept(i, i) = 1;
      r[i] = 0;
    }
    BodySpace bodies;
    bodies.Prepare(scene.problem, taking_part);
    bodies.Load(scene.problem, scene.root);
    ASSERT_TRUE(bodies.Factorize(theta));
    Eigen::VectorXd x;
    bodies.Solve(r, &x);
    EXPECT_LE((x - kept.ldlt().solve(r)).cwiseAbs().maxCoeff(), 1e-12) << seed;
  }
}

// Bodies in a ring of `bodies`, rows between neighbours and some `reach` further on; every `missing`-th row is left
// out.
LcpProblem Ring(int bodies, int reach, int missing) {
  Triplets entries;
  int rows = 0;
  int drawn = 0;
  const auto join = [&](int a, int b) {
    std::mt19937 random(static_cast<unsigned>(++drawn));
    if (missing > 0 && drawn % missing == 0) return;
    for (int k = 0; k < 3; ++k) {
      entries.emplace_back(rows, 3 * a + k, (static_cast<int>(random() % 17) - 8) / 8.0 + (k == 0 ? 2.0 : 0.0));
      entries.emplace_back(rows, 3 * b + k, (static_cast<int>(random() % 17) - 8) / 8.0);
    }
    ++rows;
  };
  for (int a = 0; a < bodies; ++a) {
    join(a, (a + 1) % bodies);
    join(a, (a + reach) % bodies);
  }
  return LcpProblem::FromFactors("ring", MatrixOf(rows, 3 * bodies, entries), Eigen::VectorXd::Ones(3 * bodies),
                                 Eigen::VectorXd::Ones(rows));
}

int AnalysesOf(const LcpProblem& problem, BodySpace* bodies) {
  const Index n = problem.size();
  const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt();
  bodies->Prepare(problem, {});
  bodies->Load(problem, root);
  const Eigen::VectorXd theta = Eigen::VectorXd::Constant(n, 0.25);
  EXPECT_TRUE(bodies->Factorize(theta));
  std::mt19937_64 random(5);
  const Eigen::VectorXd r = UniformVector(&random, n, -1, 1);
  Eigen::VectorXd x, y(n);
  bodies->Solve(r, &x);
  bodies->Multiply(x.data(), y.data());
  const Eigen::VectorXd product = (problem.SparseA() * x.cwiseQuotient(root)).cwiseQuotient(root);
  EXPECT_LE((y - product).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((product + 0.25 * x - r).cwiseAbs().maxCoeff(), 1e-12);
  return bodies->analyses();
}

TEST(BodySpace, InASequenceKeepsTheAnalysisOfTheSameRows) {
  for (const bool in_sequence : {true, false}) {
    const InSequence::Scope sequence(in_sequence);
    for (int bodies = 20; bodies <= 500; bodies += 120) {
      BodySpace space;
      for (const int reach : {3, 5}) {
        for (const int missing : {13, 0, 2}) {
          EXPECT_EQ(AnalysesOf(Ring(bodies, reach, missing), &space), 1);
          EXPECT_EQ(AnalysesOf(Ring(bodies, reach, missing), &space), in_sequence ? 0 : 1);
        }
      }
    }
  }
}

TEST(GraphOrder, IsAPermutationThatKeepsTreesFreeOfFill) {
  using Graph = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    const int n = 1 + static_cast<int>(random() % 200);
    Triplets edges;
    for (int k = 1; k < n; ++k) edges.emplace_back(k, static_cast<int>(random() % static_cast<unsigned>(k)), 1.0);
    Graph graph(n, n);
    graph.setFromTriplets(edges.begin(), edges.end());
    for (const GraphOrder order : {GraphOrder::kMinimumDegree, GraphOrder::kNestedDissection}) {
      const Eigen::VectorXi nodes = OrderGraph(graph, order);
      ASSERT_EQ(nodes.size(), n);
      std::vector<Index> sorted(nodes.begin(), nodes.end());
      std::sort(sorted.begin(), sorted.end());
      ASSERT_EQ(sorted, EveryRow(n));
      if (order == GraphOrder::kNestedDissection) continue;
      // A tree has a perfect order: every node has at most one neighbour that is eliminated after it.
      std::vector<int> place(static_cast<size_t>(n)), later(static_cast<size_t>(n), 0);
      for (int k = 0; k < n; ++k) place[static_cast<size_t>(nodes[k])] = k;
      for (const auto& edge : edges) {
        const int p = place[static_cast<size_t>(edge.row())], q = place[static_cast<size_t>(edge.col())];
        ++later[static_cast<size_t>(std::min(p, q))];
      }
      EXPECT_LE(*std::max_element(later.begin(), later.end()), 1) << seed;
    }
  }
}

}  // namespace
}  // namespace lcpbench
