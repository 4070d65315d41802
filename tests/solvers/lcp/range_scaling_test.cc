#include "solvers/lcp/range_scaling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "solvers/lcp/verify.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

struct Planted {
  LcpProblem problem;
  VectorXd f;  // a solution, exact
};

// J of small integers with any rank; all numbers are exact. J's rows times 2^+-`rows`, its columns times 2^+-`columns`
// and inverse masses by the square of that, b times 2^+-`load`.
Planted MakePlanted(unsigned seed, int rows, int columns, int load) {
  TestRandom random(seed);
  const Index n = random.Integer(1, 12);
  Eigen::MatrixXd J(n, random.Integer(1, 15));
  for (double& entry : J.reshaped()) entry = random.Integer(-3, 3);
  VectorXd f(n);
  VectorXd w(n);
  for (Index i = 0; i < n; ++i) {
    if (random.Chance(0.1)) J.row(i).setZero();
    const bool pushes = random.Chance(0.5) && !J.row(i).isZero();
    f[i] = pushes ? random.Integer(1, 9) : 0;
    w[i] = pushes ? 0 : random.Integer(0, 9);
  }
  const VectorXd b = w - J * (J.transpose() * f);
  const auto powers = [&](Index count, int largest) {
    return VectorXd(VectorXd::NullaryExpr(count, [&] { return std::exp2(random.Integer(-largest, largest)); }));
  };
  const VectorXd of_rows = powers(n, rows);
  const VectorXd of_columns = powers(J.cols(), columns);
  const double of_b = powers(1, load)[0];
  const Eigen::MatrixXd scaled = of_rows.asDiagonal() * J * of_columns.asDiagonal();
  return {LcpProblem::FromFactors("planted", scaled.sparseView(), of_columns.array().square().inverse(),
                                  of_b * of_rows.cwiseProduct(b)),
          of_b * f.cwiseQuotient(of_rows)};
}

// By J and inverse masses, by dense and by sparse A in turns.
LcpProblem InSomeForm(const LcpProblem& problem, unsigned seed) {
  if (seed % 3 == 0) return problem;
  return InForm(problem, seed % 3 == 1 ? MatrixForm::kDense : MatrixForm::kSparse);
}

TEST(RangeScaling, TakesAProblemInRangeAsItIs) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const LcpProblem problem = InSomeForm(MakePlanted(seed, 15, 15, 50).problem, seed);
    EXPECT_FALSE(problem.has_extreme_matrix());
    EXPECT_FALSE(problem.has_extreme_b());
    EXPECT_EQ(DifferenceOfProblems(RangeScaling(problem).matrix().WithB(problem.b()), problem), "");
  }
}

TEST(RangeScaling, BringsEveryFormIntoRangeAndTheAnswerBack) {
  int extreme = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Planted planted = MakePlanted(seed, 400, 100, 200);
    const LcpProblem given = InSomeForm(planted.problem, seed);
    extreme += given.has_extreme_matrix() ? 1 : 0;
    const RangeScaling scaling(given);
    EXPECT_FALSE(scaling.matrix().has_extreme_matrix());
    LcpResult result;
    scaling.SolveScaled(given, LcpOptions{.initial_f = &planted.f}, &result,
                        [&](const LcpProblem& scaled, const LcpOptions& options, LcpResult* found) {
                          const double largest = scaled.b().lpNorm<Eigen::Infinity>();
                          EXPECT_TRUE(largest == 0 || std::ilogb(largest) == 0) << largest;
                          for (Index i = 0; given.has_extreme_matrix() && i < scaled.size(); ++i) {
                            EXPECT_LT(scaled.DiagonalA()[i], 64);
                          }
                          ASSERT_NE(options.initial_f, nullptr);
                          found->f = *options.initial_f;
                          found->status = LcpStatus::kSolved;
                          EXPECT_TRUE(Verify(scaled, *found, 1e-9).passes) << seed;
                        });
    EXPECT_EQ(result.status, LcpStatus::kSolved) << seed << result.detail;
    EXPECT_TRUE(SameBits(result.f, planted.f)) << seed;
  }
  EXPECT_GT(extreme, 200);
}

LcpResult SolveAs(const LcpProblem& problem, LcpStatus status, const VectorXd& f, const VectorXd& ray = {}) {
  LcpResult result;
  RangeScaling(problem).SolveScaled(problem, LcpOptions{}, &result,
                                    [&](const LcpProblem&, const LcpOptions&, LcpResult* found) {
                                      found->status = status;
                                      found->f = f;
                                      if (ray.size() > 0) found->farkas_ray = ray;
                                    });
  return result;
}

TEST(RangeScaling, NoClaimStandsThatDoesNotHoldForTheGivenProblem) {
  const auto problem = [](double a, double b) {
    return LcpProblem::FromDense("p", Eigen::MatrixXd::Constant(1, 1, a), VectorXd::Constant(1, b));
  };
  const VectorXd one = VectorXd::Ones(1);
  const LcpProblem in_doubles = problem(0x1p800, -0x1p800);
  EXPECT_EQ(SolveAs(in_doubles, LcpStatus::kSolved, one).status, LcpStatus::kSolved);
  EXPECT_EQ(SolveAs(in_doubles, LcpStatus::kSolved, one).f, one);
  EXPECT_EQ(SolveAs(in_doubles, LcpStatus::kSolved, 1.01 * one).status, LcpStatus::kNumericalFailure);
  EXPECT_EQ(SolveAs(in_doubles, LcpStatus::kIterationLimit, one).status, LcpStatus::kIterationLimit);
  // f = 2^1600, and f = 2^-1600.
  const LcpResult beyond = SolveAs(problem(0x1p-800, -0x1p800), LcpStatus::kSolved, one);
  EXPECT_EQ(beyond.status, LcpStatus::kNumericalFailure);
  EXPECT_EQ(beyond.f, 0 * one);
  EXPECT_EQ(SolveAs(problem(0x1p800, -0x1p-800), LcpStatus::kSolved, one).status, LcpStatus::kNumericalFailure);
  // A ray has any length, but must be one.
  const LcpResult infeasible = SolveAs(problem(0, -0x1p-900), LcpStatus::kInfeasible, 0 * one, one);
  EXPECT_EQ(infeasible.status, LcpStatus::kInfeasible);
  EXPECT_EQ(infeasible.farkas_ray, one);
  const LcpResult feasible = SolveAs(in_doubles, LcpStatus::kInfeasible, 0 * one, one);
  EXPECT_EQ(feasible.status, LcpStatus::kNumericalFailure);
  EXPECT_FALSE(feasible.farkas_ray.has_value());
}

TEST(RangeScaling, AMatrixBeyondDoublesIsRefusedByItsRow) {
  SparseMatrix J(2, 1);
  J.insert(0, 0) = 1;
  J.insert(1, 0) = 1e200;
  const VectorXd b = VectorXd::Ones(2);
  EXPECT_TRUE(LcpProblem::FromFactors("p", J, VectorXd::Constant(1, 1e-100), b).has_extreme_matrix());
  ExpectRefused([&] { LcpProblem::FromFactors("p", J, VectorXd::Ones(1), b); }, "row 1 ");
}

}  // namespace
}  // namespace lcpbench
