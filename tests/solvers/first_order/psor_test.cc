#include "solvers/first_order/psor.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "solvers/first_order/pgs.h"
#include "support/input_error.h"
#include "tests/solvers/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// Blocks in a row, each pushed onto the next: every row couples two bodies, all pressed.
LcpProblem PressedChain(Index n) {
  SparseMatrix J(n, 3 * (n + 1));
  for (Index i = 0; i < n; ++i) {
    J.insert(i, 3 * i) = -1;
    J.insert(i, 3 * i + 3) = 1;
  }
  Eigen::VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = i % 5 == 3 ? 0.5 : -1;
  return LcpProblem::FromFactors("pressed-chain", J, Eigen::VectorXd::Ones(3 * (n + 1)), b);
}

TEST(Psor, EnergyNeverRisesWhateverRelaxationItFinds) {
  int compared = 0;
  for (const SweepOrder order : {SweepOrder::kForward, SweepOrder::kSymmetric, SweepOrder::kColoured}) {
    for (const double first : {0.4, 1.6, 1.95}) {
      PsorOptions options;
      options.sweep = order;
      options.first_relaxation = first;
      PsorSolver solver(options);
      for (const LcpProblem& problem : {PressedChain(60), PlantedProblem(40, 20, 2, 5, 0).problem}) {
        double energy = 0;
        for (const std::int64_t sweeps : {1, 2, 3, 5, 8, 10, 11, 12, 15, 20, 22, 25, 30}) {
          const LcpResult result = Iterate(&solver, problem, 1e-15, sweeps);
          // The start is returned where its residual is less than that of the last iterate.
          if (result.f.isZero(0)) continue;
          ++compared;
          const double next = Energy(problem, result.f);
          EXPECT_LE(next, energy + 1e-12 * std::abs(energy)) << problem.id() << ", " << sweeps << " sweeps";
          energy = next;
        }
      }
    }
  }
  EXPECT_GE(compared, 150);
}

TEST(Psor, TakesAFifthOfTheSweepsOfGaussSeidelOnAChain) {
  const LcpProblem chain = PressedChain(60);
  PgsSolver pgs;
  PsorSolver psor;
  const LcpResult plain = Iterate(&pgs, chain, 1e-9, 0);
  const LcpResult relaxed = Iterate(&psor, chain, 1e-9, 0);
  EXPECT_EQ(plain.status, LcpStatus::kSolved);
  EXPECT_EQ(relaxed.status, LcpStatus::kSolved);
  EXPECT_LE(5 * relaxed.iterations, plain.iterations) << relaxed.iterations << " of " << plain.iterations;
}

TEST(Psor, OptionsOutOfRangeAreRefused) {
  for (const char* relaxation : {"0", "2", "-1", "nan", "fast"}) {
    EXPECT_THROW(PsorOptions::FromSettings({{"first-relaxation", relaxation}}), InputError) << relaxation;
  }
  EXPECT_THROW(PsorOptions::FromSettings({{"sweep", "random"}}), InputError);
  EXPECT_EQ(PsorOptions::FromSettings({{"sweep", "symmetric"}}).sweep, SweepOrder::kSymmetric);
}

}  // namespace
}  // namespace lcpbench
