// The bound of the least eigenvalue against exact elimination, and gaps in integers against rationals.

#include "solvers/exact/independent_block.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/exact/dyadic_lcp.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/flint_matrix.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// Whether S A_GG S - bound I is positive semidefinite, exactly.
bool IsBelowAllEigenvalues(const LcpProblem& problem, const IndependentBlock& factor, double bound) {
  const ExactLcp lcp = ExactFrom(problem);
  const std::vector<Index>& rows = factor.independent();
  const auto n = static_cast<Index>(rows.size());
  // All doubles: integers in units of 2^-kBits.
  constexpr long kBits = 2000;
  IntegerMatrix integer(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      Rational entry = lcp.A[At(rows[At(i)] * lcp.size + rows[At(j)])] * Rational(factor.factor().scale()[i]) *
                       Rational(factor.factor().scale()[j]);
      if (i == j) entry -= Rational(bound);
      fmpz_set_mpz(integer.at(i, j), numerator(Shifted(entry, kBits)).backend().data());
    }
  }
  return IsPositiveSemidefinite(integer);
}

std::vector<Index> RowsThatMove(const LcpProblem& problem) {
  std::vector<Index> rows;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.DiagonalA()[i] > 0) rows.push_back(i);
  }
  return rows;
}

TEST(IndependentBlock, TheBoundIsBelowTheLeastEigenvalueAndNearIt) {
  int tight = 0;
  for (const SceneFamily& scene : AllScenes()) {
    for (const int size : {5, 20}) {
      const LcpProblem problem = AssembleContactLcp(GenerateScene(scene.key, size, 4)).problem;
      SCOPED_TRACE(problem.id());
      const IndependentBlock factor(problem, RowsThatMove(problem));
      const double bound = factor.LeastEigenvalueBound();
      EXPECT_TRUE(IsBelowAllEigenvalues(problem, factor, bound));
      if (bound == 0) continue;
      constexpr double kFarTooMuch = 4;
      tight += IsBelowAllEigenvalues(problem, factor, kFarTooMuch * bound) ? 0 : 1;
    }
  }
  EXPECT_GT(tight, 20);
}

// Two rows that are more and more alike, until nothing but their last digits tells them apart.
TEST(IndependentBlock, TheBoundHoldsAndVanishesWhereRowsBecomeDependent) {
  bool vanished = false;
  for (int digits = 1; digits <= 60; ++digits) {
    Eigen::MatrixXd J(2, 3);
    J << 1, 0.3, 0.7, 1, 0.3, 0.7 + std::ldexp(1.0, -digits);
    const LcpProblem problem =
        LcpProblem::FromFactors("alike", J.sparseView(), Eigen::Vector3d(1, 0.1, 1 / 3.0), Eigen::Vector2d(-1, -1));
    const IndependentBlock factor(problem, {0, 1});
    const double bound = factor.LeastEigenvalueBound();
    EXPECT_TRUE(IsBelowAllEigenvalues(problem, factor, bound)) << digits;
    EXPECT_TRUE(bound > 0 || digits >= 10) << digits;
    vanished = vanished || bound == 0 || !factor.dependent().empty();
  }
  EXPECT_TRUE(vanished);
}

TEST(IndependentBlock, SolvesAndLeavesOutRowsThatAreThereTwice) {
  Eigen::MatrixXd J(3, 3);
  J << 1, 0, 0.5, 2, 0, 1, 0, 1, 0.25;
  const LcpProblem problem =
      LcpProblem::FromFactors("twice", J.sparseView(), Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-1, -2, 1));
  const IndependentBlock factor(problem, {0, 1, 2});
  ASSERT_EQ(factor.dependent().size(), 1U);
  const std::vector<Index>& rows = factor.independent();
  const Eigen::Vector2d r(0.5, -2);
  const Eigen::VectorXd x = factor.factor().Solve(r);
  for (Index i = 0; i < 2; ++i) {
    double sum = 0;
    for (Index j = 0; j < 2; ++j) sum += problem.DenseA()(rows[At(i)], rows[At(j)]) * x[j];
    EXPECT_NEAR(sum, r[i], 1e-14);
  }
}

