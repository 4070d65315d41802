// Derivatives of solutions against exact ones, and their laws: docs/solvers/derivative.md.
#include "solvers/derivative/derivative.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <random>
#include <string>

#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/derivative/derivative_cases.h"
#include "tests/solvers/friction/friction_suite.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

double RelativeError(const Eigen::VectorXd& found, const Eigen::VectorXd& exact) {
  const double size = exact.lpNorm<Eigen::Infinity>();
  const double error = (found - exact).lpNorm<Eigen::Infinity>();
  return size > 0 ? error / size : error;
}

Eigen::VectorXd Weights(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  return UniformVector(&random, n, -1, 1);
}

// The gradient along a direction.
double Along(const ProblemGradient& gradient, const LcpProblem& problem, const ProblemChange& change) {
  double sum = 0;
  if (change.A) sum += gradient.A().cwiseProduct(Eigen::MatrixXd(*change.A)).sum();
  if (change.J) {
    sum += gradient.J(problem).cwiseProduct(Eigen::MatrixXd(*change.J)).sum();
  }
  if (change.inverse_mass) sum += gradient.InverseMass(problem).dot(*change.inverse_mass);
  if (change.b) sum += gradient.b.dot(*change.b);
  if (change.mu) sum += gradient.mu.dot(*change.mu);
  return sum;
}

// |vjp(u).d - u.(df, dw)| (without df where that is empty) over the sizes of the right side's terms.
double AdjointError(const Derivative& derivative, const LcpProblem& problem, const ProblemChange& change,
                    const Eigen::VectorXd& df, const Eigen::VectorXd& dw, unsigned seed) {
  const Eigen::VectorXd f_bar = Weights(df.size(), seed), w_bar = Weights(problem.size(), seed + 1);
  const double found = Along(derivative.Vjp(f_bar, w_bar), problem, change);
  const double terms = f_bar.cwiseAbs().dot(df.cwiseAbs()) + w_bar.cwiseAbs().dot(dw.cwiseAbs());
  const double error = std::abs(found - f_bar.dot(df) - w_bar.dot(dw));
  return terms > 0 ? error / terms : error;
}

struct Tally {
  int problems = 0, branches = 0, without = 0;
  double jvp = 0, vjp = 0;
};

void Compare(const DerivativeCase& test, unsigned seed, std::map<std::string, Tally>* tallies) {
  SCOPED_TRACE(test.problem.id());
  const Derivative derivative(test.problem, test.f);
  Tally& tally = (*tallies)[test.kind];
  const SolutionChange found = derivative.Jvp(test.change);
  const std::vector<ExactChange> exact = ExactChanges(test);
  const bool is_degenerate = test.kind.find("degenerate") != std::string::npos;
  EXPECT_EQ(derivative.strictly_complementary(), !is_degenerate);
  EXPECT_EQ(derivative.forces() == Derivative::Forces::kUnique, test.kind.find("not unique") == std::string::npos);
  if (exact.empty()) {
    EXPECT_NE(found.status, LcpStatus::kSolved);
    ++tally.without;
    return;
  }
  ++tally.problems;
  tally.branches += exact.size() > 1 ? 1 : 0;
  ASSERT_EQ(found.status, LcpStatus::kSolved) << found.detail;
  double least = std::numeric_limits<double>::infinity();
  for (const ExactChange& change : exact) {
    const double of_f = change.f.size() == 0 ? 0 : RelativeError(found.f, change.f);
    least = std::min(least, std::max(of_f, RelativeError(found.w, change.w)));
  }
  EXPECT_LE(least, 1e-9);
  tally.jvp = std::max(tally.jvp, least);

  // Vjp is exact where the point is strict, and along directions of its mode where it is degenerate.
  DerivativeCase opening = test;
  if (is_degenerate) *opening.change.b += 1000 * test.opening_b;
  std::vector<ExactChange> opened = is_degenerate ? ExactChanges(opening) : exact;
  double error = std::numeric_limits<double>::infinity();
  for (const ExactChange& change : opened) {
    error = std::min(error, AdjointError(derivative, test.problem, opening.change, change.f, change.w, seed));
  }
  EXPECT_LE(error, 1e-9);
  tally.vjp = std::max(tally.vjp, error);
}

