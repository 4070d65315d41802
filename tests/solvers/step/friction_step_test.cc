// From an engine's arrays with friction to forces: alone, warm, in batches, and without allocation.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "benchmarks/studies/step_arrays.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "solvers/step/step_solver.h"
#include "tests/solvers/friction/friction_suite.h"
#include "tests/solvers/solve_with.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

constexpr Index kMostRows = 128;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// All kinds of the suite, up to kMostRows rows.
std::vector<LcpProblem> Problems() {
  std::vector<LcpProblem> problems = StructuredFrictionProblems(3, kMostRows / 2);
  for (unsigned seed = 0; seed < 100; ++seed) problems.push_back(RandomFrictionProblem(500'000 + seed, 20));
  std::erase_if(problems, [](const LcpProblem& problem) { return problem.size() > kMostRows; });
  return problems;
}

std::vector<StepArrays> ArraysOf(const std::vector<LcpProblem>& problems) {
  std::vector<StepArrays> arrays;
  for (const LcpProblem& problem : problems) arrays.push_back(StepArrays::Of(problem));
  return arrays;
}

TEST(StepWithFriction, AnswersPassAndTellTheirGaps) {
  StepSolver solver;
  for (const LcpProblem& problem : Problems()) {
    const StepArrays arrays = StepArrays::Of(problem);
    VectorXd f = VectorXd::Constant(problem.size(), kNaN), w = f;
    const StepAnswer answer = solver.Solve(arrays.View(), nullptr, f.data(), w.data());
    ASSERT_EQ(answer.status, LcpStatus::kSolved) << problem.id();
    const Metrics metrics = ComputeMetrics(problem, f);
    EXPECT_TRUE(PassesTier(metrics, 1e-9)) << problem.id() << " " << metrics.rho;
    EXPECT_LE(answer.rho, 1e-9) << problem.id();
    EXPECT_LE((w - metrics.w).norm(), 1e-9 * (1 + metrics.w.norm())) << problem.id();
  }
}

TEST(StepWithFriction, IsWhatAutoDoesFromArraysAndFromAProblem) {
  StepSolver steps;
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (const LcpProblem& problem : Problems()) {
    const StepArrays arrays = StepArrays::Of(problem);
    VectorXd f(problem.size());
    steps.Solve(arrays.View(), nullptr, f.data());
    EXPECT_EQ(SolveArraysWith(solver.get(), problem).f, f) << problem.id();
    EXPECT_EQ(SolveWith(solver.get(), problem).f, f) << problem.id();
  }
}

TEST(StepWithFriction, AllocatesInReserveOnly) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  const std::vector<LcpProblem> problems = Problems();
  const std::vector<StepArrays> arrays = ArraysOf(problems);
  Index bodies = 0;
  for (const StepArrays& step : arrays) bodies = std::max(bodies, step.bodies());
  std::vector<VectorXd> f, w;
  for (const LcpProblem& problem : problems) f.emplace_back(w.emplace_back(problem.size()));
  StepSolver solver;
  solver.Reserve(kMostRows, bodies);
  int in_place = 0;
  CountAllocations(true);
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    const StepRows rows = arrays[k].View();
    for (const bool is_warm : {false, true}) {
      const VectorXd start = f[k];
      const std::int64_t fallbacks = solver.fallbacks();
      const long before = AllocationCount();
      const StepAnswer answer = solver.Solve(rows, is_warm ? start.data() : nullptr, f[k].data(), w[k].data());
      const long after = AllocationCount();
      EXPECT_EQ(answer.status, LcpStatus::kSolved) << problems[k].id();
      if (solver.fallbacks() != fallbacks) continue;
      EXPECT_EQ(after, before) << problems[k].id();
      ++in_place;
    }
  }
  CountAllocations(false);
  EXPECT_EQ(in_place, 2 * std::ssize(problems));
}

// The forces of a step solve it as they are, also where contacts have come and gone since.
TEST(StepWithFriction, WarmStartsAreTaken) {
  StepSolver solver;
  for (const LcpProblem& problem : Problems()) {
    const StepArrays arrays = StepArrays::Of(problem);
    VectorXd cold(problem.size()), warm(problem.size());
    const StepAnswer first = solver.Solve(arrays.View(), nullptr, cold.data());
    const StepAnswer again = solver.Solve(arrays.View(), cold.data(), warm.data());
    ASSERT_EQ(again.status, LcpStatus::kSolved) << problem.id();
    EXPECT_LE(again.iterations, first.iterations) << problem.id();
    VectorXd other = cold;
    for (Index i = 0; i < other.size(); i += 3) other[i] = 0;
    ASSERT_EQ(solver.Solve(arrays.View(), other.data(), warm.data()).status, LcpStatus::kSolved) << problem.id();
    EXPECT_TRUE(PassesTier(ComputeMetrics(problem, warm), 1e-9)) << problem.id();
  }
}

TEST(StepWithFriction, ABatchIsItsProblems) {
  const std::vector<StepArrays> arrays = ArraysOf(Problems());
  StepArrays all;
  std::vector<std::int32_t> start = {0};
  for (const StepArrays& step : arrays) {
    all.Append(step);
    start.push_back(static_cast<std::int32_t>(all.rows()));
  }
  std::ranges::reverse(all.friction);  // in any order
  for (const int threads : {1, 3}) {
    StepSolver solver({.threads = threads}), alone;
    VectorXd f = VectorXd::Constant(all.rows(), kNaN);
    std::vector<StepAnswer> answers(arrays.size());
    solver.SolveBatch(all.View(), start, f.data(), answers);
    EXPECT_EQ(solver.left(), std::ssize(arrays));
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      VectorXd own(arrays[k].rows());
      const StepAnswer answer = alone.Solve(arrays[k].View(), nullptr, own.data());
      EXPECT_EQ(f.segment(start[k], own.size()), own) << k;
      EXPECT_EQ(answers[k].status, answer.status) << k;
      EXPECT_EQ(std::bit_cast<std::uint64_t>(answers[k].rho), std::bit_cast<std::uint64_t>(answer.rho)) << k;
    }
  }
}

TEST(StepWithFriction, MistakesInBatchesAreNamed) {
  StepArrays arrays = StepArrays::Of(RandomFrictionProblem(1, 4));
  const auto rows = static_cast<std::int32_t>(arrays.rows());
  arrays.Append(StepArrays(arrays));
  std::vector<StepAnswer> answers(2);
  VectorXd f(arrays.rows());
  const auto refusal = [&](const std::vector<FrictionRow>& friction) {
    StepRows view = arrays.View();
    view.friction = friction;
    return RefusalOf([&] { StepSolver().SolveBatch(view, std::vector{0, rows, 2 * rows}, f.data(), answers); });
  };
  FrictionRow wrong = arrays.friction.back();
  const std::string place = "friction: row " + std::to_string(wrong.row) + ": ";
  wrong.mu = -1;
  EXPECT_EQ(refusal({wrong}), "problem 'step': " + place + "mu is -1, expected a finite number >= 0");
  wrong = arrays.friction.back();
  wrong.normal = arrays.friction.front().normal;
  EXPECT_EQ(refusal({wrong}), "step rows: " + place + "normal is " + std::to_string(wrong.normal) +
                                  ", expected a row of the same problem");
}

}  // namespace
}  // namespace lcpbench
