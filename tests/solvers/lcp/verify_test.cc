#include "solvers/lcp/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "solvers/lcp/exact_sum.h"
#include "solvers/lcp/residual.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

constexpr double kUnitRoundoff = 0x1p-53;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

LcpProblem Diagonal(std::initializer_list<double> diagonal, std::initializer_list<double> b, MatrixFacts facts = {}) {
  VectorXd d = Eigen::Map<const VectorXd>(diagonal.begin(), static_cast<Index>(diagonal.size()));
  VectorXd rhs = Eigen::Map<const VectorXd>(b.begin(), static_cast<Index>(b.size()));
  return LcpProblem::FromDense("diagonal", d.asDiagonal(), rhs, {}, facts);
}

// Rows of full rank, as a rule.
LcpProblem Definite(Index n, unsigned seed) { return PlantedProblem(n, static_cast<int>(n), seed, 0, 0).problem; }

VectorXd RandomVector(Index n, double low, double high, unsigned seed) {
  std::mt19937_64 random(seed);
  return UniformVector(&random, n, low, high);
}

// Powers of two: nothing rounds.
VectorXd PowersOfTwo(Index n, unsigned seed) {
  return RandomVector(n, -40, 40, seed).unaryExpr([](double x) { return std::exp2(std::floor(x)); });
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

TEST(Verify, SmallAnswersAreJudgedRowByRow) {
  const LcpProblem bilateral = LcpProblem::FromDense("b", 2 * Eigen::Matrix2d::Identity(), Eigen::Vector2d(4, 4),
                                                     RowBounds::WithBilateralRows(2, {0}));
  const LcpProblem zero_diagonal = Diagonal({0, 1}, {2, -1});
  const LcpProblem zero_b = Diagonal({4, 1}, {0, 0});
  struct {
    const LcpProblem& problem;
    Eigen::Vector2d f;
    bool passes;  // the strictest tier, or not even the loosest
  } const cases[] = {
      {bilateral, {-2, 0}, true},     {bilateral, {0, 0}, false}, {zero_diagonal, {0, 1}, true},
      {zero_diagonal, {1, 1}, false}, {zero_b, {0, 0}, true},
  };
  for (const auto& [problem, f, passes] : cases) {
    EXPECT_EQ(Verify(problem, Claim(f), passes ? 1e-9 : 1e-3).passes, passes) << f.transpose();
  }
  // Absolute where b is zero.
  EXPECT_DOUBLE_EQ(ComputeMetrics(zero_b, Eigen::Vector2d(1e-4, 0)).rho, 2e-4);
}

TEST(Verify, RhoAndBackwardErrorAreIndependentOfUnitsAndRowScaling) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const LcpProblem problem = Definite(8, seed);
    const VectorXd scale = PowersOfTwo(8, seed), f = RandomVector(8, -0.1, 1, seed);
    const Metrics m1 = ComputeMetrics(problem, f);
    const Metrics m2 = ComputeMetrics(InForm(ScaleRows(problem, scale, 1), MatrixForm::kDense), f.cwiseQuotient(scale));
    // The square roots of D round differently.
    EXPECT_NEAR(m2.rho, m1.rho, 1e-12 * m1.rho);
    EXPECT_NEAR(m2.backward_error, m1.backward_error, 1e-12 * m1.backward_error);
    EXPECT_NEAR(m2.fischer_burmeister, m1.fischer_burmeister, 1e-11 * m1.fischer_burmeister);
  }
}

// A_ii = 2^-1200 is no double; f pushes where the gap opens.
TEST(Verify, ForcesOnRowsWhoseDiagonalUnderflowsAreJudged) {
  SparseMatrix J(1, 1);
  J.insert(0, 0) = 0x1p-600;
  const LcpProblem problem = LcpProblem::FromFactors("tiny", J, VectorXd::Ones(1), VectorXd::Constant(1, 0x1p-190));
  EXPECT_EQ(problem.DiagonalA()[0], 0);
  EXPECT_GT(ComputeMetrics(problem, VectorXd::Constant(1, 0x1p1020)).backward_error, 0.5);
  EXPECT_EQ(ComputeMetrics(problem, VectorXd::Zero(1)).backward_error, 0);
}