TEST(Derivative, EqualsExactOneSidedDerivatives) {
  std::map<std::string, Tally> tallies;
  for (unsigned seed = 0; seed < 300; ++seed) Compare(PlainCase(seed), seed, &tallies);
  for (unsigned seed = 0; seed < 280; ++seed) Compare(FrictionCase(seed, seed % 2 == 1), seed, &tallies);
  for (unsigned seed = 0; seed < 60; ++seed) Compare(CopiedFrictionCase(seed), seed, &tallies);
  int problems = 0;
  std::cout << "| problems | compared | several branches | without | jvp | vjp |\n";
  for (const auto& [kind, tally] : tallies) {
    problems += tally.problems;
    std::cout << "| " << kind << " | " << tally.problems << " | " << tally.branches << " | " << tally.without << " | "
              << tally.jvp << " | " << tally.vjp << " |\n";
  }
  EXPECT_GE(problems, 500);
}

// dA = dJ M^-1 J^T + J dM^-1 J^T + J M^-1 dJ^T of the same problem given by A.
TEST(Derivative, TurnsJAndMassesAsItTurnsA) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const DerivativeCase test = seed % 2 == 0 ? PlainCase(seed / 2) : FrictionCase(seed, false);
    const Eigen::MatrixXd J = test.problem.J(), dJ = *test.change.J;
    const auto masses = test.problem.inverse_mass().asDiagonal();
    const Eigen::MatrixXd half = dJ * masses * J.transpose();
    const Eigen::MatrixXd dA = half + half.transpose() + J * test.change.inverse_mass->asDiagonal() * J.transpose();
    ProblemChange change = test.change;
    change.J.reset();
    change.inverse_mass.reset();
    change.A = dA.sparseView();
    const Derivative of_factors(test.problem, test.f), of_A(InForm(test.problem, MatrixForm::kDense), test.f);
    EXPECT_EQ(of_factors.forces(), of_A.forces());
    const SolutionChange one = of_factors.Jvp(test.change), other = of_A.Jvp(change);
    ASSERT_EQ(one.status, LcpStatus::kSolved) << one.detail;
    EXPECT_LE(RelativeError(other.f, one.f), 1e-10);
    EXPECT_LE(RelativeError(other.w, one.w), 1e-10);
    if (of_A.strictly_complementary()) {
      EXPECT_LE(AdjointError(of_A, test.problem, change, one.f, one.w, seed), 1e-10);
    }
  }
}

// J -> S J, b -> S b: f -> S^-1 f, w -> S w, mu -> mu s_n / s_t, and so do their derivatives; S of powers of two.
TEST(Derivative, FollowsUnitsOfRows) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const DerivativeCase test = seed % 2 == 0 ? PlainCase(seed / 2) : FrictionCase(seed, seed % 4 == 1);
    std::mt19937 random(seed);
    Eigen::VectorXd scale(test.problem.size());
    for (double& value : scale) value = std::ldexp(1, static_cast<int>(random() % 13) - 6);
    const LcpProblem scaled = ScaleRows(test.problem, scale, 1);
    ProblemChange change = test.change;
    for (size_t k = 0; k < scaled.friction_rows().size(); ++k) {
      const FrictionRow& row = scaled.friction_rows()[k];
      (*change.mu)[static_cast<Index>(k)] *= scale[row.normal] / scale[row.row];
    }
    change.J = scale.asDiagonal() * *test.change.J;
    change.b = scale.cwiseProduct(*test.change.b);
    const Derivative one(test.problem, test.f), other(scaled, test.f.cwiseQuotient(scale));
    EXPECT_EQ(one.degenerate(), other.degenerate());
    const SolutionChange of_one = one.Jvp(test.change), of_other = other.Jvp(change);
    ASSERT_EQ(of_one.status, of_other.status);
    if (of_one.status != LcpStatus::kSolved) continue;
    if (one.forces() == Derivative::Forces::kUnique) {  // the norm is that of forces in their units
      EXPECT_LE(RelativeError(scale.cwiseProduct(of_other.f), of_one.f), 1e-9);
    }
    EXPECT_LE(RelativeError(of_other.w.cwiseQuotient(scale), of_one.w), 1e-9);
  }
}

