#include "solvers/first_order/pgs.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

PgsOptions With(PgsOptions::Form form, double relaxation = 1.0) {
  PgsOptions options;
  options.form = form;
  options.sweep = SweepOrder::kForward;
  options.relaxation = relaxation;
  return options;
}

LcpResult Sweep(PgsSolver* solver, const LcpProblem& problem, std::int64_t sweeps, const Eigen::VectorXd* start) {
  return Iterate(solver, problem, 1e-9, sweeps, start);
}

// Rows on three bodies each, so that the two-body path does not apply.
LcpProblem ThreeBodyProblem(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> entry(-3, 3);
  std::vector<Eigen::Triplet<double, int>> entries;
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 12; ++k) entries.emplace_back(i, k, entry(random));
  }
  SparseMatrix J(8, 12);
  J.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd b(8);
  for (double& value : b) value = entry(random);
  return LcpProblem::FromFactors("three-body", J, Eigen::VectorXd::LinSpaced(12, 0.5, 2.0), b);
}

TEST(Pgs, BothFormsGiveTheSameIteratesUpToRounding) {
  std::vector<LcpProblem> problems;
  for (const TestProblem& test : GeneratedProblems()) problems.push_back(test.problem);
  for (unsigned seed = 0; seed < 20; ++seed) problems.push_back(ThreeBodyProblem(seed));
  for (const double relaxation : {0.7, 1.0, 1.6}) {
    PgsSolver assembled(With(PgsOptions::Form::kAssembled, relaxation));
    PgsSolver matrix_free(With(PgsOptions::Form::kMatrixFree, relaxation));
    for (const LcpProblem& problem : problems) {
      if (!problem.has_factors()) continue;
      for (const std::int64_t sweeps : {1, 2, 7}) {
        const Eigen::VectorXd a = Sweep(&assembled, problem, sweeps, nullptr).f;
        const Eigen::VectorXd m = Sweep(&matrix_free, problem, sweeps, nullptr).f;
        // Forces compare in the scaled problem, where none has units.
        const Eigen::VectorXd root =
            problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1.0 : std::sqrt(d); });
        const double size = root.cwiseProduct(a).cwiseAbs().maxCoeff();
        EXPECT_LE(root.cwiseProduct(a - m).cwiseAbs().maxCoeff(), 1e-11 * size)
            << problem.id() << ", " << sweeps << " sweeps, omega " << relaxation;
      }
    }
  }
}

TEST(Pgs, EverySweepLowersTheEnergyForPositiveSemidefiniteA) {
  for (const double relaxation : {0.5, 1.0, 1.9}) {
    PgsSolver solver(With(PgsOptions::Form::kAuto, relaxation));
    for (const TestProblem& test : GeneratedProblems()) {
      if (!test.problem.facts().positive_semidefinite) continue;
      Eigen::VectorXd f = Eigen::VectorXd::Zero(test.problem.size());
      double energy = 0;
      double lowest = 0;
      for (int sweep = 0; sweep < 25; ++sweep) {
        f = Sweep(&solver, test.problem, 1, &f).f;
        const double next = Energy(test.problem, f);
        lowest = std::min(lowest, next);
        EXPECT_LE(next, energy + 1e-12 * std::abs(lowest)) << test.problem.id() << ", sweep " << sweep;
        energy = next;
      }
    }
  }
}

TEST(Pgs, RelaxationOutsideZeroToTwoIsRefused) {
  for (const double relaxation : {0.0, 2.0, -0.1, 2.5, std::nan("")}) {
    EXPECT_THROW(PgsSolver(With(PgsOptions::Form::kAuto, relaxation)), InputError) << relaxation;
  }
  for (const char* relaxation : {"0", "2", "-1", "nan", "fast"}) {
    EXPECT_THROW(PgsOptions::FromSettings({{"relaxation", relaxation}}), InputError) << relaxation;
  }
  EXPECT_THROW(PgsOptions::FromSettings({{"form", "dense"}}), InputError);
  EXPECT_EQ(PgsOptions::FromSettings({{"relaxation", "1.3"}, {"form", "matrix-free"}}).relaxation, 1.3);
}

TEST(Pgs, DiagonalProblemIsSolvedInOneSweepAndASecondThatFindsNothingToDo) {
  Eigen::MatrixXd A = Eigen::Vector3d(2, 1e-9, 3e9).asDiagonal();
  const LcpProblem problem =
      LcpProblem::FromDense("diagonal", A, Eigen::Vector3d(-4, 5, 6), RowBounds::WithBilateralRows(3, {2}));
  PgsSolver solver;
  const LcpResult result = Sweep(&solver, problem, 0, nullptr);
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
  for (const auto form : {PgsOptions::Form::kAssembled, PgsOptions::Form::kMatrixFree}) {
    PgsSolver solver(With(form));
    const LcpProblem solvable = LcpProblem::FromFactors("zero-row", J, inverse_mass, Eigen::Vector2d(-1, 2));
    const LcpResult solved = Sweep(&solver, solvable, 0, &start);
    EXPECT_EQ(solved.status, LcpStatus::kSolved);
    EXPECT_EQ(solved.f, Eigen::VectorXd(Eigen::Vector2d(1, 0)));
    const LcpProblem infeasible = LcpProblem::FromFactors("zero-row-open", J, inverse_mass, Eigen::Vector2d(-1, -2));
    const LcpResult open = Sweep(&solver, infeasible, 50, &start);
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
  PgsSolver solver(With(PgsOptions::Form::kAssembled));
  const LcpResult result = Sweep(&solver, problem, 40, nullptr);
  EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
  EXPECT_LE(ComputeMetrics(problem, result.f).rho, 1.0);  // that of f = 0
  const LcpResult overflow = Sweep(&solver, problem, 0, nullptr);
  EXPECT_EQ(overflow.status, LcpStatus::kNumericalFailure);
  EXPECT_TRUE(overflow.f.allFinite());
}

TEST(Pgs, MatrixFreeNeedsFactorsAndNegativeDiagonalIsRefused) {
  const LcpProblem dense = LcpProblem::FromDense("dense", Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(-1, 1));
  PgsSolver solver(With(PgsOptions::Form::kMatrixFree));
  EXPECT_EQ(Sweep(&solver, dense, 0, nullptr).status, LcpStatus::kUnsupported);
  const LcpProblem negative =
      LcpProblem::FromDense("negative", -Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(1, 1));
  PgsSolver assembled;
  EXPECT_EQ(Sweep(&assembled, negative, 0, nullptr).status, LcpStatus::kUnsupported);
}

double g_clock = 0;
double StepClock() { return g_clock += 1.0; }

TEST(Pgs, TimeLimitIsReadFromTheInjectedClock) {
  // An infeasible problem never ends by itself: two opposed rows that both pull.
  Eigen::MatrixXd A(2, 2);
  A << 1, -1, -1, 1;
  const LcpProblem problem = LcpProblem::FromDense("jam", A, Eigen::Vector2d(-1, -1));
  PgsSolver solver;
  LcpOptions options;
  options.time_limit_s = 5.5;
  options.now = &StepClock;
  g_clock = 0;
  LcpResult result;
  solver.Solve(problem, options, &result);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_GT(result.iterations, 0);
  EXPECT_LT(result.iterations, PgsOptions::kDefaultSweeps);
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
