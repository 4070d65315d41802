// What every backend of ours promises, run over all of them: it may fail, but it may not lie. What is asked of other
// projects' solvers stands in peer_contract_test.cc.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "solvers/lcp/rounding_floor.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/io/read_lcp_file.h"
#include "tests/solvers/rounded_problems.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

// [s] Of a solve that may go on without end.
constexpr double kShortTime = 0.02;

class SolverContract : public SolverTest {
 protected:
  // The heart of the suite: what is promised holds, and nothing is claimed that the verdict refutes.
  void Check(const TestProblem& test, double tolerance) {
    SCOPED_TRACE(test.problem.id() + " at " + std::to_string(tolerance));
    const LcpResult result = Solve(test.problem, tolerance);
    const Verdict verdict = Verify(test.problem, result, tolerance, &test.reference);
    EXPECT_NE(result.status, LcpStatus::kNotRun);
    EXPECT_EQ(result.f.size(), test.problem.size());
    EXPECT_TRUE(result.f.allFinite());
    EXPECT_FALSE(verdict.false_success) << verdict.reason << "; " << result.detail;
    EXPECT_FALSE(verdict.false_infeasible) << result.detail;
    Answers(verdict.passes || (verdict.farkas.has_value() && verdict.farkas->accepted));
    if (test.reference.status == LcpReference::Status::kInfeasible) {
      // At a loose tier the verdict itself may pass a point of a problem that is infeasible by less than the tier.
      if (tolerance <= 1e-6 || !GetParam().uses_tolerance) {
        EXPECT_NE(result.status, LcpStatus::kSolved);
      }
      if (verdict.farkas.has_value()) {
        EXPECT_TRUE(verdict.farkas->accepted) << verdict.farkas->reason;
      }
      return;
    }
    if (!GetParam().why_not_guaranteed(test.problem, tolerance).empty()) return;
    EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
    EXPECT_TRUE(verdict.passes) << verdict.reason;
    // w is unique; the residual bounds its error through the scaled row. At the loosest tier the condition of A decides
    // how far, and on l0281 it is the order of a BLAS's sums that does.
    if (test.reference.w.has_value() && tolerance <= 1e-6) {
      const Eigen::VectorXd& d = test.problem.DiagonalA();
      const double b_max = test.problem.b().cwiseAbs().maxCoeff();
      double scaled_b = 0;
      for (Index i = 0; i < d.size(); ++i) scaled_b += std::pow(test.problem.b()[i], 2) / (d[i] > 0 ? d[i] : 1.0);
      for (Index i = 0; i < d.size(); ++i) {
        const double bound = std::max(1e-8, 10 * verdict.metrics.rho * std::sqrt(scaled_b * d[i]) / (1 + b_max));
        // Guaranteed at 1e-6 only: the allowance grows with the tolerance asked for.
        const double allowed = std::max(bound, tolerance > 1e-9 ? 10 * tolerance : 0.0) * (1 + b_max);
        EXPECT_LE(std::abs(verdict.metrics.w[i] - (*test.reference.w)[i]), allowed) << "row " << i;
      }
    }
  }