TEST(Verify, NotANumberNeverPasses) {
  const LcpProblem problem = Diagonal({1, 1}, {-1, 1});
  for (const double bad : {kNotANumber, kInfinite, -kInfinite}) {
    const Verdict verdict = Verify(problem, Claim(Eigen::Vector2d(1, bad)), 1e-3);
    EXPECT_FALSE(verdict.passes);
    EXPECT_TRUE(verdict.false_success);
    EXPECT_EQ(verdict.best_tier, 0);
  }
  // Finite but so large that w overflows.
  EXPECT_FALSE(Verify(Diagonal({1e300, 1}, {1, 1}), Claim(Eigen::Vector2d(1e300, 0)), 1e-3).passes);
  EXPECT_FALSE(Verify(problem, Claim(VectorXd(1)), 1e-3).passes);  // wrong length
}

TEST(Verify, OnlyAClaimOfSuccessCanBeAFalseSuccess) {
  const LcpProblem problem = Diagonal({1}, {-1});
  for (const LcpStatus status : {LcpStatus::kIterationLimit, LcpStatus::kTimeLimit, LcpStatus::kNumericalFailure,
                                 LcpStatus::kInfeasible, LcpStatus::kUnsupported}) {
    EXPECT_FALSE(Verify(problem, Claim(VectorXd::Zero(1), status), 1e-6).false_success);
  }
  EXPECT_TRUE(Verify(problem, Claim(VectorXd::Ones(1), LcpStatus::kInfeasible), 1e-6).false_infeasible);
}

TEST(Verify, EnergyCertificateBoundsTheErrorOfTheShiftedProblem) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const LcpProblem problem = Definite(6, seed);
    const Eigen::MatrixXd& A = problem.DenseA();
    const VectorXd f = RandomVector(6, -1, 2, seed).cwiseMax(0);
    const VectorXd w = A * f + problem.b();
    const VectorXd shifted_b = problem.b() + (w.cwiseMax(0) - w);
    // The exact solution of the shifted problem by projected Gauss-Seidel, to convergence (A is well conditioned).
    VectorXd exact = VectorXd::Zero(6);
    for (int sweep = 0; sweep < 20000; ++sweep) {
      for (Index i = 0; i < 6; ++i) {
        exact[i] = std::max(0.0, exact[i] - (A.row(i).dot(exact) + shifted_b[i]) / A(i, i));
      }
    }
    const double error = (f - exact).dot(A * (f - exact));
    const Metrics m = ComputeMetrics(problem, f);
    EXPECT_LE(error, m.energy_bound * (1 + 1e-9) + 1e-12);
    EXPECT_NEAR(m.energy_bound, f.dot(w.cwiseMax(0)), 1e-9 * (1 + m.energy_bound));
    const VectorXd scaled_shift = (shifted_b - problem.b()).cwiseQuotient(A.diagonal().cwiseSqrt());
    EXPECT_NEAR(m.energy_shift, scaled_shift.norm(), 1e-9);
  }
}

TEST(Verify, FischerBurmeisterDoesNotCancel) {
  // p = 1, q = 1e-12: sqrt(1 + q^2) - 1 - q = -q to first order; the naive form in double keeps four digits only.
  const LcpProblem problem = Diagonal({1}, {-1 + 0x1p-40});
  const Metrics m = ComputeMetrics(problem, VectorXd::Ones(1));
  EXPECT_NEAR(m.fischer_burmeister / (0.5 * 0x1p-80), 1.0, 1e-10);
}

