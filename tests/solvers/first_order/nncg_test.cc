#include "solvers/first_order/nncg.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr auto Iterate = [](const LcpProblem& problem, const NncgOptions& options, double tolerance, std::int64_t k) {
  return IterateNew<NncgSolver>(problem, options, tolerance, k);
};

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
        const LcpResult result = Iterate(problem, {NncgOptions::Direction::kOptimal, form, false}, 1e-15, steps);
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
    const LcpResult result = Iterate(problem, {}, 1e-6, 0);
    EXPECT_EQ(result.status, LcpStatus::kSolved);
    EXPECT_LE(result.iterations, 9 + 1) << problem.id();
  }
}

TEST(Nncg, EnergyNeverRises) {
  for (const RowForm form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    for (const bool coloured : {false, true}) {
      for (const TestProblem& test : GeneratedProblems()) {
        double energy = 0;
        for (const std::int64_t steps : {1, 2, 3, 4, 6, 9, 14}) {
          const LcpResult result =
              Iterate(test.problem, {NncgOptions::Direction::kOptimal, form, coloured}, 1e-12, steps);
          const double next = Energy(test.problem, result.f);
          EXPECT_LE(next, energy + 1e-9 * std::abs(energy)) << test.problem.id() << ", " << steps << " steps";
          energy = next;
        }
      }
    }
  }
}

TEST(Nncg, BothDirectionsAndOrdersAgreeInTheLimit) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const TestProblem test = PlantedProblem(30, 20, seed, seed % 2 == 0 ? 5 : 0, 0);
    for (const auto direction : {NncgOptions::Direction::kOptimal, NncgOptions::Direction::kFletcherReeves}) {
      for (const bool coloured : {false, true}) {
        const LcpResult result = Iterate(test.problem, {direction, RowForm::kAuto, coloured}, 1e-9, 0);
        EXPECT_EQ(result.status, LcpStatus::kSolved) << test.problem.id();
        EXPECT_TRUE(Verify(test.problem, result, 1e-9, &test.reference).passes);
      }
    }
  }
}

// A column of 2000 bodies passes a load on by a body per sweep: 300 iterations do not settle it.
TEST(Nncg, WhereThereIsNoHopeItEndsEarlyButNotBeforeItsLeastIterations) {
  const LcpProblem problem = Column(2000, 1);
  for (const std::int64_t least : {0, 40, 90}) {
    NncgOptions options;
    options.end_when_hopeless = true;
    options.least_iterations = least;
    const LcpResult result = Iterate(problem, options, 1e-9, 300);
    EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
    EXPECT_GT(result.iterations, least);
    EXPECT_LT(result.iterations, 300);
  }
}

TEST(Nncg, UnknownOptionsAreRefused) {
  EXPECT_THROW(NncgOptions::FromSettings({{"direction", "steepest"}}), InputError);
  EXPECT_THROW(NncgOptions::FromSettings({{"sweep", "forward"}}), InputError);
  EXPECT_THROW(NncgOptions::FromSettings({{"least-iterations", "-1"}}), InputError);
  EXPECT_EQ(NncgOptions::FromSettings({{"least-iterations", "7"}}).least_iterations, 7);
  EXPECT_FALSE(NncgOptions::FromSettings({{"sweep", "symmetric"}}).coloured);
}

}  // namespace
}  // namespace lcpbench