  void CheckAll(const std::vector<TestProblem>& problems, std::initializer_list<double> tolerances) {
    for (const TestProblem& test : problems) {
      for (const double tolerance : tolerances) Check(test, tolerance);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(AllSolvers, SolverContract, testing::ValuesIn(PlainSolversOf(SolverOrigin::kOwn)),
                         SolverTestName);

TEST_P(SolverContract, MayFailOnTextbookProblemsButMayNotLie) { CheckAll(TextbookProblems(), {1e-3, 1e-6, 1e-9}); }
TEST_P(SolverContract, MayFailOnExactOracleProblemsButMayNotLie) { CheckAll(OracleProblems(), {1e-3, 1e-6, 1e-9}); }
TEST_P(SolverContract, MayFailOnGeneratedProblemsButMayNotLie) { CheckAll(GeneratedProblems(), {1e-6, 1e-9}); }

// Where terms of w cancel, its rounding may be 0 by chance and hide an error far above the tolerance; in islands of a
// pendulum that DART recorded, rounding of A is all that is left of a small row.
TEST_P(SolverContract, RowsWhoseTermsCancelMayFailButMayNotLie) {
  std::vector<LcpProblem> problems = ReportedProblems("false-success-bpp");
  for (const LcpProblem& problem : ReportedProblems("terms-that-cancel")) problems.push_back(problem);
  for (unsigned seed = 0; seed < 100; ++seed) problems.push_back(NearlyParallelRows(seed));
  for (const LcpProblem& problem : problems) {
    for (const double tolerance : kTiers) {
      const LcpOptions options{.tolerance = tolerance, .time_limit_s = kShortTime};
      for (const LcpResult& result :
           {SolveArraysWith(solver_.get(), problem, options), SolveWith(solver_.get(), problem, options)}) {
        const Verdict verdict = Verify(problem, result, tolerance);
        EXPECT_FALSE(verdict.false_success) << problem.id() << " at " << tolerance << ": " << verdict.reason;
      }
    }
  }
}

// The floor is told by those that fail at it, and by no others.
TEST_P(SolverContract, AFailureAtTheRoundingFloorSaysSo) {
  constexpr double kAsked = 1e-9;
  int told = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const TwoJoints test = NearlyParallelJoints(seed);
    const double floor = RoundingFloor(test.problem, test.f);
    const LcpResult result = Solve(test.problem, kAsked, kShortTime);
    const bool tells = result.detail.find("1e-09 is below the rounding floor") != std::string::npos;
    const bool is_near = (result.f - test.f).norm() <= 1e-2 * test.f.norm();
    SCOPED_TRACE(test.problem.id() + ": floor " + std::to_string(std::log10(floor)) + ", " + result.detail);
    if (tells) {
      EXPECT_EQ(result.status, LcpStatus::kNumericalFailure);
      EXPECT_GT(floor, 0.9 * kAsked);
      EXPECT_FALSE(Verify(test.problem, result, kAsked).passes);
      ++told;
    }
    if (result.status == LcpStatus::kNumericalFailure && is_near && floor > 1.1 * kAsked) {
      EXPECT_EQ(tells, ComputeMetrics(test.problem, result.f).rho <= std::min(kFloorReach * floor, kLargestFloor));
    }
  }
  if (GetParam().key == "auto" || GetParam().key == "bpp") {
    EXPECT_GT(told, 20);
  }
}

// Solvable, with forces up to 10^12 |b|: what is nearly a ray must not be taken for one.
TEST_P(SolverContract, HeavyOnLightIsNeverCalledInfeasible) {
  for (const auto& [n, ratio] : {std::pair<Index, double>{500, 1e6}, {1000, 1e7}, {500, 1e8}}) {
    const StackedColumn column = MakeStackedColumn(n, ratio);
    const LcpResult result = Solve(column.problem, 1e-9, 0.5);
    EXPECT_NE(result.status, LcpStatus::kInfeasible) << n << " bodies of masses 1 and " << ratio;
  }
}

TEST_P(SolverContract, NearlyParallelJointsAreNotProvedInfeasible) {
  for (const LcpProblem& problem : ReportedProblems("nearly-parallel-joints")) {
    for (const double tolerance : kTiers) {
      const LcpResult result = Solve(problem, tolerance);
      if (result.status != LcpStatus::kInfeasible) continue;
      EXPECT_FALSE(problem.has_factors()) << problem.id();
      const Verdict verdict = Verify(problem, result, tolerance);
      ASSERT_TRUE(verdict.farkas.has_value());
      EXPECT_TRUE(verdict.farkas->accepted && !verdict.farkas->proved) << problem.id();
      EXPECT_GT(verdict.farkas->force_min, 1e14);
    }
  }
}

TEST_P(SolverContract, RowKindsAreTakenOrRefusedByName) {
  EXPECT_EQ(solver_->TakesFriction(), GetParam().takes_friction);
  EXPECT_EQ(solver_->TakesBounded(), GetParam().takes_bounded);
  ExpectRowKindsAreTakenOrRefused();
  // What a solver does not take of plain problems it says before.
  const LcpProblem plain =
      LcpProblem::FromDense("diagonal", Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, 0, 1), {}, SymmetricPsd());
  const LcpResult result = Solve(plain, 1e-6);
  EXPECT_EQ(result.status, solver_->WhyUnsupported(plain).empty() ? LcpStatus::kSolved : LcpStatus::kUnsupported);
}

TEST_P(SolverContract, NoRowsIsSolved) {
  const LcpResult result = Solve(LcpProblem::FromDense("empty", Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)), 1e-9);
  EXPECT_EQ(result.status, LcpStatus::kSolved);
  EXPECT_EQ(result.f.size(), 0);
}

