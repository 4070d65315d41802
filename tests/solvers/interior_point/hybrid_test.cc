// What is particular to the hybrid: sweeps, then the interior point, where each is the last word, and limits of both
// together. The promises of every solver are in contract_test.cc.

#include "solvers/interior_point/hybrid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

constexpr Index kRows = 600;  // above the size from which sweeps are used

// Sweeps that do not last: the interior point has to finish.
HybridSolver WithFewSweeps() {
  HybridOptions options;
  options.least_iterations = 5;
  options.most_iterations = 6;
  return HybridSolver(options);
}

TEST(Hybrid, SweepsAloneSolveWhatTheyConvergeOn) {
  HybridSolver solver;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const LcpProblem problem = DiscPile(kRows, seed);
    const LcpResult result = SolveWith(&solver, problem);
    ExpectSolved(problem, result);
    if (result.detail == "nncg") {
      EXPECT_GT(result.iterations, 10);
    }
  }
}

TEST(Hybrid, BothPhasesTogetherSolveWhatSweepsDoNot) {
  HybridSolver solver = WithFewSweeps();
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const LcpProblem problem = generate(kRows, seed);
      const LcpResult result = SolveWith(&solver, problem);
      ExpectSolved(problem, result);
      EXPECT_EQ(result.detail, "nncg; ipm");
      EXPECT_GT(result.iterations, solver.statistics().factorizations);
    }
  }
}

TEST(Hybrid, LimitsOfIterationsAreMetExactlyInEitherPhase) {
  const LcpProblem problem = Column(kRows, 3);
  HybridSolver solver = WithFewSweeps();
  const LcpResult whole = SolveWith(&solver, problem);
  ExpectSolved(problem, whole);
  for (std::int64_t limit = 1; limit < whole.iterations; ++limit) {
    LcpOptions options;
    options.max_iterations = limit;
    const LcpResult result = SolveWith(&solver, problem, options);
    EXPECT_EQ(result.iterations, limit);
    EXPECT_TRUE(result.f.allFinite());
    if (limit + 1 == whole.iterations && result.status == LcpStatus::kSolved) {
      ExpectSolved(problem, result);  // what the last iteration would only confirm may be accepted without it
    } else {
      EXPECT_EQ(result.status, LcpStatus::kIterationLimit) << limit;
    }
  }
}

double ticks = 0;

TEST(Hybrid, TheDeadlineHoldsForBothPhasesTogether) {
  const LcpProblem problem = Column(kRows, 4);
  HybridSolver solver = WithFewSweeps();
  SolveWith(&solver, problem);
  LcpOptions options;
  ticks = 0;
  options.now = [] { return ticks += 1.0; };
  options.time_limit_s = 1e9;
  ExpectSolved(problem, SolveWith(&solver, problem, options));
  const double looks = ticks;
  for (double limit = 1; limit < looks / 2; limit *= 1.5) {
    ticks = 0;
    options.time_limit_s = limit;
    const LcpResult result = SolveWith(&solver, problem, options);
    EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << limit;
    EXPECT_TRUE(result.f.allFinite());
  }
}

TEST(Hybrid, AnAnswerIsAcceptedAtOnce) {
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    HybridSolver solver;
    const LcpProblem problem = generate(kRows, 5);
    const LcpResult cold = SolveWith(&solver, problem);
    ExpectSolved(problem, cold);
    LcpOptions options;
    options.initial_f = &cold.f;
    const LcpResult warm = SolveWith(&solver, problem, options);
    ExpectSolved(problem, warm);
    EXPECT_EQ(warm.iterations, 0);
  }
}

// In factorisations, but for the one that tries the active set of the start; how many sweeps go before depends on when
// their rate shows that they will not do.
TEST(Hybrid, ASmallDriftTakesNoMoreFactorisationsThanACold) {
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      HybridSolver solver;
      const LcpProblem before = generate(kRows, seed);
      const Eigen::VectorXd f = SolveWith(&solver, before).f;
      const LcpProblem after =
          LcpProblem::FromFactors("after", before.J(), 1.01 * before.inverse_mass(), 0.995 * before.b());
      SolveWith(&solver, after);
      const auto cold = std::max(solver.statistics().factorizations, decltype(IpmStatistics::factorizations){1});
      LcpOptions options;
      options.initial_f = &f;
      const LcpResult warm = SolveWith(&solver, after, options);
      ExpectSolved(after, warm);
      EXPECT_LE(solver.statistics().factorizations, cold);
    }
  }
}

// As many iterations as without it, and the same bits.
TEST(Hybrid, AStartThatIsNoBetterThanNothingIsPassedOver) {
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (const double size : {1.0, 1e6}) {
      HybridSolver solver;
      const LcpProblem problem = generate(kRows, 6);
      const LcpResult cold = SolveWith(&solver, problem);
      const Eigen::VectorXd start = Eigen::VectorXd::Constant(kRows, size * problem.b().cwiseAbs().maxCoeff());
      LcpOptions options;
      options.initial_f = &start;
      const LcpResult warm = SolveWith(&solver, problem, options);
      EXPECT_EQ(warm.iterations, cold.iterations);
      EXPECT_EQ(warm.f, cold.f);
    }
  }
}

TEST(Hybrid, InfeasibleProblemsComeWithAnAcceptedRay) {
  HybridSolver solver;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const LcpProblem jam = JammedColumn(kRows, seed);
    const Eigen::VectorXd start = Eigen::VectorXd::Ones(jam.size());
    for (const Eigen::VectorXd* initial_f : {static_cast<const Eigen::VectorXd*>(nullptr), &start}) {
      LcpOptions options;
      options.initial_f = initial_f;
      ExpectRay(jam, SolveWith(&solver, jam, options));
    }
  }
}

}  // namespace
}  // namespace lcpbench
