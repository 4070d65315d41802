// What pgs, psor, nncg and apgd have in common beyond the contract of all solvers.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "solvers/first_order/first_order_engine.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/first_order/first_order_runs.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class FirstOrder : public testing::TestWithParam<std::string> {
 protected:
  static LcpResult Solve(const LcpProblem& problem, const LcpOptions& options, const Settings& settings = {}) {
    return SolveWith(MakeSolver(GetParam(), settings).get(), problem, options);
  }
  static LcpResult IterateFrom0(const LcpProblem& problem, std::int64_t iterations, const Settings& settings) {
    return Iterate(MakeSolver(GetParam(), settings).get(), problem, 1e-15, iterations);
  }
  // Every value of every setting but `form`.
  static std::vector<Settings> Variants() {
    if (GetParam() == "apgd") return {{}, {{"restart", "no"}}};
    if (GetParam() == "nncg") return {{}, {{"sweep", "symmetric"}}, {{"direction", "fletcher-reeves"}}};
    const std::string relaxation = GetParam() == "pgs" ? "relaxation" : "first_relaxation";
    return {{},
            {{"sweep", "forward"}, {relaxation, "0.4"}},
            {{"sweep", "symmetric"}, {relaxation, "1.6"}},
            {{relaxation, "1.95"}}};
  }
};

INSTANTIATE_TEST_SUITE_P(Keys, FirstOrder, testing::Values("pgs", "psor", "nncg", "apgd"),
                         [](const auto& key) { return key.param; });

// Full rank and no chain: every first-order method gets there.
std::vector<TestProblem> EasyProblems() {
  std::vector<TestProblem> problems;
  for (unsigned seed = 1; seed <= 6; ++seed) problems.push_back(PlantedProblem(20, 12, seed, seed % 2 == 0 ? 5 : 0, 0));
  return problems;
}

// Rows on three bodies each, so that the two-body path does not apply.
LcpProblem ThreeBodyProblem(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> entry(-3, 3);
  Triplets entries;
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 12; ++k) entries.emplace_back(i, k, entry(random));
  }
  Eigen::VectorXd b(8);
  for (double& value : b) value = entry(random);
  return LcpProblem::FromFactors("three-body", MatrixOf(8, 12, entries), Eigen::VectorXd::LinSpaced(12, 0.5, 2.0), b);
}

TEST_P(FirstOrder, SolvesEasyProblemsToEveryTierInEveryFormAndVariant) {
  for (const TestProblem& test : EasyProblems()) {
    for (Settings settings : Variants()) {
      for (const char* form : {"auto", "assembled", "matrix-free"}) {
        settings["form"] = form;
        for (const double tolerance : kTiers) {
          const LcpResult result = Solve(test.problem, {.tolerance = tolerance}, settings);
          SCOPED_TRACE(std::string(form) + " " + std::to_string(tolerance));
          ExpectSolved(test.problem, result, tolerance);
          EXPECT_FALSE(Verify(test.problem, result, tolerance, &test.reference).false_success);
        }
      }
    }
  }
}

TEST_P(FirstOrder, BothFormsGiveTheSameIteratesUpToRounding) {
  std::vector<LcpProblem> problems;
  for (const TestProblem& test : EasyProblems()) problems.push_back(test.problem);
  for (unsigned seed = 0; seed < 20; ++seed) problems.push_back(ThreeBodyProblem(seed));
  for (Settings settings : Variants()) {
    // Colours differ from form to form.
    if (GetParam() != "apgd") settings.emplace("sweep", GetParam() == "nncg" ? "symmetric" : "forward");
    for (const LcpProblem& problem : problems) {
      for (const std::int64_t iterations : {1, 2, 7}) {
        settings["form"] = "assembled";
        const Eigen::VectorXd a = IterateFrom0(problem, iterations, settings).f;
        settings["form"] = "matrix-free";
        const Eigen::VectorXd m = IterateFrom0(problem, iterations, settings).f;
        // Forces compare in the scaled problem, where none has units.
        const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt();
        EXPECT_LE(root.cwiseProduct(a - m).cwiseAbs().maxCoeff(), 1e-9 * root.cwiseProduct(a).cwiseAbs().maxCoeff())
            << problem.id() << ", " << iterations << " iterations";
      }
    }
  }
}

