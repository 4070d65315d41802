#include "solvers/lcp/verify.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "solvers/lcp/residual.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

LcpProblem Diagonal(std::initializer_list<double> diagonal, std::initializer_list<double> b, MatrixFacts facts = {}) {
  Eigen::VectorXd d = Eigen::Map<const Eigen::VectorXd>(diagonal.begin(), static_cast<Index>(diagonal.size()));
  Eigen::VectorXd rhs = Eigen::Map<const Eigen::VectorXd>(b.begin(), static_cast<Index>(b.size()));
  return LcpProblem::FromDense("diagonal", d.asDiagonal(), rhs, {}, facts);
}

LcpResult Claim(LcpStatus status, Eigen::VectorXd f) {
  LcpResult result;
  result.status = status;
  result.f = std::move(f);
  return result;
}

// A symmetric positive definite A, a planted solution with f and w complementary, b = w - A f.
struct Planted {
  LcpProblem problem;
  Eigen::VectorXd f;
  Eigen::VectorXd w;
};

Planted Plant(Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(n, n);
  for (double& x : root.reshaped()) x = normal(random);
  Eigen::MatrixXd A = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
  A = (0.5 * (A + A.transpose())).eval();
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) (random() % 2 == 0 ? f : w)[i] = std::abs(normal(random));
  return {LcpProblem::FromDense("planted", A, w - A * f, {}, SymmetricPsd()), f, w};
}

TEST(Verify, AnExactSolutionPassesTheStrictestTier) {
  const LcpProblem problem = Diagonal({2, 4}, {-6, 3});
  const Verdict verdict = Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(3, 0)), 1e-9);
  EXPECT_TRUE(verdict.passes);
  EXPECT_EQ(verdict.best_tier, 1e-9);
  EXPECT_FALSE(verdict.false_success);
  EXPECT_EQ(verdict.metrics.rho, 0);
  EXPECT_EQ(verdict.metrics.w, Eigen::Vector2d(0, 3));
}

TEST(Verify, MetricsFollowTheirFormulas) {
  // D = (4, 9), f = (1, -1), w = (4 - 2, -9 + 6) = (2, -3).
  const LcpProblem problem = Diagonal({4, 9}, {-2, 6});
  const Metrics m = ComputeMetrics(problem, Eigen::Vector2d(1, -1));
  EXPECT_EQ(m.w, Eigen::Vector2d(2, -3));
  // r = (min(2, 1), min(-3, -1)) = (1, -3); |D^-1/2 b| = |(-1, 2)|.
  EXPECT_DOUBLE_EQ(m.rho, std::sqrt(10.0) / std::sqrt(5.0));
  // (|min(4, 2)| / (4 + 2), |min(-9, -3)| / (9 + 6)).
  EXPECT_DOUBLE_EQ(m.backward_error, 9.0 / 15.0);
  EXPECT_DOUBLE_EQ(m.natural_residual, 3);
  EXPECT_DOUBLE_EQ(m.natural_residual_siconos, std::sqrt(1.0 + 9.0) / std::sqrt(40.0));
  EXPECT_DOUBLE_EQ(m.primal_infeasibility, 1);
  EXPECT_DOUBLE_EQ(m.dual_infeasibility, 3);
  EXPECT_DOUBLE_EQ(m.complementarity, 3);
  EXPECT_DOUBLE_EQ(m.gap, 5);                       // 2 + 3
  EXPECT_DOUBLE_EQ(m.gap_rel, 5.0 / (13.0 + 8.0));  // f.Af = 4 + 9, |b.f| = |-2 - 6|
  const auto fb = [](double p, double q) { return std::hypot(p, q) - p - q; };
  EXPECT_NEAR(m.fischer_burmeister, 0.5 * (fb(2, 1) * fb(2, 1) + fb(-3, -1) * fb(-3, -1)), 1e-14);
}

TEST(Verify, BilateralRowsAreJudgedByWAlone) {
  const LcpProblem problem = LcpProblem::FromDense("b", 2 * Eigen::Matrix2d::Identity(), Eigen::Vector2d(4, 4),
                                                   RowBounds::WithBilateralRows(2, {0}));
  EXPECT_TRUE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(-2, 0)), 1e-9).passes);
  EXPECT_FALSE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(0, 0)), 1e-3).passes);
}