TEST(Verify, EveryFormIsJudgedAlike) {
  const Eigen::MatrixXd J = (Eigen::MatrixXd(3, 6) << 1, 0, 0, -1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 3).finished();
  const VectorXd inverse_mass = (VectorXd(6) << 1, 2, 0, 4, 4, 0.5).finished();
  const LcpProblem factors = LcpProblem::FromFactors("j", J.sparseView(), inverse_mass, Eigen::Vector3d(-1, 2, -3));
  const Eigen::Vector3d f(0.25, -0.5, 0.75);
  const Metrics m = ComputeMetrics(factors, f);
  for (const MatrixForm form : {MatrixForm::kDense, MatrixForm::kSparse}) {
    const Metrics n = ComputeMetrics(InForm(factors, form), f);
    EXPECT_EQ(m.w, n.w);
    EXPECT_DOUBLE_EQ(m.rho, n.rho);
    EXPECT_DOUBLE_EQ(m.backward_error, n.backward_error);
  }
}

TEST(Verify, SolversEstimateAgreesWithTheMetrics) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = Definite(10, seed);
    const VectorXd f = RandomVector(10, -0.1, 1, seed);
    VectorXd w;
    problem.ComputeW(f, &w);
    const Metrics m = ComputeMetrics(problem, f);
    for (const auto rows : {ResidualEstimate::Rows::kDense, ResidualEstimate::Rows::kSparse}) {
      ResidualEstimate estimate;
      estimate.Reset(problem, rows);
      estimate.SetB(problem);
      EXPECT_NEAR(estimate.Rho(f, w), m.rho, 1e-12 * (1 + m.rho));
      EXPECT_NEAR(estimate.BackwardError(f, w), m.backward_error, 1e-12);
    }
  }
}

TEST(Verify, RoundingIsNotDividedByAScaleThatCancels) {
  // Row 1 is perpendicular to row 0 up to rounding of 0.1 and 0.3; b_1 = 0, so |A||f| + |b| is 0 or rounding there.
  const Eigen::MatrixXd J = (Eigen::MatrixXd(2, 3) << 0.1, 0.3, 0, 0.3, -0.1, 0).finished();
  const double d = 0.1 * 0.1 + 0.3 * 0.3;
  const LcpProblem problem = LcpProblem::FromFactors("perpendicular", J.sparseView(), Eigen::Vector3d(1, 1, 1),
                                                     Eigen::Vector2d(-1.0 / 3.0, 0));
  const Verdict verdict = Verify(problem, Claim(Eigen::Vector2d(1.0 / 3.0 / d, 0)), 1e-9);
  EXPECT_TRUE(verdict.passes) << verdict.reason;
}

