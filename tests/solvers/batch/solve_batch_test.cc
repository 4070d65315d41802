#include "solvers/batch/solve_batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTolerance = 1e-9;

std::vector<LcpResult> SolveWith(BatchSolver* solver, const std::vector<LcpProblem>& problems,
                                 const LcpOptions& options = {}) {
  std::vector<LcpResult> results(problems.size());
  solver->Solve(problems, options, results);
  return results;
}

std::vector<LcpResult> SolveWith(BatchInstructions instructions, const std::vector<LcpProblem>& problems,
                                 int threads = 1) {
  BatchSolver solver({.threads = threads, .instructions = instructions});
  return SolveWith(&solver, problems);
}

std::vector<LcpProblem> ProblemsOf(const std::vector<TestProblem>& tests) {
  std::vector<LcpProblem> problems;
  for (const TestProblem& test : tests) problems.push_back(test.problem);
  return problems;
}

// Random symmetric PSD A = G G^T of rank 1 to n with rows as different as 10^+-3, duplicated and opposed ones among
// them; b in A's range plus gaps, so that there is an answer.
LcpProblem RandomProblem(unsigned seed, Index n) {
  TestRandom random(seed);
  std::mt19937 engine(seed + 1000);
  std::normal_distribution<double> normal;
  const Index rank = random.Integer(1, static_cast<int>(n));
  MatrixXd G(n, rank);
  for (Index i = 0; i < n; ++i) {
    if (i > 0 && random.Chance(0.15)) {
      G.row(i) = G.row(random.Integer(0, static_cast<int>(i) - 1)) * (random.Chance(0.5) ? 1 : -1);
      continue;
    }
    const double size = std::pow(10.0, random.Integer(-3, 3));
    for (Index k = 0; k < rank; ++k) G(i, k) = size * normal(engine);
  }
  const double joints = random.Chance(0.3) ? (random.Chance(0.2) ? 1.0 : 0.3) : 0.0;
  const double degenerate = random.Chance(0.3) ? 0.4 : 0.0;
  VectorXd f = VectorXd::Zero(n);
  VectorXd w = VectorXd::Zero(n);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    const double norm = G.row(i).norm();
    if (random.Chance(joints)) {
      bilateral.push_back(i);
      f[i] = normal(engine) / norm;
    } else if (!random.Chance(degenerate)) {
      if (random.Chance(0.5)) {
        f[i] = std::abs(normal(engine)) / norm;
      } else {
        w[i] = std::abs(normal(engine)) * norm;
      }
    }
  }
  const MatrixXd product = G * G.transpose();
  const MatrixXd A = product.selfadjointView<Eigen::Upper>();  // bitwise symmetric
  return LcpProblem::FromDense("random-" + std::to_string(seed), A, w - A * f,
                               RowBounds::WithBilateralRows(n, bilateral), SymmetricPsd());
}

std::vector<LcpProblem> RandomProblems(unsigned count) {
  std::vector<LcpProblem> problems;
  for (unsigned seed = 0; seed < count; ++seed) {
    problems.push_back(RandomProblem(seed, 1 + static_cast<Index>(seed * 7 % BatchSolver::kMaxRows)));
  }
  return problems;
}

class SolveBatchTest : public testing::TestWithParam<BatchInstructions> {
 protected:
  static BatchOptions With(int threads = 1) { return {.threads = threads, .instructions = GetParam()}; }

  static void ExpectVerified(const LcpProblem& problem, const LcpResult& result,
                             const LcpReference* reference = nullptr) {
    ExpectSolved(problem, result);
    if (reference == nullptr || !reference->w.has_value()) return;
    EXPECT_LE(Verify(problem, result, kTolerance, reference).metrics.w_error, 1e-6) << problem.id();
  }
};

