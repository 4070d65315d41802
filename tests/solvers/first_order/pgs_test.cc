#include "solvers/first_order/pgs.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

PgsOptions Forward(RowForm form) { return {.form = form, .sweep = SweepOrder::kForward}; }

TEST(Pgs, RelaxationOutsideZeroToTwoIsRefused) {
  for (const double relaxation : {0.0, 2.0, -0.1, 2.5, std::nan("")}) {
    EXPECT_THROW(PgsSolver({.relaxation = relaxation}), InputError) << relaxation;
  }
  const PgsOptions read = PgsOptions::FromSettings({{"relaxation", "1.3"}, {"form", "matrix-free"}});
  EXPECT_EQ(read.relaxation, 1.3);
  EXPECT_EQ(read.form, RowForm::kMatrixFree);
  EXPECT_FALSE(read.adaptive);
  const PgsOptions psor = PgsOptions::AdaptiveFromSettings({{"sweep", "symmetric"}});
  EXPECT_EQ(psor.relaxation, PgsOptions::kFirstOfAdaptive);
  EXPECT_EQ(psor.sweep, SweepOrder::kSymmetric);
  EXPECT_TRUE(psor.adaptive);
}

TEST(Pgs, DiagonalProblemIsSolvedInOneSweepAndASecondThatFindsNothingToDo) {
  Eigen::MatrixXd A = Eigen::Vector3d(2, 1e-9, 3e9).asDiagonal();
  const LcpProblem problem =
      LcpProblem::FromDense("diagonal", A, Eigen::Vector3d(-4, 5, 6), RowBounds::WithBilateralRows(3, {2}));
  const LcpResult result = IterateNew<PgsSolver>(problem, {}, 1e-9, 0);
  EXPECT_EQ(result.status, LcpStatus::kSolved);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_DOUBLE_EQ(result.f[0], 2);
  EXPECT_EQ(result.f[1], 0);
  EXPECT_DOUBLE_EQ(result.f[2], -2e-9);
}

TEST(Pgs, RowWithoutDiagonalKeepsZeroForce) {
  SparseMatrix J(2, 3);
  J.insert(0, 0) = 1.0;
  J.insert(1, 1) = 1.0;  // on a fixed direction: A has a zero row
  const Eigen::VectorXd inverse_mass = Eigen::Vector3d(1, 0, 1);
  const Eigen::VectorXd start = Eigen::Vector2d(0, 5);
  for (const auto form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    PgsSolver solver(Forward(form));
    const LcpProblem solvable = LcpProblem::FromFactors("zero-row", J, inverse_mass, Eigen::Vector2d(-1, 2));
    const LcpResult solved = Iterate(&solver, solvable, 1e-9, 0, &start);
    EXPECT_EQ(solved.status, LcpStatus::kSolved);
    EXPECT_EQ(solved.f, Eigen::VectorXd(Eigen::Vector2d(1, 0)));
    const LcpProblem infeasible = LcpProblem::FromFactors("zero-row-open", J, inverse_mass, Eigen::Vector2d(-1, -2));
    const LcpResult open = Iterate(&solver, infeasible, 1e-9, 50, &start);
    EXPECT_EQ(open.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(open.f[1], 0);
  }
}

TEST(Pgs, ReturnsTheBestIterateWhenItDiverges) {
  // Strongly nonsymmetric: Gauss-Seidel multiplies the error in every sweep.
  Eigen::MatrixXd A(2, 2);
  A << 1, 10, -10, 1;
  const LcpProblem problem =
      LcpProblem::FromDense("rotation", A, Eigen::Vector2d(-1, -1), RowBounds::WithBilateralRows(2, {0, 1}));
  const LcpResult result = IterateNew<PgsSolver>(problem, Forward(RowForm::kAssembled), 1e-9, 40);
  EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
  EXPECT_LE(ComputeMetrics(problem, result.f).rho, 1.0);  // that of f = 0
  const LcpResult overflow = IterateNew<PgsSolver>(problem, Forward(RowForm::kAssembled), 1e-9, 0);
  EXPECT_EQ(overflow.status, LcpStatus::kNumericalFailure);
  EXPECT_TRUE(overflow.f.allFinite());
}

TEST(Psor, TakesAFifthOfTheSweepsOfGaussSeidelOnAChain) {
  const LcpProblem chain = PressedChain(60);
  const LcpResult plain = IterateNew<PgsSolver>(chain, {}, 1e-9, 0);
  const LcpResult relaxed = IterateNew<PgsSolver>(chain, PgsOptions::AdaptiveFromSettings({}), 1e-9, 0);
  EXPECT_EQ(plain.status, LcpStatus::kSolved);
  EXPECT_EQ(relaxed.status, LcpStatus::kSolved);
  EXPECT_LE(5 * relaxed.iterations, plain.iterations) << relaxed.iterations << " of " << plain.iterations;
}

TEST(GivenForm, TestAgreesWithTheVerdict) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  GivenFormTest given;
  for (const TestProblem& test : GeneratedProblems()) {
    const LcpProblem& problem = test.problem;
    for (const LcpProblem& form : {problem, LcpProblem::FromDense("dense", problem.DenseA(), problem.b()),
                                   LcpProblem::FromSparse("sparse", problem.SparseA(), problem.b())}) {
      given.Reset(form);
      Eigen::VectorXd f(form.size());
      for (double& value : f) value = std::pow(10.0, 3 * uniform(random)) * uniform(random);
      const Metrics metrics = ComputeMetrics(form, f);
      EXPECT_NEAR(static_cast<double>(given.Rho(f)), metrics.rho, 1e-12 * metrics.rho) << form.id();
      for (const double tolerance : {1e-9, 1e-3, 0.5, 0.999}) {
        EXPECT_EQ(given.Meets(tolerance, f), PassesTier(metrics, tolerance)) << form.id() << " at " << tolerance;
      }
      if (test.reference.f.has_value() && form.bilateral_rows().size() == problem.bilateral_rows().size()) {
        const Metrics solved = ComputeMetrics(form, *test.reference.f);
        for (const double tolerance : {1e-9, 1e-3}) {
          EXPECT_EQ(given.Meets(tolerance, *test.reference.f), PassesTier(solved, tolerance)) << problem.id();
        }
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench
