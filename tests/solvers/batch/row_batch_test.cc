#include "solvers/batch/row_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/batch/extended_check.h"
#include "solvers/lcp/verify.h"
#include "solvers/step/step_solver.h"
#include "tests/solvers/io/read_lcp_file.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/step/random_step.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

constexpr double kTolerance = 1e-9;

// Problems behind each other, each with bodies of its own.
struct Batch : StepArrays {
  bool single;
  std::vector<std::int32_t> start{0};

  Batch(int p, bool is_single) : single(is_single) { columns_per_body = p; }

  std::size_t size() const { return start.size() - 1; }
  StepRows Rows() {
    Round();
    return View(single);
  }
  LcpProblem Problem(std::size_t k) { return ProblemOf(PartOf(Rows(), start[k], start[k + 1])); }

  void AddProblem(const StepArrays& problem) {
    Append(problem);
    start.push_back(static_cast<std::int32_t>(rows()));
  }
  // With few bodies or many.
  void AddRandom(int n, unsigned seed) {
    const auto bodies = static_cast<Index>(2 + std::mt19937(seed)() % static_cast<unsigned>(2 + (n / 2)));
    AddProblem(RandomStep(n, bodies, columns_per_body, seed, true));
  }
  // Rows that share no body.
  void AddApart(int n) {
    StepArrays apart;
    apart.columns_per_body = columns_per_body;
    apart.inverse_mass.assign(static_cast<std::size_t>(n * columns_per_body), 1.0);
    std::vector<double> numbers(static_cast<std::size_t>(2 * columns_per_body), 0.0);
    numbers[0] = 1;
    for (int i = 0; i < n; ++i) apart.Add(i, -1, numbers, std::sin(i));
    AddProblem(apart);
  }
};

struct Answers {
  std::vector<double> f;
  std::vector<StepAnswer> of;
  std::int64_t left = 0;
};

Answers SolveBatch(StepSolver* solver, Batch* batch) {
  Answers answers{std::vector<double>(batch->b.size(), -1), std::vector<StepAnswer>(batch->size())};
  solver->SolveBatch(batch->Rows(), batch->start, answers.f.data(), answers.of);
  answers.left = solver->left();
  return answers;
}

Answers SolveBatch(InstructionSet instructions, Batch* batch) {
  StepSolver solver({.instructions = instructions});
  return SolveBatch(&solver, batch);
}

Eigen::VectorXd ForcesOf(const Answers& answers, const Batch& batch, std::size_t k) {
  return Eigen::Map<const Eigen::VectorXd>(answers.f.data() + batch.start[k], batch.start[k + 1] - batch.start[k]);
}

// Solved wherever one after another solves, and right by the verifier, whose w is that of one after another.
void ExpectAsOneByOne(const Answers& answers, Batch* batch) {
  StepSolver solver;
  const StepRows rows = batch->Rows();
  for (std::size_t k = 0; k < batch->size(); ++k) {
    const Index n = batch->start[k + 1] - batch->start[k];
    Eigen::VectorXd f(n);
    Eigen::VectorXd w(n);
    const StepAnswer expected =
        solver.Solve(PartOf(rows, batch->start[k], batch->start[k + 1]), nullptr, f.data(), w.data());
    EXPECT_EQ(answers.of[k].status, expected.status) << k;
    if (answers.of[k].status != LcpStatus::kSolved) continue;
    EXPECT_LE(answers.of[k].rho, 4 * kTolerance);
    EXPECT_GE(answers.of[k].iterations, 0);
    const LcpProblem problem = batch->Problem(k);
    const Verdict verdict = Verify(problem, Claim(ForcesOf(answers, *batch, k)), kTolerance);
    EXPECT_TRUE(verdict.passes) << "problem " << k << ", rows " << n << ", rho " << verdict.metrics.rho;
    const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt().unaryExpr([](double d) { return d > 0 ? d : 1.0; });
    EXPECT_LE((verdict.metrics.w - w).cwiseQuotient(root).norm(), 1e-6 * (1 + problem.b().cwiseQuotient(root).norm()));
  }
}