TEST(Verify, RhoAndBackwardErrorAreIndependentOfUnitsAndRowScaling) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const Planted planted = Plant(8, seed);
    std::mt19937 random(seed);
    Eigen::VectorXd scale(8);
    for (double& s : scale) s = std::ldexp(1.0, static_cast<int>(random() % 80) - 40);  // powers of two: no rounding
    const Eigen::MatrixXd A = scale.asDiagonal() * planted.problem.DenseA() * scale.asDiagonal();
    const LcpProblem scaled = LcpProblem::FromDense("scaled", A, scale.cwiseProduct(planted.problem.b()));
    Eigen::VectorXd f = planted.f;
    f[0] += 1e-4;  // some error, so that there is something to compare
    const Metrics m1 = ComputeMetrics(planted.problem, f);
    const Metrics m2 = ComputeMetrics(scaled, f.cwiseQuotient(scale));
    // The square roots of D round differently.
    EXPECT_NEAR(m2.rho, m1.rho, 1e-12 * m1.rho);
    EXPECT_NEAR(m2.backward_error, m1.backward_error, 1e-12 * m1.backward_error);
    EXPECT_NEAR(m2.fischer_burmeister, m1.fischer_burmeister, 1e-11 * m1.fischer_burmeister);
  }
}

TEST(Verify, OneBadRowIsNotHiddenByAHugeB) {
  // rho is small because |b| is dominated by row 1; the backward error of row 0 is 1.
  const LcpProblem problem = Diagonal({1, 1}, {-1, 1e12});
  const Verdict verdict = Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(0, 0)), 1e-9);
  EXPECT_LE(verdict.metrics.rho, 1e-9);
  EXPECT_FALSE(verdict.passes);
  EXPECT_TRUE(verdict.false_success);
  EXPECT_NE(verdict.reason.find("backward error"), std::string::npos);
}

TEST(Verify, NotANumberNeverPasses) {
  const LcpProblem problem = Diagonal({1, 1}, {-1, 1});
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    const Verdict verdict = Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(1, bad)), 1e-3);
    EXPECT_FALSE(verdict.passes);
    EXPECT_TRUE(verdict.false_success);
    EXPECT_EQ(verdict.best_tier, 0);
  }
  // Finite but so large that w overflows.
  EXPECT_FALSE(Verify(Diagonal({1e300, 1}, {1, 1}), Claim(LcpStatus::kSolved, Eigen::Vector2d(1e300, 0)), 1e-3).passes);
  EXPECT_FALSE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::VectorXd(1)), 1e-3).passes);  // wrong length
}

TEST(Verify, OnlyAClaimOfSuccessCanBeAFalseSuccess) {
  const LcpProblem problem = Diagonal({1}, {-1});
  for (const LcpStatus status : {LcpStatus::kIterationLimit, LcpStatus::kTimeLimit, LcpStatus::kNumericalFailure,
                                 LcpStatus::kInfeasible, LcpStatus::kUnsupported}) {
    EXPECT_FALSE(Verify(problem, Claim(status, Eigen::VectorXd::Zero(1)), 1e-6).false_success);
  }
  EXPECT_TRUE(Verify(problem, Claim(LcpStatus::kInfeasible, Eigen::VectorXd::Ones(1)), 1e-6).false_infeasible);
}

TEST(Verify, AbsoluteResidualsWhereBIsZero) {
  const LcpProblem problem = Diagonal({4}, {0});
  EXPECT_DOUBLE_EQ(ComputeMetrics(problem, Eigen::VectorXd::Constant(1, 1e-4)).rho, 2e-4);
  EXPECT_TRUE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::VectorXd::Zero(1)), 1e-9).passes);
}

TEST(Verify, ZeroDiagonalCountsAsOne) {
  const LcpProblem problem = Diagonal({0, 1}, {2, -1});
  EXPECT_TRUE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(0, 1)), 1e-9).passes);
  EXPECT_FALSE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(1, 1)), 1e-3).passes);
}