// b, rows and masses in other units, and rows in another order.
TEST_P(SolverContract, AnswersFollowUnitsAndOrder) {
  constexpr Index kSize = 16;
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(kSize);
  const std::vector<Index> all = EveryRow(kSize);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const LcpProblem problem = PlantedProblem(kSize, seed % 4 < 2 ? 10 : 4, seed, seed % 2 == 0 ? 4 : 0, 0).problem;
    std::mt19937 random(seed);
    Eigen::VectorXd scale(kSize);
    for (double& s : scale) s = std::ldexp(1.0, static_cast<int>(random() % 40) - 20);
    std::vector<Index> order = all;
    std::shuffle(order.begin(), order.end(), random);
    const struct {
      LcpProblem problem;
      std::vector<Index> order;
      Eigen::VectorXd of_w;
    } others[] = {{problem.WithB(0x1p40 * problem.b()), all, 0x1p40 * ones},
                  {problem.WithB(0x1p-40 * problem.b()), all, 0x1p-40 * ones},
                  {ScaleRows(problem, scale, 0x1p-40), all, scale},
                  {ScaleRows(problem, scale, 1), all, scale},
                  {ScaleRows(problem, scale, 0x1p40), all, scale},
                  {RowsOf(problem, order), order, ones}};
    const LcpResult one = Solve(problem, 1e-6);
    const Eigen::VectorXd w = ComputeMetrics(problem, one.f).w;
    for (const auto& other : others) {
      const LcpResult two = Solve(other.problem, 1e-6);
      EXPECT_EQ(one.status, two.status) << problem.id() << ": " << one.detail << " | " << two.detail;
      EXPECT_FALSE(Verify(other.problem, two, 1e-6).false_success);
      if (!Answers(two) || one.status != LcpStatus::kSolved) continue;
      const Eigen::VectorXd found = ComputeMetrics(other.problem, two.f).w.cwiseQuotient(other.of_w);
      EXPECT_LE((found - w(other.order)).cwiseAbs().maxCoeff(), 1e-4 * (1 + problem.b().cwiseAbs().maxCoeff()));
    }
  }
}

TEST_P(SolverContract, DenseAndSparseAndFactorsGiveTheSameW) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const TestProblem test = PlantedProblem(12, 6, seed, 4, 0);
    for (const MatrixForm form : {MatrixForm::kDense, MatrixForm::kSparse}) {
      Check({InForm(test.problem, form), test.reference}, 1e-6);
    }
  }
}

// First-order methods included: whoever claims a solution has the w of all others.
TEST_P(SolverContract, ClaimsHaveTheOneW) {
  LcpOptions options;
  options.max_iterations = GetParam().uses_tolerance ? 2000 : 0;  // sweeps
  for (const ExactFamily& family : SolvableFamilies()) {
    for (unsigned seed = 0; seed < 15; ++seed) {
      TestProblem test = family.make(seed);
      // Their entries of A are exact, too.
      if (!solver_->WhyUnsupported(test.problem).empty()) test.problem = InForm(test.problem, MatrixForm::kDense);
      const LcpResult result = Solve(test.problem, options);
      if (!Answers(result)) continue;
      const Verdict verdict = Verify(test.problem, result, options.tolerance, &test.reference);
      EXPECT_FALSE(verdict.false_success) << test.problem.id() << ": " << verdict.reason;
      EXPECT_LE(verdict.metrics.w_error, 1e-7) << test.problem.id();
    }
  }
}

TEST_P(SolverContract, WarmStartsAreSafe) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const TestProblem test = PlantedProblem(20, 5, seed, seed % 2 == 0 ? 5 : 0, 0);
    LcpOptions options{.tolerance = 1e-6};
    const LcpResult cold = Solve(test.problem, options);
    for (const double disturbance : {0.0, 0.01, 1.0, -1e6}) {
      Eigen::VectorXd start = cold.f;
      for (Index i = 0; i < start.size(); ++i) start[i] += disturbance * (i % 3 == 0 ? 1 : -1);
      options.initial_f = &start;
      const LcpResult warm = Solve(test.problem, options);
      const Verdict verdict = Verify(test.problem, warm, 1e-6, &test.reference);
      EXPECT_FALSE(verdict.false_success) << verdict.reason;
      Answers(verdict.passes);
      if (GetParam().why_not_guaranteed(test.problem, 1e-6).empty()) {
        EXPECT_EQ(warm.status, LcpStatus::kSolved) << test.problem.id() << " " << warm.detail;
      }
    }
  }
}

