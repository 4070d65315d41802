// The sparse factor of any principal submatrix, against Eigen's dense one, over random sequences of active sets.

#include "solvers/sparse_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

double ZeroClock() { return 0; }

// A = J M^-1 J^T of random two-body rows, with b of random size.
LcpProblem RandomContacts(int rows, int bodies, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
  std::vector<Eigen::Triplet<double, int>> entries;
  for (int i = 0; i < rows; ++i) {
    const int first = static_cast<int>(random() % static_cast<unsigned>(bodies));
    const int second = (first + 1 + static_cast<int>(random() % static_cast<unsigned>(bodies - 1))) % bodies;
    for (const int body : {first, second}) {
      for (int k = 0; k < 3; ++k) entries.emplace_back(i, 3 * body + k, uniform());
    }
  }
  SparseMatrix J(rows, 3 * bodies);
  J.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd inverse_mass(3 * bodies);
  for (double& m : inverse_mass) m = std::exp2(4 * uniform());
  Eigen::VectorXd b(rows);
  for (double& value : b) value = uniform();
  return LcpProblem::FromFactors("random-" + std::to_string(seed), J, inverse_mass, b);
}

struct Factored {
  explicit Factored(const LcpProblem& problem) {
    lcp.Analyse(problem);
    EXPECT_TRUE(factor.Analyse(lcp));
    EXPECT_TRUE(lcp.Load(problem));
    in_F.assign(static_cast<size_t>(lcp.n), 0);
    options.now = &ZeroClock;
  }
  OrderedLcp lcp;
  SparseLdlt factor;
  std::vector<char> in_F;
  LcpOptions options;
};

TEST(OrderedLcp, IsThePermutedScaledProblem) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LcpProblem problem = RandomContacts(30, 14, seed);
    const Factored given(problem);
    const OrderedLcp& lcp = given.lcp;
    const Eigen::MatrixXd& A = problem.DenseA();
    for (Eigen::Index p = 0; p < lcp.n; ++p) {
      const auto at = static_cast<size_t>(p);
      const int i = lcp.row[at];
      EXPECT_EQ(lcp.position[static_cast<size_t>(i)], p);
      EXPECT_GE(lcp.diagonal[p], 1);
      EXPECT_LT(lcp.diagonal[p], 4);
      EXPECT_EQ(lcp.b[p], problem.b()[i] * lcp.scale[p] * lcp.b_scale);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(lcp.n);
      for (int k = lcp.begin[at]; k < lcp.begin[at + 1]; ++k) {
        const int q = lcp.column[static_cast<size_t>(k)];
        row[lcp.row[static_cast<size_t>(q)]] = lcp.value[static_cast<size_t>(k)] / lcp.scale[p] / lcp.scale[q];
      }
      EXPECT_EQ(row, A.row(i).transpose()) << "scaling by powers of two rounds nothing";
    }
  }
}

TEST(SparseLdlt, SolvesWithEveryActiveSetOfASequence) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const int rows = 5 + static_cast<int>(seed) * 3;
    const LcpProblem problem = RandomContacts(rows, 4 + rows / 3, seed);
    Factored given(problem);
    std::mt19937_64 random(seed);
    Eigen::MatrixXd A(rows, rows);
    A.setZero();
    for (int p = 0; p < rows; ++p) {
      for (int k = given.lcp.begin[static_cast<size_t>(p)]; k < given.lcp.begin[static_cast<size_t>(p) + 1]; ++k) {
        A(p, given.lcp.column[static_cast<size_t>(k)]) = given.lcp.value[static_cast<size_t>(k)];
      }
    }
    const Deadline deadline(given.options);
    for (int step = 0; step < 40; ++step) {
      // A new set now and then; otherwise a few rows change, so that most of the factor is kept.
      const int changes = step % 10 == 0 ? rows : 1 + static_cast<int>(random() % 3);
      for (int k = 0; k < changes; ++k) given.in_F[random() % static_cast<unsigned>(rows)] ^= 1;
      const double shift = step < 20 ? 1e-3 : 1e-6;
      ASSERT_TRUE(given.factor.Factor(given.lcp, shift, given.in_F.data(), deadline));
      std::vector<int> expected;
      for (int p = 0; p < rows; ++p) {
        if (given.in_F[static_cast<size_t>(p)] != 0) expected.push_back(p);
      }
      ASSERT_EQ(given.factor.rows(), expected);
      const Eigen::VectorXd right = Eigen::VectorXd::Random(rows);
      Eigen::VectorXd x = right;
      given.factor.Solve(x.data());
      Eigen::MatrixXd block(expected.size(), expected.size());
      Eigen::VectorXd small(expected.size());
      for (Eigen::Index i = 0; i < small.size(); ++i) {
        small[i] = right[expected[static_cast<size_t>(i)]];
        for (Eigen::Index j = 0; j < small.size(); ++j) {
          block(i, j) =
              A(expected[static_cast<size_t>(i)], expected[static_cast<size_t>(j)]) * (i == j ? 1 + shift : 1);
        }
      }
      const Eigen::VectorXd y = block.ldlt().solve(small);
      for (int p = 0; p < rows; ++p) {
        if (given.in_F[static_cast<size_t>(p)] == 0) {
          EXPECT_EQ(x[p], 0);
        }
      }
      for (Eigen::Index i = 0; i < y.size(); ++i) {
        EXPECT_NEAR(x[expected[static_cast<size_t>(i)]], y[i], 1e-9 * (1 + y.cwiseAbs().maxCoeff())) << problem.id();
      }
    }
  }
}

TEST(SparseLdlt, KeepsNothingThatANewFactorWouldNotHave) {
  const LcpProblem problem = RandomContacts(60, 25, 7);
  Factored kept(problem);
  std::mt19937_64 random(3);
  const Deadline deadline(kept.options);
  for (int step = 0; step < 50; ++step) {
    for (int k = 0; k < 3; ++k) kept.in_F[random() % 60] ^= 1;
    Factored fresh(problem);
    ASSERT_TRUE(kept.factor.Factor(kept.lcp, 1e-4, kept.in_F.data(), deadline));
    ASSERT_TRUE(fresh.factor.Factor(fresh.lcp, 1e-4, kept.in_F.data(), deadline));
    Eigen::VectorXd x = Eigen::VectorXd::Ones(60);
    Eigen::VectorXd y = x;
    kept.factor.Solve(x.data());
    fresh.factor.Solve(y.data());
    EXPECT_EQ(x, y) << "step " << step;
  }
}

TEST(SparseLdlt, TellsAMatrixThatIsNotPsdByItsLeastPivot) {
  Eigen::MatrixXd A(2, 2);
  A << 1, 2, 2, 1;
  Factored given(LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(1, 1)));
  given.in_F.assign(2, 1);
  ASSERT_TRUE(given.factor.Factor(given.lcp, 1e-6, given.in_F.data(), Deadline(given.options)));
  EXPECT_LT(given.factor.least_pivot(), -1);
}

}  // namespace
}  // namespace lcpbench
