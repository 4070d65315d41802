// The passes that first-order solvers are made of.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "solvers/first_order/pgs.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/rows/row_input.h"
#include "tests/solvers/first_order/first_order_runs.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// At f = 0.
void LayOut(const LcpProblem& problem, RowForm form, bool coloured, std::initializer_list<RowWork*> works) {
  TwoBodyCopy copy;
  ASSERT_TRUE(copy.Take(problem.view()));
  for (RowWork* work : works) {
    work->Prepare(problem, form, coloured, &copy.rows());
    work->Start(problem.b().data(), nullptr);
  }
}

// Two-body rows on many bodies, so that colours have many rows; every 7th row bilateral if asked for.
TestProblem Wide(Index n, unsigned seed, int bilateral_every) {
  return PlantedProblem(n, static_cast<int>(n / 2), seed, bilateral_every, 0);
}

std::vector<TestProblem> Problems() {
  std::vector<TestProblem> problems = GeneratedProblems();
  for (unsigned seed = 1; seed <= 4; ++seed) problems.push_back(Wide(150, seed, seed % 2 == 0 ? 7 : 0));
  return problems;
}

LcpResult Iterate(const LcpProblem& problem, RowForm form, SweepOrder sweep, std::int64_t sweeps, double omega = 1) {
  return IterateNew<PgsSolver>(problem, {.form = form, .sweep = sweep, .relaxation = omega}, 1e-15, sweeps);
}

TEST(Sweeps, ColouredSweepsAreForwardSweepsOfPermutedRowsBitForBit) {
  for (const RowForm form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    for (const TestProblem& test : Problems()) {
      const LcpProblem& problem = test.problem;
      RowWork work;
      LayOut(problem, form, true, {&work});
      const std::vector<Index>& order = work.scaled.order;
      const LcpProblem permuted = RowsOf(problem, order);
      for (const double omega : {1.0, 1.7}) {
        const LcpResult coloured = Iterate(problem, form, SweepOrder::kColoured, 9, omega);
        const LcpResult forward = Iterate(permuted, form, SweepOrder::kForward, 9, omega);
        if (coloured.iterations != 9 || forward.iterations != 9) continue;  // solved in the meantime
        for (Index k = 0; k < problem.size(); ++k) {
          EXPECT_EQ(forward.f[k], coloured.f[order[static_cast<size_t>(k)]]) << problem.id() << " row " << k;
        }
      }
    }
  }
}

TEST(Sweeps, SymmetricSweepsOfAReversedProblemStartBackwards) {
  // Two sweeps there and back; the reversed problem's first sweep is the given one's second.
  const TestProblem test = PlantedProblem(20, 12, 3, 0, 0);
  std::vector<Index> reverse = EveryRow(20);
  std::reverse(reverse.begin(), reverse.end());
  const LcpResult there = Iterate(test.problem, RowForm::kMatrixFree, SweepOrder::kForward, 1);
  const LcpResult both = Iterate(test.problem, RowForm::kMatrixFree, SweepOrder::kSymmetric, 2);
  const Eigen::VectorXd start = there.f.reverse();
  const LcpResult back = IterateNew<PgsSolver>(
      RowsOf(test.problem, reverse), {.form = RowForm::kMatrixFree, .sweep = SweepOrder::kForward}, 1e-15, 1, &start);
  const double size = both.f.cwiseAbs().maxCoeff();
  EXPECT_LE((back.f.reverse() - both.f).cwiseAbs().maxCoeff(), 1e-12 * size);
  EXPECT_GT((there.f - both.f).cwiseAbs().maxCoeff(), 1e-3 * size);
}

// Rows on two of many bodies each, in sets of a few hundred that share none.
LcpProblem Loose(Index p, Index n, int bilateral_every) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Index bodies = n;
  std::uniform_int_distribution<Index> any(0, bodies - 1);
  Triplets entries;
  std::vector<Index> bilateral;
  for (Index row = 0; row < n; ++row) {
    if (bilateral_every > 0 && row % bilateral_every == 0) bilateral.push_back(row);
    const Index first = any(random);
    const Index second = any(random);
    for (Index k = 0; k < p; ++k) {
      entries.emplace_back(static_cast<int>(row), static_cast<int>(p * first + k), uniform(random));
      if (row % 5 == 0 || second == first) continue;  // on one body
      entries.emplace_back(static_cast<int>(row), static_cast<int>(p * second + k), uniform(random));
    }
  }
  const auto draw = [&](Index) { return uniform(random); };
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, draw);
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::NullaryExpr(p * bodies, draw).cwiseAbs();
  MatrixFacts facts;
  facts.columns_per_body = static_cast<int>(p);
  return LcpProblem::FromFactors("loose", MatrixOf(n, p * bodies, entries), inverse_mass, b,
                                 RowBounds::WithBilateralRows(n, bilateral), facts);
}