TEST_P(SolveBatchTest, SolvesEveryRankAndSizeAndAgreesWithAuto) {
  const std::vector<LcpProblem> problems = RandomProblems(1500);
  BatchSolver solver(With());
  const std::vector<LcpResult> results = SolveWith(&solver, problems);
  AutoSolver reference;
  for (size_t p = 0; p < problems.size(); ++p) {
    ExpectVerified(problems[p], results[p]);
    const VectorXd w = ComputeMetrics(problems[p], results[p].f).w;
    const VectorXd expected_w = ComputeMetrics(problems[p], lcpbench::SolveWith(&reference, problems[p]).f).w;
    const VectorXd root = problems[p].DiagonalA().cwiseSqrt();
    const double size = problems[p].b().cwiseQuotient(root).norm();
    EXPECT_LE((w - expected_w).cwiseQuotient(root).norm(), 1e-6 * (1 + size)) << problems[p].id();
  }
  // Most are for the lanes, redundant ones included; a batch that passes everything on has nothing to test here.
  EXPECT_LE(solver.fallbacks(), static_cast<Index>(problems.size()) / 8);
}

TEST_P(SolveBatchTest, SolvesExactProblemsAndProvesInfeasibleOnesAmongThem) {
  std::vector<TestProblem> tests = TextbookProblems();
  for (const TestProblem& test : GeneratedProblems()) tests.push_back(test);
  for (const TestProblem& test : OracleProblems()) tests.push_back(test);
  for (unsigned seed = 0; seed < 600; ++seed) tests.push_back(PlantedExactly(seed, 32, seed % 3 == 0));
  const LcpReference infeasible{LcpReference::Status::kInfeasible, {}, {}};
  const LcpReference solvable{LcpReference::Status::kSolved, {}, {}};
  for (unsigned seed = 0; seed < 200; ++seed) {
    tests.push_back({InfeasibleExactly(seed, 32), infeasible});
    tests.push_back({FullyDegenerate(seed, 32), solvable});
  }
  const std::vector<LcpProblem> problems = ProblemsOf(tests);
  const std::vector<LcpResult> results = SolveWith(GetParam(), problems);
  for (size_t p = 0; p < tests.size(); ++p) {
    const Verdict verdict = Verify(problems[p], results[p], kTolerance, &tests[p].reference);
    EXPECT_FALSE(verdict.false_success || verdict.false_infeasible) << problems[p].id();
    if (tests[p].reference.status == LcpReference::Status::kSolved) {
      ExpectVerified(problems[p], results[p], &tests[p].reference);
    } else if (tests[p].reference.status == LcpReference::Status::kInfeasible) {
      ExpectRay(problems[p], results[p]);
    }
  }
}

TEST_P(SolveBatchTest, UnitsChangeNothingButTheAnswersUnits) {
  std::vector<LcpProblem> given;
  std::vector<LcpProblem> scaled;
  // Powers of two next to 10^+-12, so that the scaled problem is exactly the same one.
  const double a_units[] = {0x1p40, 0x1p-40, 0x1p40, 0x1p-40, 0x1p-39};
  const double b_units[] = {0x1p40, 0x1p-40, 0x1p-40, 0x1p40, 1};
  for (unsigned seed = 0; seed < 300; ++seed) {
    const LcpProblem problem = RandomProblem(seed, 1 + static_cast<Index>(seed % BatchSolver::kMaxRows));
    given.push_back(problem);
    scaled.push_back(LcpProblem::FromDense(problem.id(), problem.DenseA() * a_units[seed % 5],
                                           problem.b() * b_units[seed % 5], problem.bounds()));
  }
  BatchSolver solver(With());
  const std::vector<LcpResult> expected = SolveWith(&solver, given);
  const Index fallbacks = solver.fallbacks();
  const std::vector<LcpResult> results = SolveWith(&solver, scaled);
  EXPECT_EQ(solver.fallbacks(), fallbacks);
  for (size_t p = 0; p < given.size(); ++p) {
    ExpectVerified(scaled[p], results[p]);
    if (expected[p].detail != "lanes") continue;
    EXPECT_EQ(results[p].iterations, expected[p].iterations);
    // The exponent that brings A_ii into [1, 4) may be odd: then b's is another, and nothing else.
    EXPECT_TRUE(SameBits(results[p].f, expected[p].f * (b_units[p % 5] / a_units[p % 5]))) << given[p].id();
  }
}

