// What is particular to each of the first-order solvers; what they have in common is in first_order_test.cc.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "solvers/first_order/apgd.h"
#include "solvers/first_order/nncg.h"
#include "solvers/first_order/pgs.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "solvers/pivoting/dantzig.h"
#include "support/input_error.h"
#include "tests/solvers/first_order/first_order_runs.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

PgsOptions Forward(RowForm form) { return {.form = form, .sweep = SweepOrder::kForward}; }

TEST(Pgs, RowWithoutDiagonalKeepsZeroForce) {
  SparseMatrix J(2, 3);
  J.insert(0, 0) = 1.0;
  J.insert(1, 1) = 1.0;  // on a fixed direction: A has a zero row
  const VectorXd inverse_mass = Eigen::Vector3d(1, 0, 1);
  const VectorXd start = Eigen::Vector2d(0, 5);
  for (const auto form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    PgsSolver solver(Forward(form));
    const LcpProblem solvable = LcpProblem::FromFactors("zero-row", J, inverse_mass, Eigen::Vector2d(-1, 2));
    const LcpResult solved = Iterate(&solver, solvable, 1e-9, 0, &start);
    EXPECT_EQ(solved.status, LcpStatus::kSolved);
    EXPECT_EQ(solved.f, VectorXd(Eigen::Vector2d(1, 0)));
    const LcpProblem infeasible = LcpProblem::FromFactors("zero-row-open", J, inverse_mass, Eigen::Vector2d(-1, -2));
    const LcpResult open = Iterate(&solver, infeasible, 1e-9, 50, &start);
    EXPECT_EQ(open.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(open.f[1], 0);
  }
}

TEST(Pgs, ReturnsTheBestIterateWhenItDiverges) {
  // Strongly nonsymmetric: Gauss-Seidel multiplies the error in every sweep.
  MatrixXd A(2, 2);
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
  const LcpResult relaxed =
      IterateNew<PgsSolver>(chain, {.relaxation = PgsOptions::kFirstOfAdaptive, .adaptive = true}, 1e-9, 0);
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
      VectorXd f(form.size());
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

// k steps of linear conjugate gradients on A x = -b, preconditioned by one symmetric Gauss-Seidel sweep in the order of
// the rows: M = (D + L) D^-1 (D + L^T), the textbook recurrence.
VectorXd LinearConjugateGradients(const MatrixXd& A, const VectorXd& b, int steps) {
  const MatrixXd lower = A.triangularView<Eigen::Lower>();
  const auto precondition = [&](const VectorXd& r) -> VectorXd {
    const VectorXd y = lower.triangularView<Eigen::Lower>().solve(r);
    return lower.transpose().triangularView<Eigen::Upper>().solve(A.diagonal().cwiseProduct(y));
  };
  VectorXd x = VectorXd::Zero(b.size());
  VectorXd r = -b;
  VectorXd z = precondition(r);
  VectorXd p = z;
  for (int k = 0; k < steps; ++k) {
    const VectorXd Ap = A * p;
    const double rz = r.dot(z);
    const double alpha = rz / p.dot(Ap);
    x += alpha * p;
    r -= alpha * Ap;
    z = precondition(r);
    p = z + r.dot(z) / rz * p;
  }
  return x;
}

TEST(Nncg, IsLinearConjugateGradientsWhereEveryRowIsBilateral) {
  for (const RowForm form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    int compared = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
      const LcpProblem problem = PlantedProblem(14, 10, seed, 1, 0).problem;
      for (const int steps : {1, 2, 3, 5, 7}) {
        const LcpResult result =
            IterateNew<NncgSolver>(problem, {NncgOptions::Direction::kOptimal, form, false}, 1e-15, steps);
        // The start is returned where its residual is less than that of the last iterate.
        if (result.iterations < steps || result.f.isZero(0)) continue;
        ++compared;
        const VectorXd expected = LinearConjugateGradients(problem.DenseA(), problem.b(), steps);
        EXPECT_LE((result.f - expected).norm(), 1e-7 * expected.norm()) << problem.id() << ", " << steps << " steps";
      }
    }
    EXPECT_GE(compared, 30);
  }
}

// A column of 2000 bodies passes a load on by a body per sweep: 300 iterations do not settle it.
TEST(Nncg, WhereThereIsNoHopeItEndsEarlyButNotBeforeItsLeastIterations) {
  const LcpProblem problem = Column(2000, 1);
  for (const std::int64_t least : {0, 40, 90}) {
    const LcpResult result =
        IterateNew<NncgSolver>(problem, {.end_when_hopeless = true, .least_iterations = least}, 1e-9, 300);
    EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
    EXPECT_GT(result.iterations, least);
    EXPECT_LT(result.iterations, 300);
  }
}

// Iterates that overflowed must not be seen by the next solve with the same object.
TEST(Nncg, SolvesAfterAnOverflowAsAfresh) {
  const MatrixXd A = (MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  NncgSolver solver;
  const auto solve = [&](double size) {
    return Iterate(&solver, LcpProblem::FromDense("jam", A, Eigen::Vector2d(-1, size)), 1e-9, 0);
  };
  const VectorXd fresh = solve(2).f;
  solve(-1);
  EXPECT_EQ(solve(2).f, fresh);
}

TEST(Apgd, EnergyFallsWithTheSquareOfTheIterations) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const LcpProblem problem = PlantedProblem(24, 5, seed, seed % 2 == 0 ? 6 : 0, 3).problem;
    DantzigSolver exact;
    const LcpResult solution = SolveWith(&exact, problem);
    ASSERT_EQ(solution.status, LcpStatus::kSolved);
    // In the Jacobi-scaled variables: step sizes are bounded through the largest eigenvalue there.
    const VectorXd root = problem.DiagonalA().cwiseSqrt();
    const MatrixXd scaled = root.cwiseInverse().asDiagonal() * problem.DenseA() * root.cwiseInverse().asDiagonal();
    const double largest = Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled).eigenvalues().maxCoeff();
    const double distance = root.cwiseProduct(solution.f).squaredNorm();
    const double least = Energy(problem, solution.f);
    for (const std::int64_t k : {1, 2, 4, 8, 16, 31}) {
      const LcpResult result = IterateNew<ApgdSolver>(problem, {.restart = false}, 1e-15, k);
      // The start is returned where its residual is less than that of the last iterate.
      if (result.iterations < k || result.f.isZero(0)) continue;
      ++compared;
      const double bound = 2 * ApgdOptions::kGrowth * largest * distance / static_cast<double>(k * k);
      EXPECT_LE(Energy(problem, result.f) - least, bound) << problem.id() << ", " << k << " iterations";
    }
  }
  EXPECT_GE(compared, 40);
}

TEST(Apgd, RestartPaysOnAChain) {
  const TestProblem chain = GeneratedProblems().back();
  const LcpResult with_restart = IterateNew<ApgdSolver>(chain.problem, {}, 1e-9, 0);
  const LcpResult without_restart = IterateNew<ApgdSolver>(chain.problem, {.restart = false}, 1e-9, 0);
  EXPECT_EQ(with_restart.status, LcpStatus::kSolved);
  EXPECT_LT(2 * with_restart.iterations, without_restart.iterations);
}

}  // namespace
}  // namespace lcpbench