TEST(DyadicLcp, GapsAreExact) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-300, 300);
  for (int k = 0; k < 40; ++k) {
    const auto wild = [&](double) {
      return k % 2 == 0 ? mantissa(random) : std::ldexp(mantissa(random), exponent(random));
    };
    const Index n = 6;
    const Eigen::MatrixXd half = Eigen::MatrixXd::Zero(n, n).unaryExpr(wild);
    const Eigen::MatrixXd symmetric = half + half.transpose();
    const Eigen::VectorXd b = Eigen::VectorXd::Zero(n).unaryExpr(wild);
    const Eigen::VectorXd mass = Eigen::VectorXd::Zero(n).unaryExpr(wild).cwiseAbs();
    for (const LcpProblem& problem :
         {LcpProblem::FromDense("dense", symmetric, b), LcpProblem::FromSparse("sparse", symmetric.sparseView(), b),
          LcpProblem::FromFactors("factors", half.sparseView(), mass, b)}) {
      SCOPED_TRACE(problem.id());
      const DyadicLcp dyadic(problem);
      const ExactLcp lcp = ExactFrom(problem);
      const long bits = std::max(dyadic.least_force_bits(), 2000L);
      std::vector<BigInteger> f, w;
      std::vector<Rational> exact;
      for (Index i = 0; i < n; ++i) {
        exact.emplace_back(wild(0));
        f.push_back(Scaled(exact.back().convert_to<double>(), bits));
      }
      dyadic.ComputeGaps(f, bits, &w);
      const Rational unit(BigInteger(1) << static_cast<unsigned>(bits + dyadic.matrix_bits()));
      for (Index i = 0; i < n; ++i) {
        Rational sum = lcp.b[At(i)];
        for (Index j = 0; j < n; ++j) sum += lcp.A[At(i * n + j)] * exact[At(j)];
        EXPECT_EQ(Rational(w[At(i)]) / unit, sum);
        const Rational diagonal =
            Rational(dyadic.diagonal(i)) / Rational(BigInteger(1) << static_cast<unsigned>(dyadic.matrix_bits()));
        EXPECT_EQ(diagonal, lcp.A[At(i * n + i)]);
      }
    }
  }
}

TEST(DyadicLcp, NeverRoundsBoundsDown) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::uint64_t> integers(1, ~0ULL);
  for (int k = 0; k < 1000; ++k) {
    const BigInteger x = integers(random), y = integers(random), z = integers(random);
    const Rational exact = Rational(x * y) / Rational(z), slack = exact * Rational(0x1p-51);
    const Rational above(RoundUp(exact)), root(RootUp(exact));
    EXPECT_GE(above, exact);
    EXPECT_LE(above, exact + slack);
    EXPECT_GE(root * root, exact);
    EXPECT_LE(root * root, exact + slack);
  }
  EXPECT_EQ(RoundUp(Rational(0.1)), 0.1);
  EXPECT_EQ(RootUp(Rational(2.25)), 1.5);
}

// |D^-1/2 d|_2 with D = (1/3 as a double, 1, 1), the last for an A_ii of 0.
TEST(DyadicLcp, BoundsTheScaledNorm) {
  constexpr double kThird = 1.0 / 3;
  const LcpProblem problem =
      LcpProblem::FromDense("", Eigen::Vector3d(kThird, 1, 0).asDiagonal().toDenseMatrix(), Eigen::Vector3d(1, 1, 1));
  const DyadicLcp lcp(problem);
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> integers(-1000, 1000);
  for (int k = 0; k < 100; ++k) {
    const std::vector<BigInteger> d = {integers(random), integers(random), integers(random)};
    const BigInteger rest = d[1] * d[1] + d[2] * d[2];
    const Rational exact = Shifted(Rational(d[0] * d[0]) / Rational(kThird) + Rational(rest), -200);
    const Rational norm(lcp.ScaledNorm(d, 100));
    EXPECT_GE(norm * norm, exact);
    EXPECT_LE(norm * norm, exact * (1 + Rational(0x1p-51)));
  }
}

}  // namespace
}  // namespace lcpbench
