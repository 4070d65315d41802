// How often own solvers look at the clock, counted with a clock of ours: often enough for a time limit to be kept
// within 10 % or 20 us (campaigns on sequences measure that), and once is enough for them to end.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

constexpr double kTolerance = 1e-9;
constexpr Index kRows = 300;

// Reads are counted; from read `expires_at` on, time is up.
std::int64_t reads;
std::int64_t expires_at;
double CountingClock() { return ++reads >= expires_at ? 2.0 : 0.0; }

class ClockTest : public SolverTest {
 protected:
  LcpResult Solve(const LcpProblem& problem, std::int64_t expires) {
    reads = 0;
    expires_at = expires;
    return SolverTest::Solve(problem, {.tolerance = kTolerance, .time_limit_s = 1, .now = &CountingClock});
  }
};

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

TEST_P(ClockTest, IsReadForEveryUnitOfWork) {
  const LcpProblem problem = PlantedProblem(kRows, 150, 1, 0, 0).problem;
  const LcpResult result = Solve(problem, kNever);
  if (result.status == LcpStatus::kUnsupported) return;
  // An iteration of the first-order methods is one product with A, of which there are some hundred in 20 us where n is
  // small; of the others at least a factorization or, with a dense factor, n^2 numbers.
  const auto work = static_cast<double>(result.iterations) * static_cast<double>(problem.SparseA().nonZeros());
  constexpr double kMostWorkPerRead = 1 << 16;
  EXPECT_GE(static_cast<double>(reads), work / kMostWorkPerRead) << result.iterations << " iterations";
  EXPECT_GE(reads, 2);
}

TEST_P(ClockTest, EndsTheSolveSoonAfterItHasRunOut) {
  constexpr std::int64_t kMoreReads = 8;
  constexpr std::int64_t kPoints = 10;
  // The first reads say when the solve, and a solve within it, began.
  constexpr std::int64_t kFirstRead = 5;
  for (const int degenerate : {0, 3}) {
    const TestProblem test = PlantedProblem(kRows, degenerate == 0 ? 150 : 60, 2, 7, degenerate);
    Solve(test.problem, kNever);
    const std::int64_t all = reads;
    for (std::int64_t expires = kFirstRead; expires < all; expires += 1 + all / kPoints) {
      const LcpResult result = Solve(test.problem, expires);
      EXPECT_LE(reads, expires + kMoreReads) << "expired at read " << expires << " of " << all;
      EXPECT_FALSE(Verify(test.problem, result, kTolerance, &test.reference).false_success);
      if (result.status != LcpStatus::kSolved) {
        EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << expires << " of " << all << ": " << result.detail;
      }
      EXPECT_TRUE(result.f.allFinite());
    }
  }
}

TEST_P(ClockTest, FactorizationsAreTimedWhereThatIsAskedFor) {
  const LcpProblem problem = PlantedProblem(kRows, 150, 1, 0, 0).problem;
  const LcpResult plain = SolverTest::Solve(problem, kTolerance);
  if (plain.status == LcpStatus::kUnsupported) return;
  EXPECT_LT(plain.factor_s, 0);
  const double start = SteadyNow();
  const LcpResult timed = SolverTest::Solve(problem, {.tolerance = kTolerance, .time_factorizations = true});
  const double solve_s = SteadyNow() - start;
  EXPECT_LE(timed.factor_s, solve_s);
  EXPECT_TRUE((timed.f.array() == plain.f.array()).all());
  // Sweeps and gradients factorize nothing; what begins with whole factors does.
  const std::string& key = GetParam().key;
  // Ipopt does not say.
  if (key == "ipopt-qp" || key == "ipopt-ncp") {
    EXPECT_LT(timed.factor_s, 0);
    return;
  }
  EXPECT_GE(timed.factor_s, 0);
  const bool first_order = key == "pgs" || key == "psor" || key == "nncg" || key == "apgd";
  if (first_order) {
    EXPECT_EQ(timed.factor_s, 0);
  }
  if (key == "ipm" || key == "bpp" || key == "active-set" || key == "semismooth-newton") {
    EXPECT_GT(timed.factor_s, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Own, ClockTest, testing::ValuesIn(PlainSolversOf(SolverOrigin::kOwn)), SolverTestName);

}  // namespace
}  // namespace lcpbench