class RowBatchTest : public testing::TestWithParam<InstructionSet> {};

TEST_P(RowBatchTest, AnswersAsOneByOneInAllSizesAndForms) {
  for (const int p : {3, 6}) {
    for (const bool single : {false, true}) {
      Batch batch(p, single);
      for (unsigned seed = 0; seed < 335; ++seed) batch.AddRandom(static_cast<int>(seed * 7 % 67), seed);
      const Answers answers = SolveBatch(GetParam(), &batch);
      ExpectAsOneByOne(answers, &batch);
      // Sizes of 67 that are not for lanes; what passes everything on has nothing to test here.
      const int others = GetParam() == InstructionSet::kAvx512 ? 3 : 35;
      EXPECT_LE(answers.left, others * 5 + 20) << p;
    }
  }
}

TEST_P(RowBatchTest, AnswersAsOneByOneOnScenes) {
  Batch batch(3, false);
  for (const SceneFamily& family : AllScenes()) {
    for (int n = 1; n <= 24; ++n) batch.AddProblem(StepArrays::Of(AssembleContactLcp(family.generate(n, 7)).problem));
  }
  const Answers answers = SolveBatch(GetParam(), &batch);
  ExpectAsOneByOne(answers, &batch);
  EXPECT_LE(answers.left, static_cast<std::int64_t>(batch.size()) / 50);
}

TEST_P(RowBatchTest, BitsDoNotDependOnNeighbours) {
  Batch batch(3, false);
  for (unsigned seed = 0; seed < 300; ++seed) batch.AddRandom(1 + static_cast<int>(seed * 5 % 64), seed);
  StepSolver solver({.instructions = GetParam()});
  const Answers expected = SolveBatch(&solver, &batch);
  Batch turned(3, false);
  for (unsigned seed = 300; seed > 0; --seed) turned.AddRandom(1 + static_cast<int>((seed - 1) * 5 % 64), seed - 1);
  const Answers answers = SolveBatch(&solver, &turned);
  for (std::size_t k = 0; k < batch.size(); ++k) {
    Batch alone(3, false);
    alone.AddRandom(1 + static_cast<int>(k * 5 % 64), static_cast<unsigned>(k));
    const Eigen::VectorXd f = ForcesOf(expected, batch, k);
    EXPECT_TRUE(SameBits(ForcesOf(answers, turned, batch.size() - 1 - k), f)) << k;
    EXPECT_TRUE(SameBits(ForcesOf(SolveBatch(&solver, &alone), alone, 0), f)) << k;
    EXPECT_EQ(answers.of[batch.size() - 1 - k].iterations, expected.of[k].iterations);
  }
}

TEST_P(RowBatchTest, DoesNotAllocateAfterReserve) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted here";
  CountAllocations(true);
  for (const int p : {3, 6}) {
    Batch batch(p, false);
    StepSolver trial({.instructions = GetParam()});
    for (unsigned seed = 0; seed < 1000; ++seed) {
      // Those that AutoSolver's backends are asked for may allocate.
      Batch alone(p, false);
      alone.AddRandom(1 + static_cast<int>(seed % 64), seed);
      const std::int64_t before = trial.fallbacks();
      SolveBatch(&trial, &alone);
      if (trial.fallbacks() == before) batch.AddRandom(1 + static_cast<int>(seed % 64), seed);
    }
    EXPECT_GT(batch.size(), 950U);
    for (int n = 65; n < 75; ++n) batch.AddApart(n);  // not for lanes
    StepSolver solver({.instructions = GetParam()});
    solver.Reserve(75, 150);
    const StepRows rows = batch.Rows();
    std::vector<double> f(batch.b.size());
    std::vector<StepAnswer> answers(batch.size());
    const long before = AllocationCount();
    solver.SolveBatch(rows, batch.start, f.data(), answers);
    EXPECT_EQ(AllocationCount(), before);
    EXPECT_EQ(solver.fallbacks(), 0);
    EXPECT_GE(solver.left(), 10);
  }
}

