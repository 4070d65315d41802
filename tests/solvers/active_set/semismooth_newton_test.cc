// What is particular to the proximal semismooth Newton method: few factorisations where block pivoting cycles, forces
// that stay positive on redundant contacts, the clock. What it shares with the other direct solvers is in
// direct_solvers_test.cc, the contract of all solvers in contract_test.cc.

#include "solvers/active_set/semismooth_newton.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "support/input_error.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

LcpResult SolveWith(const LcpProblem& problem, const LcpOptions& options = {}, SemismoothNewtonOptions own = {}) {
  SemismoothNewtonSolver solver(own);
  return SolveWith(&solver, problem, options);
}

// Unit masses in a row pushed along it by random loads: what one of them does reaches far, which makes plain exchange
// of all wrong rows cycle.
LcpProblem Chain(int n, unsigned seed) {
  std::vector<Eigen::Triplet<double, int>> entries;
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(Index{3} * n);
  std::mt19937_64 random(seed);
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, 3 * k, 1.0);
    if (k > 0) entries.emplace_back(k, 3 * (k - 1), -1.0);
    acceleration[Index{3} * k] = -1 + 16 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
  }
  SparseMatrix J(n, 3 * n);
  J.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromFactors("chain-" + std::to_string(n), J, Eigen::VectorXd::Ones(Index{3} * n),
                                 J * acceleration);
}

TEST(SemismoothNewton, NeedsFewFactorisationsOnLongChains) {
  for (const int n : {100, 1000, 10000}) {
    const LcpProblem problem = Chain(n, 5);
    const LcpResult result = SolveWith(problem);
    ExpectSolved(problem, result);
    // Continuation, from 2000 rows on, takes more but shorter ways.
    EXPECT_LT(result.iterations, n < SemismoothNewtonOptions().continuation_rows ? 60 : 120) << n;
  }
}

TEST(SemismoothNewton, WeightsChangeThePathAndNotTheAnswer) {
  for (const TestProblem& test : GeneratedProblems()) {
    if (test.reference.status != LcpReference::Status::kSolved) continue;
    for (const double first : {1.0, 1e-2, 1e-6}) {
      SemismoothNewtonOptions own;
      own.first_weight = first;
      const LcpResult result = SolveWith(test.problem, {}, own);
      SCOPED_TRACE(first);
      ExpectSolved(test.problem, result);
    }
  }
}

TEST(SemismoothNewton, ForcesOnRedundantContactsArePositiveWhereTheyCanBe) {
  // A bar on k supports in line: rank 2, and every split of its weight is a solution. The proximal one is spread.
  for (const int k : {3, 5, 20}) {
    std::vector<Eigen::Triplet<double, int>> entries;
    for (int i = 0; i < k; ++i) {
      entries.emplace_back(i, 1, 1.0);
      entries.emplace_back(i, 2, -1 + 2.0 * i / (k - 1));
    }
    SparseMatrix J(k, 3);
    J.setFromTriplets(entries.begin(), entries.end());
    const LcpProblem problem =
        LcpProblem::FromFactors("bar", J, Eigen::Vector3d(1, 1, 3), Eigen::VectorXd::Constant(k, -9.81));
    const LcpResult result = SolveWith(problem);
    ExpectSolved(problem, result);
    EXPECT_GT(result.f.minCoeff(), 0);
    EXPECT_NEAR(result.f.sum(), 9.81, 1e-9);
  }
}

// What b says of dependent rows contradicts itself by rounding, so that no f solves the problem exactly and the nearest
// ones differ by large multiples of the null space.
TEST(SemismoothNewton, SolvesWhatIsConsistentUpToRoundingOnly) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
    const int supports = 3 + static_cast<int>(seed % 8);
    std::vector<Eigen::Triplet<double, int>> entries;
    Eigen::VectorXd b(supports);
    for (int i = 0; i < supports; ++i) {
      const double arm = i < 2 ? 2.0 * i - 1 : uniform();
      entries.emplace_back(i, 1, 1.0);
      entries.emplace_back(i, 2, arm);
      b[i] = -9.81 + 3 * arm + 1e-13 * uniform();
    }
    SparseMatrix J(supports, 3);
    J.setFromTriplets(entries.begin(), entries.end());
    const LcpProblem problem = LcpProblem::FromFactors("bar-" + std::to_string(seed), J, Eigen::Vector3d(1, 1, 3), b);
    ExpectSolved(problem, SolveWith(problem));
  }
}

double clock_now = 0;
double CountingClock() { return clock_now += 1; }

TEST(SemismoothNewton, ReadsTheClockWithinAFactorisation) {
  const LcpProblem problem = Chain(200, 1);
  LcpOptions options;
  options.now = &CountingClock;
  for (const double limit : {0.5, 3.0, 7.0}) {
    clock_now = 0;
    options.time_limit_s = limit;
    const LcpResult result = SolveWith(problem, options);
    EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << limit;
    EXPECT_LE(clock_now, limit + 3) << "every read of the clock counts one, and the limit must end it at once";
    EXPECT_TRUE(result.f.allFinite());
  }
}

TEST(SemismoothNewton, RefusesWhatMakesNoSense) {
  EXPECT_THROW(SemismoothNewtonSolver({.first_weight = 0}), InputError);
  EXPECT_THROW(SemismoothNewtonSolver({.least_weight = 1e-11}), InputError);
  EXPECT_THROW(SemismoothNewtonOptions::FromSettings({{"first_weight", "2"}}), InputError);
  EXPECT_THROW(SemismoothNewtonOptions::FromSettings({{"weight", "1"}}), InputError);
}

}  // namespace
}  // namespace lcpbench