// Sweeps, a gradient step and residuals from f = 0, of all rows at once and row by row.
void ExpectTheSameBits(Index n, RowWork* together, RowWork* alone) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); };
  for (const bool backward : {false, true, false}) {
    StepSums sums;
    StepSums sums_alone;
    together->rows->Sweep(0, n, backward, 0.9, &together->x, &sums);
    for (Index i = 0; i < n; ++i) {
      const Index k = backward ? n - 1 - i : i;
      alone->rows->Sweep(k, k + 1, backward, 0.9, &alone->x, &sums_alone);
    }
    EXPECT_EQ(together->x.f, alone->x.f) << n;
    EXPECT_EQ(together->x.image, alone->x.image) << n;
    EXPECT_TRUE(near(sums.residual, sums_alone.residual)) << n;
    EXPECT_TRUE(near(sums.change, sums_alone.change)) << n;
    EXPECT_TRUE(near(sums.energy, sums_alone.energy)) << n;
  }
  Point next = together->x;
  together->rows->StartImage(&next.image);
  Point next_alone = next;
  StepSums sums;
  together->rows->GradientStep(0, n, 0.2, together->x, &next, &sums);
  double residual = 0;
  for (Index k = 0; k < n; ++k) {
    alone->rows->GradientStep(k, k + 1, 0.2, alone->x, &next_alone, &sums);
    residual += alone->rows->ResidualSquares(k, k + 1, alone->x, nullptr);
  }
  EXPECT_EQ(next.f, next_alone.f) << n;
  EXPECT_EQ(next.image, next_alone.image) << n;
  EXPECT_TRUE(near(together->rows->ResidualSquares(0, n, together->x, nullptr), residual)) << n;
}

// The last size is one that fetches rows ahead.
class InPlaneAndSpace : public ::testing::TestWithParam<int> {};

TEST_P(InPlaneAndSpace, RowsAloneAndTogetherGiveTheSameBitsByEveryInstructionSet) {
  for (const Index n : {Index{37}, Index{1000}, Index{70'000}}) {
    for (const int bilateral_every : {0, 9}) {
      const LcpProblem problem = Loose(GetParam(), n, bilateral_every);
      RowWork together;
      RowWork alone;
      LayOut(problem, RowForm::kMatrixFree, true, {&together, &alone});
      for (const InstructionSet set : AvailableInstructionSets()) {
        std::vector<std::unique_ptr<RowKernel>> kernels;
        for (RowWork* work : {&together, &alone}) {
          kernels.push_back(MakeTwoBodyRows(work->scaled, GetParam(), true, &work->two_body_rows, set));
          work->rows = kernels.back().get();
          work->Start(problem.b().data(), nullptr);
          work->rows->StartImage(&work->x.image);
        }
        ExpectTheSameBits(n, &together, &alone);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sweeps, InPlaneAndSpace, ::testing::Values(3, 6));

TEST(Sweeps, EnergyFallsByWhatTheSweepSays) {
  for (const RowForm form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    for (const TestProblem& test : Problems()) {
      RowWork work;
      LayOut(test.problem, form, true, {&work});
      const Index n = test.problem.size();
      Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
      // The scaled problem's energy is the given one's over the square of the scale of b.
      const double unit = work.scaled.unit[0] / work.scaled.inverse_root[0];
      double energy = 0;
      double lowest = 0;
      for (int sweep = 0; sweep < 12; ++sweep) {
        const double omega = 0.3 + 0.14 * sweep;  // up to 1.84
        StepSums sums;
        work.rows->Sweep(0, n, sweep % 3 == 2, omega, &work.x, &sums);
        EXPECT_LE(sums.energy, 0) << test.problem.id();
        work.scaled.ToGiven(work.x.f, f.data());
        const double next = Energy(test.problem, f) / (unit * unit);
        lowest = std::min(lowest, next);
        EXPECT_NEAR(next - energy, sums.energy, 1e-12 * (1 + std::abs(lowest))) << test.problem.id();
        energy = next;
      }
    }
  }
}

TEST(Sweeps, ImagesGiveTheProductsOfA) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const RowForm form : {RowForm::kAssembled, RowForm::kMatrixFree}) {
    for (const TestProblem& test : Problems()) {
      RowWork work;
      LayOut(test.problem, form, true, {&work});
      const Index n = test.problem.size();
      for (double& value : work.x.f) value = uniform(random);
      work.rows->StartImage(&work.x.image);
      work.rows->AddToImage(0, n, &work.x);
      Eigen::VectorXd given = Eigen::VectorXd::Zero(n);
      work.scaled.ToGiven(work.x.f, given.data());
      Eigen::VectorXd w;
      test.problem.ComputeW(given, &w);
      // w_k of the given problem per w_k of the scaled one: scale of b over inverse_root.
      const double scale = work.scaled.unit[0] / work.scaled.inverse_root[0];
      for (Index k = 0; k < n; ++k) {
        const double expected = w[work.scaled.Given(k)] * work.scaled.inverse_root[k] / scale;
        EXPECT_NEAR(work.rows->W(k, work.x), expected, 1e-11) << test.problem.id();
      }
      Array moved = work.x.image;
      work.rows->AddRowToImage(n / 2, 0.25, &moved);
      work.x.f[n / 2] += 0.25;
      work.rows->StartImage(&work.x.image);
      work.rows->AddToImage(0, n, &work.x);
      EXPECT_LE((moved - work.x.image).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace lcpbench