// A body between two walls: w_0 = f_0 - f_1 + b_0, w_1 = -f_0 + f_1 + b_1.
LcpProblem Opposed(const Eigen::Vector2d& b, const std::vector<Index>& bilateral = {}) {
  const Eigen::MatrixXd A = (Eigen::MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  return LcpProblem::FromDense("opposed", A, b, RowBounds::WithBilateralRows(2, bilateral), SymmetricPsd());
}

TEST(FarkasRay, AnExactRayIsAccepted) {
  // y = (1, 1) has A y = 0, b.y = -2.
  const LcpProblem problem = Opposed({-1, -1});
  const FarkasVerdict verdict = VerifyFarkasRay(problem, Eigen::Vector2d(1, 1));
  EXPECT_TRUE(verdict.accepted && verdict.proved) << verdict.reason;
  EXPECT_EQ(verdict.b_dot_y, -2);
  EXPECT_EQ(verdict.force_min, std::numeric_limits<double>::infinity());
}

// Two joints at an angle of 2^-exponent, with masses that turn no digit: f = (-2^2e, 2^2e) solves the problem.
LcpProblem Toggle(int exponent, double heavy, bool has_factors) {
  const double angle = std::ldexp(1.0, -exponent);
  const Eigen::MatrixXd J = (Eigen::MatrixXd(2, 2) << 1, 0, 1, angle).finished();
  const Eigen::Vector2d inverse_mass(1, heavy);
  RowBounds joints = RowBounds::WithBilateralRows(2, {0, 1});
  if (has_factors) return LcpProblem::FromFactors("t", J.sparseView(), inverse_mass, Eigen::Vector2d(0, -1), joints);
  return LcpProblem::FromDense("t", J * inverse_mass.asDiagonal() * J.transpose(), Eigen::Vector2d(0, -1), joints,
                               SymmetricPsd());
}

TEST(FarkasRay, FromFactorsAnAngleBetweenRowsIsNotSquared) {
  for (const int exponent : {10, 24, 26, 43, 60}) {
    for (const double inverse_mass : {1.0, 0x1p-20, 0x1p20}) {
      const FarkasVerdict verdict = VerifyFarkasRay(Toggle(exponent, inverse_mass, true), Eigen::Vector2d(-1, 1));
      EXPECT_FALSE(verdict.accepted || verdict.proved) << exponent;
      EXPECT_NE(verdict.reason.find("J^T y = 0 holds to 1 of"), std::string::npos) << verdict.reason;
    }
  }
}

TEST(FarkasRay, AMatrixThatIsRoundedTellsNoMoreThanWithinRounding) {
  const FarkasVerdict near = VerifyFarkasRay(Toggle(24, 1, false), Eigen::Vector2d(-1, 1));
  EXPECT_TRUE(near.accepted && !near.proved) << near.reason;
  EXPECT_NEAR(near.force_min, 0x1p48, 0x1p30);  // as the solution of J has it
  // From an angle of 2^-27 on A is singular as it is given, and there is no solution of that.
  EXPECT_TRUE(VerifyFarkasRay(Toggle(27, 1, false), Eigen::Vector2d(-1, 1)).proved);
  EXPECT_FALSE(VerifyFarkasRay(Toggle(20, 1, false), Eigen::Vector2d(-1, 1)).accepted);
}

TEST(FarkasRay, WhatRoundingHidesIsNotProved) {
  // Terms of y and b cancel but for a last digit, or the smallest number there is.
  const Eigen::MatrixXd J = (Eigen::MatrixXd(2, 1) << 0.1, -0.3).finished();
  const LcpProblem problem =
      LcpProblem::FromFactors("thirds", J.sparseView(), VectorXd::Ones(1), Eigen::Vector2d(-1, -1));
  const FarkasVerdict near = VerifyFarkasRay(problem, Eigen::Vector2d(3, 1));  // 3 * 0.1 is not 0.3 in doubles
  EXPECT_TRUE(near.accepted && !near.proved) << near.reason;
  EXPECT_GT(near.null_residual, 0);
  EXPECT_TRUE(VerifyFarkasRay(problem, Eigen::Vector2d(0.3, 0.1)).proved);
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const double last : {0.0, tiny, -tiny}) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3);
    const LcpProblem zero =
        LcpProblem::FromDense("zero", A, Eigen::Vector3d(1e300, -1e300, last), RowBounds(), SymmetricPsd());
    EXPECT_EQ(VerifyFarkasRay(zero, Eigen::Vector3d(1e300, 1e300, tiny)).proved, last < 0) << last;
  }
}

// Large terms that cancel, and whole numbers at any scale, whose sum is known.
TEST(ExactSum, IsZeroOnlyWhereTheSumIs) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> exponent(-1000, 900);
  std::uniform_int_distribution<int> integer(-1000000, 1000000);
  ExactSum sum;
  for (int trial = 0; trial < 2000; ++trial) {
    sum.Clear();
    std::vector<std::pair<double, double>> terms;
    const int unit = exponent(random);
    std::int64_t total = 0;
    for (int k = 0; k < 5; ++k) {
      const int a = integer(random), b = integer(random);
      total += std::int64_t{a} * b;
      terms.emplace_back(std::ldexp(a, unit), std::ldexp(b, -unit / 2));
      const double large = std::ldexp(1 + std::ldexp(integer(random), -30), exponent(random));
      terms.emplace_back(large, 1 / 3.0);
      terms.emplace_back(-large, 1 / 3.0);
    }
    std::shuffle(terms.begin(), terms.end(), random);
    for (const auto& [x, y] : terms) sum.Add(x, y);
    EXPECT_EQ(sum.Value(), std::ldexp(static_cast<long double>(total), unit - unit / 2)) << trial;
  }
}