TEST(Verify, EnergyCertificateBoundsTheErrorOfTheShiftedProblem) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Planted planted = Plant(6, seed);
    std::mt19937 random(1000 + seed);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd& A = planted.problem.DenseA();
    Eigen::VectorXd f = planted.f;
    for (double& x : f) x = std::max(0.0, x + 0.1 * normal(random));
    const Eigen::VectorXd w = A * f + planted.problem.b();
    const Eigen::VectorXd shifted_b = planted.problem.b() + (w.cwiseMax(0) - w);
    // The exact solution of the shifted problem by projected Gauss-Seidel, to convergence (A is well conditioned).
    Eigen::VectorXd exact = Eigen::VectorXd::Zero(6);
    for (int sweep = 0; sweep < 20000; ++sweep) {
      for (Index i = 0; i < 6; ++i) {
        exact[i] = std::max(0.0, exact[i] - (A.row(i).dot(exact) + shifted_b[i]) / A(i, i));
      }
    }
    const double error = (f - exact).dot(A * (f - exact));
    const Metrics m = ComputeMetrics(planted.problem, f);
    EXPECT_LE(error, m.energy_bound * (1 + 1e-9) + 1e-12);
    EXPECT_NEAR(m.energy_bound, f.dot(w.cwiseMax(0)), 1e-9 * (1 + m.energy_bound));
    const Eigen::VectorXd scaled_shift = (shifted_b - planted.problem.b()).cwiseQuotient(A.diagonal().cwiseSqrt());
    EXPECT_NEAR(m.energy_shift, scaled_shift.norm(), 1e-9);
  }
}

TEST(Verify, FischerBurmeisterDoesNotCancel) {
  // p = 1, q = 1e-12: sqrt(1 + q^2) - 1 - q = -q to first order; the naive form in double keeps four digits only.
  const LcpProblem problem = Diagonal({1}, {-1 + 0x1p-40});
  const Metrics m = ComputeMetrics(problem, Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(m.fischer_burmeister / (0.5 * 0x1p-80), 1.0, 1e-10);
}

TEST(Verify, EveryFormIsJudgedAlike) {
  SparseMatrix J(3, 6);
  J.insert(0, 0) = 1;
  J.insert(0, 3) = -1;
  J.insert(1, 1) = 2;
  J.insert(2, 3) = 1;
  J.insert(2, 5) = 3;
  Eigen::VectorXd inverse_mass(6);
  inverse_mass << 1, 2, 0, 4, 4, 0.5;
  const Eigen::Vector3d b(-1, 2, -3);
  const LcpProblem factors = LcpProblem::FromFactors("j", J, inverse_mass, b);
  const LcpProblem dense = LcpProblem::FromDense("d", factors.DenseA(), b);
  const LcpProblem sparse = LcpProblem::FromSparse("s", factors.SparseA(), b);
  const Eigen::Vector3d f(0.25, -0.5, 0.75);
  const Metrics m = ComputeMetrics(factors, f);
  for (const LcpProblem& other : {dense, sparse}) {
    const Metrics n = ComputeMetrics(other, f);
    EXPECT_EQ(m.w, n.w);
    EXPECT_DOUBLE_EQ(m.rho, n.rho);
    EXPECT_DOUBLE_EQ(m.backward_error, n.backward_error);
  }
}

TEST(Verify, SolversEstimateAgreesWithTheMetrics) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Planted planted = Plant(10, seed);
    Eigen::VectorXd f = planted.f + Eigen::VectorXd::Constant(10, 1e-3);
    Eigen::VectorXd w;
    planted.problem.ComputeW(f, &w);
    const Metrics m = ComputeMetrics(planted.problem, f);
    for (const auto rows : {ResidualEstimate::Rows::kDense, ResidualEstimate::Rows::kSparse}) {
      ResidualEstimate estimate;
      estimate.Reset(planted.problem, rows);
      estimate.SetB(planted.problem);
      EXPECT_NEAR(estimate.Rho(f, w), m.rho, 1e-12 * (1 + m.rho));
      EXPECT_NEAR(estimate.BackwardError(f, w), m.backward_error, 1e-12);
    }
  }
}