// Rows times 2^+-500, b up to the ends of the range: b, w and f may lose bits to
// underflow, and squares leave the doubles.
TEST_P(SolveBatchTest, ClaimsNothingWrongOfExtremeNumbers) {
  BatchSolver solver(With());
  int solved = 0;
  for (unsigned seed = 0; seed < 4000; ++seed) {
    TestRandom random(seed);
    const TestProblem planted = PlantedExactly(seed, BatchSolver::kMaxRows, true);
    const Index n = planted.problem.size();
    const int common = random.Integer(-490, 490);
    const VectorXd rows = VectorXd::NullaryExpr(n, [&] { return std::exp2(common + random.Integer(-10, 10)); });
    const int of_b = std::clamp(random.Integer(-1070, 980) - common, -1022, 1022);
    const TestProblem test = Rescaled(planted, rows, 1, std::exp2(of_b));
    std::vector<std::uint32_t> joints = {0};
    for (const Index i : test.problem.bilateral_rows()) joints[0] |= 1U << static_cast<unsigned>(i);
    const Eigen::MatrixXd& A = test.problem.DenseA();
    LcpResult result;
    result.f.resize(n);
    solver.Solve({n, 1, A.data(), test.problem.b().data(), joints.data()}, LcpOptions{}, result.f.data(),
                 &result.status);
    if (result.status != LcpStatus::kSolved) continue;
    ++solved;
    ExpectVerified(test.problem, result);
  }
  EXPECT_GT(solved, 2000);
}