TEST(FarkasRay, ASmallAyIsNotAProof) {
  // f = (0, 1e10) solves this problem, although y = (0, 1) has |A y| = 1e-10.
  const LcpProblem problem = Diagonal({1, 1e-10}, {1, -1});
  const FarkasVerdict verdict = VerifyFarkasRay(problem, Eigen::Vector2d(0, 1));
  EXPECT_FALSE(verdict.accepted);
  EXPECT_TRUE(Verify(problem, Claim(Eigen::Vector2d(0, 1e10)), 1e-9).passes);
}

// A column of light and heavy bodies in turns is solvable, by forces whose sum is 6 10^12 |b| and more. Along the
// forces y under which body k falls with k + 1 times a unit A y is constant, and so small that F_min alone would take y
// for a proof.
TEST(FarkasRay, AForceThatIsOnlyLargeIsNotAProof) {
  for (const auto& [n, ratio] : {std::pair<Index, double>{8000, 1e6}, {500, 1e8}, {2000, 1e8}}) {
    const StackedColumn column = MakeStackedColumn(n, ratio);
    VectorXd y(n);
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
  const LcpProblem problem = Opposed({-1, -1});
  EXPECT_FALSE(VerifyFarkasRay(problem, Eigen::Vector2d(-1, -1)).accepted);
  EXPECT_FALSE(VerifyFarkasRay(problem, Eigen::Vector2d(1, kNotANumber)).accepted);
  EXPECT_FALSE(VerifyFarkasRay(problem, VectorXd::Ones(3)).accepted);
  EXPECT_FALSE(VerifyFarkasRay(Opposed({-1, 1}), Eigen::Vector2d(1, 1)).accepted);  // b.y = 0
  // On bilateral rows y is free.
  EXPECT_TRUE(VerifyFarkasRay(Opposed({1, 1}, {0, 1}), Eigen::Vector2d(-1, -1)).accepted);
}

// ----- rounding floors

// Seeded problems by factors, some rows bilateral, magnitudes over six decades, some forces 0.
struct Case {
  LcpProblem problem;
  VectorXd f;
};

VectorXd OverSixDecades(Index n, unsigned seed) {
  return RandomVector(n, -1, 1, seed).array() * (RandomVector(n, -3, 3, seed + 1).array() * std::log(10.0)).exp();
}

Case RandomCase(unsigned seed) {
  const int n = 1 + static_cast<int>(seed % 9), bodies = 1 + static_cast<int>(seed % 4);
  const LcpProblem planted = PlantedProblem(n, bodies, seed, static_cast<int>(seed % 5), 0).problem;
  const VectorXd mass = OverSixDecades(3 * bodies, seed + 1000).cwiseAbs(), b = OverSixDecades(n, seed + 2000);
  const VectorXd zeros = RandomVector(n, 0, 3, seed).array().floor().cwiseMin(1);
  return {LcpProblem::FromFactors("factors", planted.J(), mass, b, planted.bounds()),
          zeros.cwiseProduct(OverSixDecades(n, seed + 3000))};
}

// The formula, written out.
double ByFormula(const Eigen::MatrixXd& magnitudes, const Eigen::MatrixXd& A, const VectorXd& b, const VectorXd& f) {
  long double change = 0;
  long double scale = 0;
  for (Index i = 0; i < b.size(); ++i) {
    long double sum = 0;
    for (Index j = 0; j < b.size(); ++j) sum += std::abs(static_cast<long double>(magnitudes(i, j)) * f[j]);
    const long double d = A(i, i) == 0 ? 1 : std::abs(A(i, i));
    change += sum * sum / d;
    scale += static_cast<long double>(b[i]) * b[i] / d;
  }
  return static_cast<double>(kUnitRoundoff * std::sqrt(scale == 0 ? change : change / scale));
}

TEST(RoundingFloor, FollowsItsFormulaInEveryForm) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto [problem, f] = RandomCase(seed);
    Eigen::MatrixXd A = problem.DenseA();
    const Eigen::MatrixXd J = Eigen::MatrixXd(problem.J()).cwiseAbs();
    const double by_factors = ByFormula(J * problem.inverse_mass().asDiagonal() * J.transpose(), A, problem.b(), f);
    EXPECT_NEAR(RoundingFloor(problem, f), by_factors, 1e-13 * by_factors) << seed;
    // The other forms need neither symmetry nor a positive diagonal.
    if (seed % 2 == 0) A(0, A.cols() - 1) += 1;
    if (seed % 3 == 0) A(0, 0) = -A(0, 0);
    if (seed % 5 == 0) A(A.rows() - 1, A.rows() - 1) = 0;
    const double by_entries = ByFormula(A, A, problem.b(), f);
    for (const LcpProblem& other :
         {LcpProblem::FromDense("d", A, problem.b()), LcpProblem::FromSparse("s", A.sparseView(), problem.b())}) {
      EXPECT_NEAR(RoundingFloor(other, f), by_entries, 1e-13 * by_entries) << seed;
    }
  }
}