TEST(Verify, RoundingIsNotDividedByAScaleThatCancels) {
  // Row 1 is perpendicular to row 0 up to rounding of 0.1 and 0.3; b_1 = 0, so |A||f| + |b| is 0 or rounding there.
  SparseMatrix J(2, 3);
  J.insert(0, 0) = 0.1;
  J.insert(0, 1) = 0.3;
  J.insert(1, 0) = 0.3;
  J.insert(1, 1) = -0.1;
  const double d = 0.1 * 0.1 + 0.3 * 0.3;
  const LcpProblem problem =
      LcpProblem::FromFactors("perpendicular", J, Eigen::Vector3d(1, 1, 1), Eigen::Vector2d(-1.0 / 3.0, 0));
  const Verdict verdict = Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(1.0 / 3.0 / d, 0)), 1e-9);
  EXPECT_TRUE(verdict.passes) << verdict.reason;
}

TEST(FarkasRay, AnExactRayIsAccepted) {
  // w_0 = f_0 - f_1 - 1, w_1 = -f_0 + f_1 - 1: y = (1, 1) has A y = 0, b.y = -2.
  Eigen::Matrix2d A;
  A << 1, -1, -1, 1;
  const LcpProblem problem = LcpProblem::FromDense("opposed", A, Eigen::Vector2d(-1, -1));
  const FarkasVerdict verdict = VerifyFarkasRay(problem, Eigen::Vector2d(1, 1));
  EXPECT_TRUE(verdict.accepted) << verdict.reason;
  EXPECT_EQ(verdict.b_dot_y, -2);
}

TEST(FarkasRay, ASmallAyIsNotAProof) {
  // f = (0, 1e10) solves this problem, although y = (0, 1) has |A y| = 1e-10.
  const LcpProblem problem = Diagonal({1, 1e-10}, {1, -1});
  const FarkasVerdict verdict = VerifyFarkasRay(problem, Eigen::Vector2d(0, 1));
  EXPECT_FALSE(verdict.accepted);
  EXPECT_TRUE(Verify(problem, Claim(LcpStatus::kSolved, Eigen::Vector2d(0, 1e10)), 1e-9).passes);
}

// A column of light and heavy bodies in turns is solvable, by forces whose sum is 6 10^12 |b| and more. Along the
// forces y under which body k falls with k + 1 times a unit A y is constant, and so small that F_min alone would take y
// for a proof.
TEST(FarkasRay, AForceThatIsOnlyLargeIsNotAProof) {
  for (const auto& [n, ratio] : {std::pair<Index, double>{8000, 1e6}, {500, 1e8}, {2000, 1e8}}) {
    const StackedColumn column = MakeStackedColumn(n, ratio);
    Eigen::VectorXd y(n);
    double above = 0;
    for (Index k = n - 1; k >= 0; --k) {
      above += static_cast<double>(k + 1) / column.problem.inverse_mass()[3 * k];
      y[k] = above;
    }
    const FarkasVerdict verdict = VerifyFarkasRay(column.problem, y);
    EXPECT_FALSE(verdict.accepted) << n;
    EXPECT_GT(verdict.force_min, FarkasVerdict::kRayThreshold * column.problem.b().lpNorm<1>()) << n;
    EXPECT_GT(verdict.null_residual, FarkasVerdict::kNullTolerance) << n;
  }
}

TEST(FarkasRay, WrongSignsAreRefused) {
  Eigen::Matrix2d A;
  A << 1, -1, -1, 1;
  const LcpProblem problem = LcpProblem::FromDense("opposed", A, Eigen::Vector2d(-1, -1));
  EXPECT_FALSE(VerifyFarkasRay(problem, Eigen::Vector2d(-1, -1)).accepted);
  EXPECT_FALSE(VerifyFarkasRay(problem, Eigen::Vector2d(1, kNaN)).accepted);
  EXPECT_FALSE(VerifyFarkasRay(problem, Eigen::VectorXd::Ones(3)).accepted);
  const LcpProblem solvable = LcpProblem::FromDense("solvable", A, Eigen::Vector2d(-1, 1));
  EXPECT_FALSE(VerifyFarkasRay(solvable, Eigen::Vector2d(1, 1)).accepted);  // b.y = 0
  // On bilateral rows y is free.
  const LcpProblem joints =
      LcpProblem::FromDense("joints", A, Eigen::Vector2d(1, 1), RowBounds::WithBilateralRows(2, {0, 1}));
  EXPECT_TRUE(VerifyFarkasRay(joints, Eigen::Vector2d(-1, -1)).accepted);
}

}  // namespace
}  // namespace lcpbench