TEST_P(RowBatchTest, RefusesBadInputByItsPlaceAmongAllRows) {
  StepSolver solver({.instructions = GetParam()});
  Batch batch(3, false);
  for (unsigned seed = 0; seed < 40; ++seed) batch.AddRandom(4, seed);
  const double infinity = std::numeric_limits<double>::infinity();
  const auto expect_refused = [&](const std::string& text) {
    ExpectRefused([&] { SolveBatch(&solver, &batch); }, text);
  };
  for (const double bad : {std::nan(""), infinity, -infinity}) {
    for (double* number : {&batch.J[6 * 77 + 4], &batch.b[77]}) {
      const double good = std::exchange(*number, bad);
      expect_refused("row 77");
      *number = good;
    }
  }
  const auto used = std::find_if(batch.body.begin() + 200, batch.body.end(), [](std::int32_t k) { return k >= 0; });
  for (const double bad : {std::nan(""), infinity, -1.0}) {
    double& number = batch.inverse_mass[(3 * static_cast<std::size_t>(*used)) + 2];
    const double good = std::exchange(number, bad);
    expect_refused("body " + std::to_string(*used));
    number = good;
  }
  for (const std::int32_t bad : {-2, static_cast<std::int32_t>(batch.inverse_mass.size() / 3), 2'000'000'000}) {
    const std::int32_t good = std::exchange(batch.body[2 * 77 + 1], bad);
    expect_refused("row 77");
    batch.body[2 * 77 + 1] = good;
  }
  batch.start[5] = 100;
  expect_refused("start");
  batch.start[5] = 20;
  ExpectAsOneByOne(SolveBatch(&solver, &batch), &batch);
}

// Numbers that leave the range which lanes are made for are left to Solve, not answered wrongly.
TEST_P(RowBatchTest, ClaimsNothingWrongOfExtremeNumbers) {
  StepSolver solver({.instructions = GetParam()});
  int solved = 0;
  for (int power = -500; power <= 500; power += 20) {
    Batch batch(3, false);
    for (unsigned seed = 0; seed < 10; ++seed) batch.AddRandom(1 + static_cast<int>(seed), seed);
    for (double& j : batch.J) j = std::ldexp(j, power);
    for (double& b : batch.b) b = std::ldexp(b, power);
    const Answers answers = SolveBatch(&solver, &batch);
    for (std::size_t k = 0; k < batch.size(); ++k) {
      if (answers.of[k].status != LcpStatus::kSolved) continue;
      ++solved;
      EXPECT_TRUE(Verify(batch.Problem(k), Claim(ForcesOf(answers, batch, k)), kTolerance).passes)
          << k << ", " << power;
    }
  }
  EXPECT_GT(solved, 200);
}

// Rounding of A may be all that is left of a row: then it says nothing of the row's backward error.
TEST_P(RowBatchTest, ClaimsNothingWrongOfRowsWhoseTermsCancel) {
  Batch batch(6, false);
  for (const LcpProblem& problem : ReportedProblems("terms-that-cancel")) {
    const StepArrays recorded = StepArrays::Of(problem);
    std::mt19937 engine(1);
    for (int k = 0; k < 50; ++k) {
      StepArrays turned = recorded;
      for (double& b : turned.b) b *= k == 0 ? 1 : 1 + std::uniform_real_distribution<double>(0, 1)(engine);
      batch.AddProblem(turned);
    }
  }
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    StepSolver solver({.tolerance = tolerance, .instructions = GetParam()});
    const Answers answers = SolveBatch(&solver, &batch);
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const LcpResult result = Claim(ForcesOf(answers, batch, k), answers.of[k].status);
      EXPECT_FALSE(Verify(batch.Problem(k), result, tolerance).false_success) << k << " at " << tolerance;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Machine, RowBatchTest, testing::ValuesIn(AvailableInstructionSets()),
                         [](const auto& test) { return std::string(ToString(test.param)); });

TEST(RowBatch, Avx2AndAvx512GiveTheSameBitsOfFewRows) {
  if (AvailableInstructionSets().back() != InstructionSet::kAvx512) GTEST_SKIP() << "no AVX-512 here";
  for (const int p : {3, 6}) {
    Batch batch(p, false);
    for (unsigned seed = 0; seed < 500; ++seed) batch.AddRandom(1 + static_cast<int>(seed % 12), seed);
    const Answers wide = SolveBatch(InstructionSet::kAvx512, &batch);
    const Answers narrow = SolveBatch(InstructionSet::kAvx2, &batch);
    std::int64_t different = 0;
    for (std::size_t k = 0; k < batch.size(); ++k) {
      different += SameBits(ForcesOf(wide, batch, k), ForcesOf(narrow, batch, k)) ? 0 : 1;
    }
    EXPECT_LE(different, wide.left) << "but those that lanes leave, whose sums go another way";
    EXPECT_EQ(wide.left, narrow.left);
  }
}

TEST(RowBatch, GivesTheSameBitsOnAnyNumberOfThreads) {
  Batch batch(3, false);
  for (unsigned seed = 0; seed < 5000; ++seed)
    batch.AddRandom(static_cast<int>(seed * 5 % (seed % 9 == 0 ? 67 : 9)), seed);
  StepSolver alone;
  const Answers expected = SolveBatch(&alone, &batch);
  EXPECT_GT(alone.left(), 0);
  for (const int threads : {2, 3, 8}) {
    StepSolver solver({.threads = threads});
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Answers answers = SolveBatch(&solver, &batch);
      EXPECT_EQ(answers.left, expected.left);
      EXPECT_EQ(answers.f, expected.f);
      for (std::size_t k = 0; k < batch.size(); ++k) {
        EXPECT_EQ(answers.of[k].status, expected.of[k].status);
        EXPECT_EQ(answers.of[k].iterations, expected.of[k].iterations);
        EXPECT_EQ(answers.of[k].rho, expected.of[k].rho);
      }
    }
    // Of several wrong rows the first is named, as on one thread.
    Batch wrong = batch;
    for (const std::size_t row : {std::size_t{1000}, wrong.b.size() / 2, wrong.b.size() - 1})
      wrong.b[row] = std::nan("");
    ExpectRefused([&] { SolveBatch(&solver, &wrong); }, "row 1000");
    EXPECT_EQ(SolveBatch(&solver, &batch).f, expected.f);
  }
  ExpectRefused([] { StepSolver({.threads = 0}); }, "threads must be from 1");
  ExpectRefused([] { StepSolver({.threads = 1025}); }, "threads must be from 1");
}