TEST(RoundingFloor, IsIndependentOfUnitsAndRowScaling) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const auto [problem, f] = RandomCase(seed);
    const VectorXd rows = PowersOfTwo(f.size(), seed);
    // Squares of the last two leave the range of double.
    for (const int exponent : {-3, 40, 530, -530}) {
      const double load = std::ldexp(1.0, exponent);
      for (const double mass : {1.0, 0x1p21}) {
        const LcpProblem scaled = ScaleRows(problem, rows, mass).WithB(load * rows.cwiseProduct(problem.b()));
        const VectorXd scaled_f = load / mass * f.cwiseQuotient(rows);
        EXPECT_DOUBLE_EQ(RoundingFloor(scaled, scaled_f), RoundingFloor(problem, f)) << seed;
        EXPECT_DOUBLE_EQ(RoundingFloor(InForm(scaled, MatrixForm::kDense), scaled_f),
                         RoundingFloor(InForm(problem, MatrixForm::kDense), f))
            << seed;
      }
    }
  }
}

TEST(RoundingFloor, BoundsWhatRelativeChangesOfForcesDoToRho) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    const Case c = RandomCase(seed);
    for (const LcpProblem& problem : {c.problem, InForm(c.problem, MatrixForm::kDense)}) {
      for (const double size : {1e-2, 1e-5, 1e-8}) {
        const VectorXd change = size * RandomVector(c.f.size(), -1, 1, seed);
        const double before = ComputeMetrics(problem, c.f).rho;
        const double after = ComputeMetrics(problem, c.f + c.f.cwiseProduct(change)).rho;
        const double bound = size / kUnitRoundoff * RoundingFloor(problem, c.f);
        EXPECT_LE(std::abs(after - before), bound * (1 + 1e-6) + 1e-14 * before) << seed;
      }
    }
  }
}

TEST(RoundingFloor, GrowsWithTheMassRatioOfAColumnAndTheRoundedExactAnswerIsBelowIt) {
  double previous = 0;
  for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
    const StackedColumn column = MakeStackedColumn(1000, ratio);
    VectorXd f(1000);
    for (Index i = 0; i < 1000; ++i) f[i] = static_cast<double>(column.f[static_cast<size_t>(i)]);
    const double floor = RoundingFloor(column.problem, f);
    EXPECT_GT(floor, 20 * previous);
    previous = floor;
    // No answer in double comes much nearer than the exact one, rounded; the bound is no empty one.
    const double rho = ComputeMetrics(column.problem, f).rho;
    EXPECT_LE(rho, 1.01 * floor) << ratio;
    EXPECT_GE(rho, 0.05 * floor) << ratio;
  }
  EXPECT_GT(previous, 1e-9);
}

