#include "solvers/first_order/nncg.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

TEST(Nncg, EndsInAsManyIterationsAsRowsWhereEveryRowIsBilateral) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const LcpProblem problem = PlantedProblem(9, 10, seed, 1, 0).problem;
    const LcpResult result = IterateNew<NncgSolver>(problem, {}, 1e-6, 0);
    EXPECT_EQ(result.status, LcpStatus::kSolved);
    EXPECT_LE(result.iterations, 9 + 1) << problem.id();
  }
}

// A column of 2000 bodies passes a load on by a body per sweep: 300 iterations do not settle it.
TEST(Nncg, WhereThereIsNoHopeItEndsEarlyButNotBeforeItsLeastIterations) {
  const LcpProblem problem = Column(2000, 1);
  for (const std::int64_t least : {0, 40, 90}) {
    NncgOptions options;
    options.end_when_hopeless = true;
    options.least_iterations = least;
    const LcpResult result = IterateNew<NncgSolver>(problem, options, 1e-9, 300);
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

}  // namespace
}  // namespace lcpbench