TEST_P(SolveBatchTest, AnswersDoNotDependOnPlaceOrNeighboursOrThreadsOrEarlierBatches) {
  const std::vector<LcpProblem> problems = RandomProblems(400);
  const std::vector<LcpResult> expected = SolveWith(GetParam(), problems);
  for (const int threads : {2, 3}) {
    const std::vector<LcpResult> results = SolveWith(GetParam(), problems, threads);
    for (size_t p = 0; p < problems.size(); ++p) {
      EXPECT_EQ(results[p].status, expected[p].status);
      EXPECT_TRUE(SameBits(results[p].f, expected[p].f)) << problems[p].id() << " with threads " << threads;
    }
  }
  std::vector<size_t> order(problems.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i * 37 % order.size();
  std::vector<LcpProblem> shuffled;
  shuffled.reserve(order.size());
  for (const size_t p : order) shuffled.push_back(problems[p]);
  shuffled.resize(shuffled.size() - 5, shuffled[0]);
  BatchSolver reused(With());
  SolveWith(&reused, RandomProblems(40));
  const std::vector<LcpResult> results = SolveWith(&reused, shuffled);
  for (size_t i = 0; i < shuffled.size(); ++i) {
    EXPECT_TRUE(SameBits(results[i].f, expected[order[i]].f)) << shuffled[i].id();
    EXPECT_EQ(results[i].iterations, expected[order[i]].iterations);
  }
  for (size_t p = 0; p < problems.size(); p += 17) {
    const std::vector<LcpResult> alone = SolveWith(GetParam(), {problems[p]});
    EXPECT_TRUE(SameBits(alone[0].f, expected[p].f)) << problems[p].id();
  }
}

TEST_P(SolveBatchTest, TakesEmptyBatchesAndEverySize) {
  EXPECT_TRUE(SolveWith(GetParam(), std::vector<LcpProblem>{}).empty());
  std::vector<LcpProblem> problems;
  for (const Index n : {0, 1, 2, 31, 32, 33, 40, 0, 5}) {
    problems.push_back(n == 0 ? LcpProblem::FromDense("empty", MatrixXd(), VectorXd())
                              : RandomProblem(static_cast<unsigned>(n), n));
  }
  const std::vector<LcpResult> results = SolveWith(GetParam(), problems);
  for (size_t p = 0; p < problems.size(); ++p) ExpectVerified(problems[p], results[p]);
}

TEST_P(SolveBatchTest, LeavesWhatIsNotForLanesToAuto) {
  MatrixXd skew(2, 2);
  skew << 1, 2, -2, 1;
  const std::vector<LcpProblem> problems = {LcpProblem::FromDense("skew", skew, VectorXd::Ones(2)),
                                            RandomProblem(1, 8)};
  const std::vector<LcpResult> results = SolveWith(GetParam(), problems);
  EXPECT_EQ(results[0].status, LcpStatus::kUnsupported);
  ExpectVerified(problems[1], results[1]);
  // The unit of a limit of iterations is that of a single backend.
  BatchSolver solver(With());
  for (const LcpResult& result : SolveWith(&solver, RandomProblems(10), {.max_iterations = 200})) {
    EXPECT_NE(result.detail, "lanes");
  }
  EXPECT_EQ(solver.fallbacks(), 10);
}

TEST_P(SolveBatchTest, DenseFormGivesTheSameBits) {
  BatchSolver solver(With());
  for (const Index n : {1, 2, 7, 10, 12, 13, 25, 32}) {
    constexpr Index kCount = 37;
    std::vector<LcpProblem> problems;
    std::vector<double> A;
    std::vector<double> b;
    std::vector<std::uint32_t> bilateral;
    for (unsigned p = 0; p < kCount; ++p) {
      problems.push_back(RandomProblem(100 * static_cast<unsigned>(n) + p, n));
      const LcpProblem& problem = problems.back();
      A.insert(A.end(), problem.DenseA().data(), problem.DenseA().data() + n * n);
      b.insert(b.end(), problem.b().data(), problem.b().data() + n);
      bilateral.push_back(0);
      for (const Index i : problem.bilateral_rows()) bilateral.back() |= 1U << static_cast<unsigned>(i);
    }
    const std::vector<LcpResult> expected = SolveWith(&solver, problems);
    std::vector<double> f(static_cast<size_t>(n * kCount), -1);
    std::vector<LcpStatus> status(kCount, LcpStatus::kNotRun);
    solver.Solve({n, kCount, A.data(), b.data(), bilateral.data()}, LcpOptions{}, f.data(), status.data());
    for (Index p = 0; p < kCount; ++p) {
      EXPECT_EQ(status[static_cast<size_t>(p)], expected[static_cast<size_t>(p)].status);
      EXPECT_TRUE(SameBits(Eigen::Map<const VectorXd>(f.data() + p * n, n), expected[static_cast<size_t>(p)].f));
    }
  }
}

TEST_P(SolveBatchTest, DoesNotAllocateAfterReserve) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted here";
  CountAllocations(true);
  std::vector<LcpProblem> problems;
  for (unsigned seed = 0; seed < 100; ++seed) {
    // Well conditioned, so that nothing goes to the fallback's later backends.
    const Index n = 1 + static_cast<Index>(seed % BatchSolver::kMaxRows);
    const MatrixXd A = MatrixXd::Identity(n, n) + MatrixXd::Constant(n, n, 0.5);
    VectorXd b(n);
    for (Index i = 0; i < n; ++i) b[i] = std::sin(static_cast<double>(seed) + 3.0 * static_cast<double>(i));
    problems.push_back(LcpProblem::FromDense("", A, b));
  }
  for (const int threads : {1, 2}) {
    BatchSolver solver(With(threads));
    solver.Reserve(static_cast<Index>(problems.size()));
    std::vector<LcpResult> results(problems.size());
    for (size_t p = 0; p < problems.size(); ++p) {
      results[p].f.resize(problems[p].size());
      problems[p].IsNumericallySymmetric();
    }
    const long before = AllocationCount();
    solver.Solve(problems, {}, results);
    EXPECT_EQ(AllocationCount(), before);
    for (size_t p = 0; p < problems.size(); ++p) EXPECT_EQ(results[p].status, LcpStatus::kSolved);
    EXPECT_EQ(solver.fallbacks(), 0);
  }
}