TEST(RoundingFloor, AnswersThatAreNoneHaveAnInfiniteFloor) {
  const LcpProblem problem = LcpProblem::FromDense("d", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, 0));
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d(1, kNotANumber)), kInfinite);
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d(1, kInfinite)), kInfinite);
  EXPECT_EQ(RoundingFloor(problem, VectorXd::Ones(3)), kInfinite);
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d::Zero()), 0);
  EXPECT_EQ(RoundingFloor(LcpProblem::FromDense("0", Eigen::MatrixXd(0, 0), VectorXd(0)), VectorXd(0)), 0);
  // Absolute where b = 0, as rho is.
  const LcpProblem homogeneous = LcpProblem::FromDense("h", 4 * Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero());
  EXPECT_DOUBLE_EQ(RoundingFloor(homogeneous, Eigen::Vector2d(3, 4)), 10 * kUnitRoundoff);
}

// --- verdicts relative to a floor

LcpReference WithFloor(double floor) {
  LcpReference reference;
  reference.floor = floor;
  return reference;
}

void ExpectTheSame(const Verdict& verdict, const Verdict& strict) {
  EXPECT_EQ(verdict.passes, strict.passes);
  EXPECT_EQ(verdict.best_tier, strict.best_tier);
  EXPECT_EQ(verdict.false_success, strict.false_success);
  EXPECT_EQ(verdict.reason, strict.reason);
  EXPECT_FALSE(verdict.at_floor);
}

// w = f - 1: rho is |f - 1| for f near 1.
LcpProblem One() { return LcpProblem::FromDense("one", Eigen::MatrixXd::Ones(1, 1), -VectorXd::Ones(1)); }
LcpResult Off(double error) { return Claim(VectorXd::Constant(1, 1 - error)); }

TEST(Verify, ATierIsMetUpToItAndNotBeyond) {
  const LcpProblem hidden = Diagonal({1, 1}, {-1, 1e12});  // only the backward error of row 0 says anything
  for (const double tier : kTiers) {
    for (const double times : {0.999, 1.001}) {
      EXPECT_EQ(Verify(One(), Off(times * tier), tier).passes, times < 1) << tier;
      const double backward = times * std::sqrt(tier);
      const Eigen::Vector2d f(1 - 2 * backward / (1 + backward), 0);
      EXPECT_EQ(Verify(hidden, Claim(f), tier).passes, times < 1) << tier;
    }
  }
  // What rounding explains is finer than doubles are.
  EXPECT_NEAR(ComputeMetrics(One(), VectorXd::Constant(1, 1 - 0x1p-50)).backward_error, 0x1p-51, 0x1p-60);
}

TEST(VerdictAtTheFloor, PassesUpToTheFloorAndSaysSo) {
  const LcpReference reference = WithFloor(1e-7);
  const Verdict at_floor = Verify(One(), Off(0.5e-7), 1e-9, &reference);
  EXPECT_TRUE(at_floor.passes && at_floor.at_floor && !at_floor.false_success);
  EXPECT_EQ(at_floor.best_tier, 1e-9);
  EXPECT_EQ(at_floor.reason, "");
  EXPECT_EQ(at_floor.metrics.floor, 1e-7);

  const Verdict above = Verify(One(), Off(2e-7), 1e-9, &reference);
  EXPECT_TRUE(!above.passes && !above.at_floor && above.false_success);
  EXPECT_EQ(above.best_tier, 1e-6);
  EXPECT_NE(above.reason.find("> 1e-07 (rounding floor)"), std::string::npos) << above.reason;

  EXPECT_FALSE(Verify(One(), Off(0.5e-7), 1e-9).passes);
  // What meets the tier anyway does not lean on the floor.
  EXPECT_FALSE(Verify(One(), Off(0.5e-9), 1e-9, &reference).at_floor);
}