TEST_P(FirstOrder, EnergyNeverRises) {
  if (GetParam() == "apgd") GTEST_SKIP() << "apgd is not monotone";
  std::vector<TestProblem> problems = GeneratedProblems();
  problems.push_back({PressedChain(60), {}});
  problems.push_back(PlantedProblem(40, 20, 2, 5, 0));
  int compared = 0;
  for (Settings settings : Variants()) {
    if (settings.count("direction") > 0) continue;
    for (const char* form : {"auto", "assembled"}) {
      settings["form"] = form;
      for (const TestProblem& test : problems) {
        double energy = 0;
        for (const std::int64_t iterations : {1, 2, 3, 4, 6, 9, 10, 11, 12, 15, 20, 22, 25, 30}) {
          const LcpResult result = IterateFrom0(test.problem, iterations, settings);
          // The start is returned where its residual is less than that of the last iterate.
          if (result.f.isZero(0)) continue;
          ++compared;
          const double next = Energy(test.problem, result.f);
          EXPECT_LE(next, energy + 1e-9 * std::abs(energy)) << test.problem.id() << ", " << iterations;
          energy = next;
        }
      }
    }
  }
  EXPECT_GE(compared, 300);
}

TEST_P(FirstOrder, UnitsChangeNothingButTheUnits) {
  for (const TestProblem& test : EasyProblems()) {
    const LcpProblem& problem = test.problem;
    const LcpResult plain = Solve(problem, {.tolerance = 1e-6});
    for (const double of_mass : {0x1p-40, 1.0, 0x1p40}) {
      for (const double of_b : {0x1p-40, 1.0, 0x1p40}) {
        const LcpProblem scaled = LcpProblem::FromFactors("units", problem.J(), of_mass * problem.inverse_mass(),
                                                          of_b * problem.b(), problem.bounds());
        const LcpResult result = Solve(scaled, {.tolerance = 1e-6});
        EXPECT_EQ(result.iterations, plain.iterations) << problem.id() << " " << of_mass << " " << of_b;
        EXPECT_EQ(result.f * (of_mass / of_b), plain.f) << problem.id() << " " << of_mass << " " << of_b;
      }
    }
  }
}

TEST_P(FirstOrder, AllocatesNothingOncePrepared) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted here";
  CountAllocations(true);
  std::vector<LcpProblem> problems = {ThreeBodyProblem(1)};
  for (const TestProblem& test : EasyProblems()) {
    problems.push_back(test.problem);
    problems.push_back(LcpProblem::FromSparse("sparse", test.problem.SparseA(), test.problem.b()));
  }
  for (const LcpProblem& problem : problems) {
    for (const std::string form : {"auto", "matrix-free"}) {
      if (!problem.has_factors() && form != "auto") continue;
      const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam(), {{"form", form}});
      LcpResult result;
      result.f.setZero(problem.size());
      solver->Prepare(problem);
      const long before = AllocationCount();
      solver->Solve(problem, {.tolerance = 1e-9}, &result);
      EXPECT_EQ(AllocationCount(), before) << problem.id() << " " << form;
      EXPECT_GT(result.iterations, 0);
      if (GetParam() == "apgd" || !problem.has_two_body_rows()) continue;
      const ProblemArrays arrays = ProblemArrays::Of(problem);
      solver->SolveArrays(arrays, {.tolerance = 1e-9}, &result);
      const long between = AllocationCount();
      solver->SolveArrays(arrays, {.tolerance = 1e-9}, &result);
      EXPECT_EQ(AllocationCount(), between) << problem.id();
    }
  }
}