TEST_P(SolveBatchTest, RefusesNumbersThatAreNotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const int threads : {1, 2}) {
      BatchSolver solver(With(threads));
      constexpr size_t kCount = 9;  // of two rows
      std::vector<double> A(4 * kCount, 0);
      std::vector<double> b(2 * kCount, -1);
      for (size_t p = 0; p < kCount; ++p) A[4 * p] = A[4 * p + 3] = 1;
      std::vector<double> f(2 * kCount);
      const auto solve = [&] {
        solver.Solve({2, kCount, A.data(), b.data(), nullptr}, LcpOptions{}, f.data(), nullptr);
      };
      solve();
      EXPECT_EQ(f, std::vector<double>(2 * kCount, 1.0));
      // On the diagonal; off it, beside forces and, with the other b, beside zeros; in b.
      for (double* value : {&A[20], &A[10], &b[3]}) {
        const double good = std::exchange(*value, bad);
        for (const double other : {-1, 1}) {
          b[4] = b[5] = other;
          EXPECT_THROW(solve(), InputError);
        }
        *value = good;
      }
    }
  }
}

TEST_P(SolveBatchTest, EndsWhenTimeIsUp) {
  const std::vector<LcpProblem> problems = RandomProblems(50);
  BatchSolver solver(With());
  const std::vector<LcpResult> results = SolveWith(&solver, problems, {.time_limit_s = 0.5, .now = &TickingClock});
  for (size_t p = 0; p < problems.size(); ++p) {
    EXPECT_EQ(results[p].status, LcpStatus::kTimeLimit);
    EXPECT_EQ(results[p].f, VectorXd::Zero(problems[p].size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Machine, SolveBatchTest, testing::ValuesIn(AvailableBatchInstructions()),
                         [](const auto& test) { return std::string(ToString(test.param)); });

TEST(SolveBatch, Avx2AndAvx512GiveTheSameBits) {
  const std::vector<BatchInstructions> available = AvailableBatchInstructions();
  if (available.back() != BatchInstructions::kAvx512) GTEST_SKIP() << "no AVX-512 here";
  const std::vector<LcpProblem> problems = RandomProblems(600);
  const std::vector<LcpResult> wide = SolveWith(BatchInstructions::kAvx512, problems);
  const std::vector<LcpResult> narrow = SolveWith(BatchInstructions::kAvx2, problems);
  for (size_t p = 0; p < problems.size(); ++p) EXPECT_TRUE(SameBits(wide[p].f, narrow[p].f)) << problems[p].id();
}

TEST(SolveBatch, RefusesWhatMakesNoSense) {
  EXPECT_THROW(BatchSolver({.threads = 0}), InputError);
  BatchSolver solver;
  EXPECT_NE(solver.instructions(), BatchInstructions::kBest);
  const std::vector<LcpProblem> problems = RandomProblems(2);
  std::vector<LcpResult> results(1);
  EXPECT_THROW(solver.Solve(problems, {}, results), InputError);
  results.resize(2);
  const VectorXd f = VectorXd::Zero(1);
  for (const LcpOptions& options : {LcpOptions{.tolerance = 0}, LcpOptions{.initial_f = &f}}) {
    EXPECT_THROW(solver.Solve(problems, options, results), InputError);
  }
  EXPECT_THROW(solver.Solve(DenseBatch{33, 0, nullptr, nullptr, nullptr}, {}, nullptr, nullptr), InputError);
  EXPECT_THROW(solver.Solve(DenseBatch{3, -1, nullptr, nullptr, nullptr}, {}, nullptr, nullptr), InputError);
}

}  // namespace
}  // namespace lcpbench