TEST_P(SolverContract, LimitsEndASolveHonestly) {
  const LcpProblem given = PlantedProblem(60, 30, 4, 0, 0).problem;
  LcpProblem problem = given;
  for (const LcpProblem& form : {InForm(given, MatrixForm::kDense), DiscPile(60, 1)}) {
    if (!solver_->WhyUnsupported(problem).empty()) problem = form;
  }
  LcpOptions options{.tolerance = 1e-9};
  options.max_iterations = 1;
  const LcpResult limited = Solve(problem, options);
  if (limited.status == LcpStatus::kUnsupported) return;  // fewer rows than a clock is read for are all that it takes
  EXPECT_FALSE(Verify(problem, limited, 1e-9).false_success);
  EXPECT_TRUE(limited.status == LcpStatus::kIterationLimit || limited.status == LcpStatus::kSolved)
      << ToString(limited.status);

  // A clock that is always past the limit.
  static double now;
  now = 0;
  options = {.tolerance = 1e-9, .time_limit_s = 1e-3};
  options.now = [] { return now += 1.0; };
  const LcpResult late = Solve(problem, options);
  EXPECT_EQ(late.status, LcpStatus::kTimeLimit) << late.detail;
  EXPECT_EQ(late.f.size(), 60);
  EXPECT_TRUE(late.f.allFinite());
}

TEST_P(SolverContract, ImpossibleOptionsAreRefused) {
  const LcpProblem problem = PlantedProblem(3, 2, 1, 0, 0).problem;
  for (const double tolerance : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(Solve(problem, tolerance), InputError);
  }
  EXPECT_THROW(Solve(problem, 1e-9, 0), InputError);
  const Eigen::VectorXd short_f = Eigen::VectorXd::Zero(2);
  EXPECT_THROW(Solve(problem, {.initial_f = &short_f}), InputError);
  EXPECT_THROW(GetParam().make({{"no-such-option", "1"}}), InputError);
}

TEST(Registry, SettingsOutOfRangeOrOfAnotherKeyAreRefused) {
  for (const auto& refused : RefusalCases("settings")) {
    if (!FindSolver(refused[0]).available) continue;
    EXPECT_THROW(MakeSolver(refused[0], {{refused[1], refused[2]}}), InputError) << refused[0] << " " << refused[1];
  }
}

TEST(Registry, AnOlderAndAShortKeyFindTheirSolvers) {
  EXPECT_EQ(FindSolver("suitesparse").key, "ipm");
  EXPECT_EQ(FindSolver("ssn").key, "semismooth-newton");
}

TEST(Registry, UnknownKeysNameTheKnownOnes) {
  ExpectRefused([] { FindSolver("simplex"); }, "dantzig");
}

// The adapters of peers in this build must take it; how far their solver gets is its own matter.
TEST(NonsymmetricMatrices, TheRefusalNamesWhoTakesThem) {
  Eigen::Matrix2d A;
  A << 2, 1, -1, 2;
  const LcpProblem problem = LcpProblem::FromDense("other", A, Eigen::Vector2d(-1, -2));
  const std::string refusal = MakeSolver("auto")->WhyUnsupported(problem);
  std::string named = refusal + ",";
  std::replace(named.begin(), named.end(), ' ', ',');
  int takers = 0;
  for (const SolverEntry& entry : AllSolvers()) {
    const bool is_named = named.find("," + entry.key + ",") != std::string::npos;
    takers += is_named ? 1 : 0;
    if (!entry.available || (entry.origin != SolverOrigin::kOwn && !is_named)) continue;
    LcpResult result;
    LcpOptions options;
    options.time_limit_s = 1;
    entry.make({})->Solve(problem, options, &result);
    EXPECT_EQ(result.status != LcpStatus::kUnsupported, is_named) << entry.key << ": " << refusal;
    if (!is_named) {
      EXPECT_EQ(result.detail, refusal) << entry.key;
    }
  }
  EXPECT_EQ(takers, 3) << refusal;
  EXPECT_TRUE(refusal.ends_with("and several peers")) << refusal;
}

}  // namespace
}  // namespace lcpbench