TEST_P(FirstOrder, ArraysAreSolvedAsTheirProblemIs) {
  std::vector<TestProblem> problems = GeneratedProblems();
  for (const TestProblem& test : EasyProblems()) problems.push_back(test);
  problems.push_back(PlantedProblem(150, 75, 1, 7, 0));
  problems.push_back({ThreeBodyProblem(1), {}});
  problems.push_back({InForm(problems.back().problem, MatrixForm::kSparse), {}});
  int solved = 0;
  for (Settings settings : Variants()) {
    settings["form"] = "matrix-free";
    // Colours differ where the numbers of a row on a body are all 0.
    if (GetParam() != "apgd") settings.emplace("sweep", GetParam() == "nncg" ? "symmetric" : "forward");
    const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam(), settings);
    for (const TestProblem& test : problems) {
      const Eigen::VectorXd root = test.problem.DiagonalA().cwiseSqrt();
      for (const std::int64_t limit : {3, 5000}) {
        SCOPED_TRACE(test.problem.id());
        const LcpOptions options{.tolerance = 1e-6, .max_iterations = limit};
        const LcpResult of_arrays = SolveArraysWith(solver.get(), test.problem, options);
        const LcpResult result = Solve(test.problem, options, settings);
        EXPECT_FALSE(Verify(test.problem, of_arrays, 1e-6).false_success);
        EXPECT_EQ(of_arrays.status, result.status);
        solved += of_arrays.status == LcpStatus::kSolved ? 1 : 0;
        if (limit > 3) continue;
        // Forces compare in the scaled problem, where none has units.
        EXPECT_EQ(of_arrays.iterations, result.iterations);
        EXPECT_LE(root.cwiseProduct(of_arrays.f - result.f).cwiseAbs().maxCoeff(),
                  1e-9 * root.cwiseProduct(result.f).cwiseAbs().maxCoeff());
      }
    }
  }
  EXPECT_GE(solved, 50);
}

TEST_P(FirstOrder, WarmStartAtTheSolutionTakesNoIteration) {
  for (const TestProblem& test : EasyProblems()) {
    const LcpResult cold = Solve(test.problem, {.tolerance = 1e-9});
    ASSERT_EQ(cold.status, LcpStatus::kSolved);
    const LcpResult warm = Solve(test.problem, {.tolerance = 1e-6, .initial_f = &cold.f});
    EXPECT_EQ(warm.status, LcpStatus::kSolved);
    EXPECT_EQ(warm.iterations, 0) << test.problem.id();
  }
}

TEST_P(FirstOrder, ReadsTheClockOftenWithinAnIteration) {
  constexpr Index kRows = 4 * FirstOrderEngine::kEntriesPerClockRead;
  const LcpProblem problem = InForm(PressedChain(kRows), MatrixForm::kSparse);
  const LcpResult late = Solve(problem, {.time_limit_s = 0.5, .now = &TickingClock});  // over at the first reading
  EXPECT_EQ(late.status, LcpStatus::kTimeLimit);
  EXPECT_EQ(late.iterations, 0);
  EXPECT_TRUE(late.f.allFinite());

  ticks = 0;
  const LcpResult limited = Solve(problem, {.max_iterations = 5, .time_limit_s = 1e9, .now = &TickingClock});
  EXPECT_EQ(limited.status, LcpStatus::kIterationLimit);
  // Every iteration multiplies by every entry of A at least once, and two of three are off the diagonal.
  EXPECT_GE(ticks, 5.0 * 2 * kRows / FirstOrderEngine::kEntriesPerClockRead);
}

TEST_P(FirstOrder, RefusesWhatItsRowsCannotBe) {
  const auto status = [&](const Eigen::MatrixXd& A, const Settings& settings) {
    return Solve(LcpProblem::FromDense("refused", A, Eigen::Vector2d(-1, 1)), {.tolerance = 1e-6}, settings).status;
  };
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_EQ(status(one, {}), LcpStatus::kSolved);
  EXPECT_EQ(status(one, {{"form", "matrix-free"}}), LcpStatus::kUnsupported);
  EXPECT_EQ(status(-one, {}), LcpStatus::kUnsupported);
}

}  // namespace
}  // namespace lcpbench