// Time steps with many redundant contacts, along changes of velocities, masses and mu: vjp is the transpose of jvp.
TEST(Derivative, IsItsOwnAdjointOnSteps) {
  int strict = 0, unique = 0;
  unsigned seed = 0;
  for (const LcpProblem& problem : StructuredFrictionProblems(1, 60)) {
    SCOPED_TRACE(problem.id());
    const Derivative derivative(problem, SolveBy("auto", problem, 1e-12).f);
    if (!derivative.strictly_complementary()) continue;
    ++strict;
    unique += derivative.forces() == Derivative::Forces::kUnique ? 1 : 0;
    ProblemChange change;
    change.b = problem.J() * Weights(problem.J().cols(), ++seed);
    change.inverse_mass = problem.inverse_mass().cwiseProduct(Weights(problem.J().cols(), ++seed));
    change.mu = Weights(static_cast<Index>(problem.friction_rows().size()), ++seed);
    const SolutionChange found = derivative.Jvp(change);
    ASSERT_EQ(found.status, LcpStatus::kSolved) << found.detail;
    EXPECT_LE(AdjointError(derivative, problem, change, found.f, found.w, ++seed), 1e-8);
  }
  EXPECT_GE(strict, 60);
  EXPECT_GE(unique, 20);
}

// Above 128 unknowns the factor is sparse: f is linear in b near a strict point.
TEST(Derivative, OfLargeProblemsEqualsDifferences) {
  for (const LcpProblem& problem : {Column(400, 3), DiscPile(600, 5)}) {
    SCOPED_TRACE(problem.id());
    const Derivative derivative(problem, SolveBy("auto", problem, 1e-12).f);
    ProblemChange change;
    change.b = problem.J() * Weights(problem.J().cols(), 7);
    const SolutionChange found = derivative.Jvp(change);
    ASSERT_EQ(found.status, LcpStatus::kSolved) << found.detail;
    constexpr double kStep = 1e-6;
    const LcpProblem later = problem.WithB(problem.b() + kStep * *change.b);
    const Derivative then(later, SolveBy("auto", later, 1e-12).f);
    EXPECT_LE(RelativeError((then.w() - derivative.w()) / kStep, found.w), 1e-5);
    if (derivative.forces() == Derivative::Forces::kUnique) {
      EXPECT_LE(RelativeError((then.f() - derivative.f()) / kStep, found.f), 1e-5);
    }
  }
}

// Two equal contacts share a load of 2. Pulled apart, one carries all of it.
TEST(Derivative, ForcesOfEqualContactsMayJump) {
  const LcpProblem problem =
      LcpProblem::FromDense("equal", Eigen::MatrixXd::Ones(2, 2), Eigen::Vector2d(-2, -2), {}, SymmetricPsd());
  const Derivative derivative(problem, Eigen::Vector2d(0.5, 1.5));
  EXPECT_EQ(derivative.forces(), Derivative::Forces::kLeastNorm);
  EXPECT_TRUE(derivative.strictly_complementary());
  EXPECT_TRUE(derivative.f().isApprox(Eigen::Vector2d(1, 1)));
  ProblemChange change;
  change.b = Eigen::Vector2d(-1, -1);
  EXPECT_TRUE(derivative.Jvp(change).f.isApprox(Eigen::Vector2d(0.5, 0.5)));
  change.b = Eigen::Vector2d(0, 3);
  const SolutionChange found = derivative.Jvp(change);
  EXPECT_EQ(found.status, LcpStatus::kSolved) << found.detail;
  EXPECT_TRUE(found.f.hasNaN());
  EXPECT_TRUE(found.w.isApprox(Eigen::Vector2d(0, 3)));
  // Two joints that contradict each other.
  const LcpProblem joints = problem.WithBounds(RowBounds::WithBilateralRows(2, {0, 1}));
  EXPECT_EQ(Derivative(joints, Eigen::Vector2d(1, 1)).Jvp(change).status, LcpStatus::kInfeasible);
}

TEST(Derivative, RefusesWhatDoesNotFit) {
  const DerivativeCase test = FrictionCase(0, false);
  EXPECT_THROW(Derivative(test.problem, 2 * test.f), InputError);
  EXPECT_THROW(Derivative(test.problem, test.f.head(1)), InputError);
  EXPECT_THROW(Derivative(test.problem, test.f, {.rank_tolerance = 0}), InputError);
  const Derivative derivative(test.problem, test.f);
  ProblemChange change;
  change.b = Eigen::VectorXd::Zero(test.problem.size() + 1);
  EXPECT_THROW(derivative.Jvp(change), InputError);
  EXPECT_THROW(derivative.Vjp(*change.b, {}), InputError);
  change = {};
  change.inverse_mass = test.problem.inverse_mass();
  EXPECT_THROW(Derivative(InForm(test.problem, MatrixForm::kDense), test.f).Jvp(change), InputError);
}

}  // namespace
}  // namespace lcpbench
