// The last rule of `auto`: against exact answers of problems that methods in doubles leave open.

#include "solvers/auto/exact_rule.h"

#include <gtest/gtest.h>
#include <time.h>

#include <cmath>
#include <string>
#include <vector>

#include "solvers/auto/auto_solver.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

// Processor time of this thread: what else runs on the machine does not count.
double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double Number(TestRandom* random) { return random->Integer(-1000000, 1000000) / 1e6; }

// Rows of which every other one is nearly a row before it, on masses up to 1e8 apart.
LcpProblem NearlyParallel(unsigned seed, Index n, RowBounds bounds) {
  TestRandom random(seed);
  Eigen::MatrixXd J(n, n + 1);
  const double angle = std::pow(10.0, -7 + 5 * Number(&random));
  for (Index i = 0; i < n; ++i) {
    const bool is_near = i > 0 && random.Chance(0.5);
    const Index base = is_near ? random.Integer(0, static_cast<int>(i) - 1) : 0;
    for (Index c = 0; c <= n; ++c) J(i, c) = is_near ? J(base, c) + angle * Number(&random) : Number(&random);
  }
  const Eigen::VectorXd masses =
      Eigen::VectorXd::NullaryExpr(n + 1, [&] { return std::pow(10.0, 4 * Number(&random)); });
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return Number(&random); });
  return LcpProblem::FromFactors("near-" + std::to_string(seed), J.sparseView(1.0, 0.0), masses, b, std::move(bounds));
}

// Asked alone, from f = 0.
LcpResult Ask(const LcpProblem& problem, const LcpOptions& options) {
  LcpResult result;
  result.f.setZero(problem.size());
  result.status = LcpStatus::kNumericalFailure;
  TryExact(problem, options, kDefaultLimits, Deadline(options), &result);
  return result;
}

void ExpectNothingFalse(const LcpProblem& problem, const LcpResult& result, double tolerance) {
  const Verdict verdict = Verify(problem, result, tolerance);
  EXPECT_FALSE(verdict.false_success || verdict.false_infeasible) << problem.id() << ": " << verdict.reason;
}

TEST(ExactRule, AnswersTwoRowsThatAreParallelButFor2ToMinus24) {
  const Eigen::MatrixXd J{{1, 0}, {1, 0x1p-24}};
  const LcpProblem problem = LcpProblem::FromFactors("toggle", J.sparseView(1.0, 0.0), Eigen::Vector2d(1, 1),
                                                     Eigen::Vector2d(0, -1), RowBounds::WithBilateralRows(2, {0, 1}));
  AutoSolver solver;
  const LcpResult result = SolveWith(&solver, problem);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
  EXPECT_EQ(result.f, Eigen::Vector2d(-0x1p48, 0x1p48));
}

TEST(ExactRule, SolvesWhatTheRoundedExactSolutionSolves) {
  int solved = 0, together = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    TestRandom random(seed + 1000);
    const Index n = random.Integer(2, 14);
    std::vector<Index> bilateral;
    for (Index i = 0; i < n; ++i) {
      if (random.Chance(0.1)) bilateral.push_back(i);
    }
    const LcpProblem problem = NearlyParallel(seed, n, RowBounds::WithBilateralRows(n, bilateral));
    const ExactAnswer exact = SolveExactly(ExactFrom(problem), {.answer_only = true});
    for (const double tolerance : {1e-6, 1e-9}) {
      const LcpResult result = Ask(problem, {.tolerance = tolerance});
      ExpectNothingFalse(problem, result, tolerance);
      if (exact.status != ExactAnswer::Status::kSolved) continue;
      if (PassesTier(ComputeMetrics(problem, Rounded(exact.f)), tolerance)) {
        EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id();
        EXPECT_EQ(result.f, Rounded(exact.f));
        ++solved;
      } else if (result.status == LcpStatus::kSolved) {  // errors of rounding cancel
        EXPECT_LT((result.f - Rounded(exact.f)).lpNorm<Eigen::Infinity>(), 1e-6 * result.f.lpNorm<Eigen::Infinity>());
        ++together;
      } else {
        EXPECT_NE(result.detail.find("does not pass"), std::string::npos) << result.detail;
      }
    }
  }
  EXPECT_GT(solved, 30);
  EXPECT_GE(together, 5);
}

// b is chosen so that a planted f with opening, sticking and sliding contacts solves the problem, to rounding.
TEST(ExactRule, SolvesFrictionOfNearlyParallelContacts) {
  int solved = 0, all = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    TestRandom random(seed);
    const Index contacts = random.Integer(2, 8);
    RowBounds bounds;
    for (Index c = 0; c < contacts; ++c) bounds.friction.push_back({2 * c + 1, 2 * c, 0.25 * random.Integer(1, 6)});
    LcpProblem problem = NearlyParallel(seed, 2 * contacts, bounds);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(2 * contacts), w = f, Af;
    for (const FrictionRow& row : bounds.friction) {
      const int mode = random.Integer(0, 2);
      if (mode == 0) w[row.normal] = 1 + Number(&random) / 2;
      if (mode != 0) f[row.normal] = 2 + Number(&random);
      f[row.row] = mode == 1 ? row.mu * f[row.normal] * Number(&random) : mode == 2 ? -row.mu * f[row.normal] : 0;
      w[row.row] = mode == 0 ? Number(&random) : mode == 2 ? std::abs(Number(&random)) : 0;
    }
    problem = problem.WithB(Eigen::VectorXd::Zero(2 * contacts));
    problem.ComputeW(f, &Af);
    problem = problem.WithB(w - Af);
    const LcpResult result = Ask(problem, {.time_limit_s = 10});
    ExpectNothingFalse(problem, result, LcpOptions{}.tolerance);
    solved += result.status == LcpStatus::kSolved ? 1 : 0;
    ++all;
  }
  EXPECT_GE(solved, all * 3 / 4);
}

TEST(ExactRule, KeepsTheTimeLimit) {
  const LcpProblem problem = NearlyParallel(7, 160, {});
  for (const double limit : {0.1, 0.5}) {
    const double start = CpuSeconds();
    const LcpResult result = Ask(problem, {.time_limit_s = limit, .now = &CpuSeconds});
    EXPECT_LT(CpuSeconds() - start, 1.05 * limit + 0.01) << result.detail;
    ExpectNothingFalse(problem, result, LcpOptions{}.tolerance);
  }
}

TEST(ExactRule, IsNotAskedBeyondItsSizesNorWithALimitOfIterations) {
  EXPECT_EQ(Ask(NearlyParallel(1, kDefaultLimits.exact_rows + 1, {}), {}).detail, "");
  RowBounds bounds;
  for (Index c = 0; c <= kDefaultLimits.exact_contacts; ++c) bounds.friction.push_back({2 * c + 1, 2 * c, 0.5});
  EXPECT_EQ(Ask(NearlyParallel(1, 2 * kDefaultLimits.exact_contacts + 2, bounds), {}).detail, "");
  EXPECT_EQ(Ask(NearlyParallel(1, 3, {}), {.max_iterations = 10}).detail, "");
}

}  // namespace
}  // namespace lcpbench