// A floor below the tier, or one that is no number >= 0, changes nothing.
TEST(VerdictAtTheFloor, PassesExactlyWhatMeetsTheLargerOfTierAndFloor) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 500; ++k) {
    const LcpResult result = Off(std::pow(10, Uniform(&random, -13, -1)));
    for (const double tier : kTiers) {
      const Verdict strict = Verify(One(), result, tier);
      EXPECT_EQ(strict.metrics.floor, -1);
      const double any = std::pow(10, Uniform(&random, -12, -3));
      for (const double floor : {0.0, 1e-16, 0.99 * kTiers[0], kNotANumber, kInfinite, -1.0, -kInfinite, any}) {
        const LcpReference reference = WithFloor(floor);
        const Verdict verdict = Verify(One(), result, tier, &reference);
        if (floor == any) {
          EXPECT_EQ(verdict.passes, Verify(One(), result, std::max(tier, any)).passes);
          EXPECT_EQ(verdict.at_floor, verdict.passes && !strict.passes);
        } else {
          ExpectTheSame(verdict, strict);
        }
      }
    }
  }
}

TEST(VerdictAtTheFloor, NoFloorIsLargeEnoughForNothing) {
  for (const double floor : {1.0, 1e3, 1e300}) {
    const LcpReference reference = WithFloor(floor);
    for (const double off : {1.0, 2 * kLargestFloor, kLargestFloor / 2, kNotANumber, kInfinite}) {
      EXPECT_EQ(Verify(One(), Off(off), 1e-9, &reference).passes, off == kLargestFloor / 2) << off;
    }
  }
}

TEST(VerdictAtTheFloor, TheBackwardErrorIsJudgedByTheSameTier) {
  // Row 1 makes |b| large, so that rho is small; row 0 has the backward error e / (2 - e).
  const auto verdict = [](double e, double floor) {
    const LcpProblem problem = LcpProblem::FromDense("d", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, 1e9));
    const LcpReference reference = WithFloor(floor);
    return Verify(problem, Claim(Eigen::Vector2d(1 - e, 0)), 1e-9, &reference);
  };
  EXPECT_FALSE(verdict(1e-3, 1e-10).passes);
  EXPECT_TRUE(verdict(1e-3, 1e-6).passes);
  EXPECT_TRUE(verdict(1e-3, 1e-6).at_floor);
  EXPECT_FALSE(verdict(3e-3, 1e-6).passes);
  EXPECT_NE(verdict(3e-3, 1e-6).reason.find("backward error"), std::string::npos);
}

TEST(VerdictAtTheFloor, AHugeSelfStressDoesNotLoosenAVerdict) {
  // A body between two walls: f = (1, 0) + t (1, 1) for any t >= 0.
  const LcpProblem problem = Opposed({-1, 1});
  const LcpReference reference = WithFloor(RoundingFloor(problem, Eigen::Vector2d(1, 0)));
  int loosened = 0;
  for (double t = 1; t < 1e14; t *= 3) {
    const double ulp = std::nextafter(t, 2 * t) - t;
    for (const double error : {0.0, ulp, -ulp}) {
      const Eigen::Vector2d f(t + 1 + error, t);
      const Verdict strict = Verify(problem, Claim(f), 1e-9);
      const Verdict verdict = Verify(problem, Claim(f), 1e-9, &reference);
      ExpectTheSame(verdict, strict);
      EXPECT_DOUBLE_EQ(verdict.metrics.answer_floor, RoundingFloor(problem, f));
      // Its own floor would have let it pass.
      const LcpReference own = WithFloor(RoundingFloor(problem, f));
      loosened += Verify(problem, Claim(f), 1e-9, &own).passes && !strict.passes ? 1 : 0;
    }
  }
  EXPECT_GT(loosened, 10);
}

}  // namespace
}  // namespace lcpbench
