#include "benchmarks/measure/body_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <set>

#include "benchmarks/measure/oracle.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"

namespace lcpbench {
namespace {

LcpProblem Scene(std::string_view key, int rows, std::uint64_t seed) {
  return AssembleContactLcp(GenerateScene(key, rows, seed)).problem;
}

// Every third row is left out, so that some bodies are coupled to nothing.
std::vector<Index> SomeRows(const LcpProblem& problem) {
  std::vector<Index> rows;
  for (Index i = 0; i < problem.size(); ++i) {
    if (i % 3 != 1) rows.push_back(i);
  }
  return rows;
}

int BodyOf(const BodySystem& system, int unknown) { return system.column_of[static_cast<std::size_t>(unknown)] / 3; }

TEST(BodySystem, IsMassPlusStiffnessOfTheActiveRows) {
  for (const SceneFamily& family : AllScenes()) {
    SCOPED_TRACE(family.key);
    const LcpProblem problem = Scene(family.key, 25, 2);
    const std::vector<Index> rows = SomeRows(problem);
    const BodySystem system = MakeBodySystem(problem, rows);
    const auto unknowns = static_cast<Index>(system.column_of.size());
    Eigen::MatrixXd J(static_cast<Index>(rows.size()), unknowns);
    Eigen::VectorXd stiffness(J.rows());
    const Eigen::MatrixXd all = problem.J();
    for (Index i = 0; i < J.rows(); ++i) {
      const Index row = rows[static_cast<std::size_t>(i)];
      stiffness[i] = kStiffness / problem.DenseA()(row, row);
      for (Index k = 0; k < unknowns; ++k) J(i, k) = all(row, system.column_of[static_cast<std::size_t>(k)]);
    }
    Eigen::MatrixXd expected = J.transpose() * stiffness.asDiagonal() * J;
    for (Index k = 0; k < unknowns; ++k) {
      expected(k, k) += 1 / problem.inverse_mass()[system.column_of[static_cast<std::size_t>(k)]];
    }
    const Eigen::MatrixXd lower = system.lower;
    EXPECT_EQ(lower.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().norm(), 0);
    const Eigen::MatrixXd difference = lower - expected.triangularView<Eigen::Lower>().toDenseMatrix();
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-14 * expected.cwiseAbs().maxCoeff());
  }
}

// What is left out neither moves nor is touched.
TEST(BodySystem, HasEveryMovableBodyOfAnActiveRow) {
  for (const SceneFamily& family : AllScenes()) {
    SCOPED_TRACE(family.key);
    const LcpProblem problem = Scene(family.key, 25, 2);
    std::set<int> expected;
    for (const Index row : SomeRows(problem)) {
      for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
        if (problem.inverse_mass()[it.col()] > 0 && it.value() != 0) expected.insert(static_cast<int>(it.col()) / 3);
      }
    }
    const BodySystem system = MakeBodySystem(problem, SomeRows(problem));
    ASSERT_EQ(system.bodies(), static_cast<int>(expected.size()));
    auto next = expected.begin();
    for (int body = 0; body < system.bodies(); ++body, ++next) {
      const auto at = static_cast<std::size_t>(body);
      ASSERT_LT(system.first[at], system.first[at + 1]);
      for (int k = system.first[at]; k < system.first[at + 1]; ++k) EXPECT_EQ(BodyOf(system, k), *next);
    }
  }
}

// Two bodies are neighbours where the matrix has a block between them.
TEST(BodySystem, GraphIsThePatternOfItsBlocks) {
  const LcpProblem problem = Scene("boxes-and-discs", 60, 1);
  const BodySystem system = MakeBodySystem(problem, SomeRows(problem));
  const Eigen::MatrixXd lower = system.lower;
  const Eigen::MatrixXd graph = system.graph;
  ASSERT_GT(system.graph.nonZeros(), 0);
  for (int i = 0; i < system.bodies(); ++i) {
    for (int j = 0; j < i; ++j) {
      const int row = system.first[static_cast<std::size_t>(i)];
      const int column = system.first[static_cast<std::size_t>(j)];
      const int height = system.first[static_cast<std::size_t>(i) + 1] - row;
      const int width = system.first[static_cast<std::size_t>(j) + 1] - column;
      const bool coupled = !lower.block(row, column, height, width).isZero(0);
      EXPECT_EQ(graph(i, j) != 0, coupled);
      EXPECT_EQ(graph(j, i), graph(i, j));
    }
  }
}

TEST(BodySystem, AnOrderOfBodiesKeepsTheUnknownsOfABodyTogether) {
  const LcpProblem problem = Scene("rounded-wall", 80, 1);
  const BodySystem system = MakeBodySystem(problem, SomeRows(problem));
  const Eigen::VectorXi backwards = Eigen::VectorXi::LinSpaced(system.bodies(), system.bodies() - 1, 0);
  const Eigen::VectorXi order = system.Expand(backwards);
  ASSERT_EQ(order.size(), system.lower.cols());
  EXPECT_TRUE(std::is_permutation(
      order.begin(), order.end(),
      Eigen::VectorXi::LinSpaced(order.size(), 0, static_cast<int>(order.size()) - 1).eval().begin()));
  for (Index k = 1; k < order.size(); ++k) {
    const int body = BodyOf(system, order[k]);
    EXPECT_LE(body, BodyOf(system, order[k - 1]));
    if (body == BodyOf(system, order[k - 1])) EXPECT_EQ(order[k], order[k - 1] + 1);
  }
}

TEST(BodySystem, OfNoRowsIsEmpty) {
  const LcpProblem problem = Scene("disc-pile", 20, 1);
  const BodySystem system = MakeBodySystem(problem, {});
  EXPECT_EQ(system.bodies(), 0);
  EXPECT_EQ(system.lower.cols(), 0);
}

}  // namespace
}  // namespace lcpbench