TEST(RowBatch, TakesEmptyBatchesAndProblems) {
  StepSolver solver;
  solver.SolveBatch({}, std::vector<std::int32_t>{0}, nullptr, {});
  std::vector<StepAnswer> answers(2);
  solver.SolveBatch({}, std::vector<std::int32_t>{0, 0, 0}, nullptr, answers);
  EXPECT_EQ(answers[1].status, LcpStatus::kSolved);
}

TEST(PassesExtended, ByTheRhoOfTheVerifier) {
  for (const bool single : {false, true}) {
    Batch batch(6, single);
    for (unsigned seed = 0; seed < 50; ++seed) batch.AddRandom(1 + static_cast<int>(seed % 64), seed);
    const StepRows rows = batch.Rows();
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const LcpProblem problem = batch.Problem(k);
      const Eigen::VectorXd f =
          Eigen::VectorXd::NullaryExpr(problem.size(), [&](Index i) { return std::sin(static_cast<double>(i) + 1); });
      const double expected = ComputeMetrics(problem, f).rho;
      double found = 0;
      PassesExtended(PartOf(rows, batch.start[k], batch.start[k + 1]), 1, 1, f.data(), &found);
      EXPECT_NEAR(found, expected, 1e-12 * expected);
    }
  }
}

}  // namespace
}  // namespace lcpbench
