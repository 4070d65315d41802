// Answers, proofs, units, warm starts, limits, refusals and allocations of all direct solvers, on problems that are
// exact in double: generated families, small problems without exception, those worked out by hand, and outside data.
// What is particular to one method is in its own file.

#include "tests/solvers/direct_solvers.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "tests/solvers/io/read_lcp_file.h"
#include "tests/solvers/rounded_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class DirectSolversLaw : public DirectSolverTest {
 protected:
  // The verdict and w of `test` after rescaling: solved and proved problems alike.
  void JudgeRescaled(const TestProblem& test, const VectorXd& rows, double of_A, double of_b) {
    TestProblem other = Rescaled(test, rows, of_A, of_b);
    const LcpResult result = Solve(other.problem);
    // The known w in the units of the original, where all numbers are of one size.
    const std::optional<VectorXd> known = other.reference.w;
    other.reference.w.reset();
    Judge(other, result);
    if (result.status != LcpStatus::kSolved || !known.has_value()) return;
    const VectorXd w = ComputeMetrics(other.problem, result.f).w;
    const VectorXd error = (w - *known).cwiseQuotient(of_b * rows);
    EXPECT_LE(error.cwiseAbs().maxCoeff(), 1e-7 * (1 + test.problem.b().cwiseAbs().maxCoeff()));
  }

  struct Iterations {
    std::int64_t cold = 0;
    std::int64_t warm = 0;
  };
  Iterations SolveTwice(const TestProblem& test) {
    const LcpResult cold = Solve(test.problem);
    const LcpResult warm = Solve(test.problem, {.initial_f = &cold.f});
    ExpectSolved(test, warm);
    return {cold.iterations, warm.iterations};
  }
};

INSTANTIATE_TEST_SUITE_P(All, DirectSolversLaw, testing::ValuesIn(DirectSolvers()), NameOf);

void ForEachOf(std::span<const ExactFamily> families, unsigned seeds,
               const std::function<void(const TestProblem& test, unsigned seed)>& check) {
  for (const ExactFamily& family : families) {
    for (unsigned seed = 0; seed < seeds; ++seed) {
      SCOPED_TRACE(std::string(family.name) + " seed " + std::to_string(seed));
      check(family.make(seed), seed);
    }
  }
}

TEST_P(DirectSolversLaw, EveryGeneratedFamilyIsSolvedAndEveryUnsolvableOneIsProved) {
  const auto check = [this](const TestProblem& test, unsigned /*seed*/) {
    const LcpResult result = Solve(test.problem);
    Judge(test, result);
    if (GetParam().iterations_per_row > 0 && test.reference.status == LcpReference::Status::kSolved) {
      EXPECT_LE(result.iterations, GetParam().iterations_per_row * (test.problem.size() + 1));
    }
  };
  ForEachOf(SolvableFamilies(), 300, check);
  ExpectUndecided(GetParam().undecided);
  ForEachOf(UnsolvableFamilies(), 500, check);
  ExpectUndecided(GetParam().undecided);
}

// All symmetric PSD A of one and two rows with entries up to 2 in size, all b up to 2, contacts and joints.
TEST_P(DirectSolversLaw, EveryProblemOfTwoSmallRowsIsSolvedOrProved) {
  int solved = 0;
  int proved = 0;
  const auto check = [&](const MatrixXd& A, const VectorXd& b) {
    for (int joints = 0; joints < 1 << b.size(); ++joints) {
      std::vector<Index> bilateral;
      for (Index i = 0; i < b.size(); ++i) {
        if ((joints >> i & 1) != 0) bilateral.push_back(i);
      }
      const LcpProblem problem =
          LcpProblem::FromDense("two-rows", A, b, RowBounds::WithBilateralRows(b.size(), bilateral), SymmetricPsd());
      const LcpResult result = Solve(problem);
      const Verdict verdict = Verify(problem, result, 1e-9);
      const bool is_right =
          result.status == LcpStatus::kSolved
              ? verdict.passes
              : result.status == LcpStatus::kInfeasible && verdict.farkas.has_value() && verdict.farkas->accepted;
      EXPECT_TRUE(is_right) << result.status << " " << result.detail << "\nA\n"
                            << A << "\nb " << b.transpose() << ", joints " << joints;
      ++(result.status == LcpStatus::kSolved ? solved : proved);
    }
  };
  for (int a = 0; a <= 2; ++a) {
    for (int b0 = -2; b0 <= 2; ++b0) {
      check(MatrixXd::Constant(1, 1, a), VectorXd::Constant(1, b0));
      for (int d = 0; d <= 2; ++d) {
        for (int c = -2; c <= 2; ++c) {
          if (c * c > a * d) continue;
          MatrixXd A(2, 2);
          A << a, c, c, d;
          for (int b1 = -2; b1 <= 2; ++b1) check(A, Eigen::Vector2d(b0, b1));
        }
      }
    }
  }
  EXPECT_GT(solved, 1000);
  EXPECT_GT(proved, 200);
}

// What rounding leaves of a contradiction goes to the row that is left out, divided by that row's part in it.
TEST_P(DirectSolversLaw, ARedundantLinkageIsSolvedNearItsDeadPoint) {
  std::vector<LcpProblem> problems = ReportedProblems("redundant-linkage");
  for (unsigned seed = 0; seed < 2000; ++seed) problems.push_back(RedundantLinkage(seed));
  for (const LcpProblem& problem : problems) lcpbench::ExpectSolved(problem, Solve(problem));
}

TEST_P(DirectSolversLaw, EveryOracleProblemIsSolvedExactlyOrProved) {
  for (const TestProblem& test : OracleProblems()) {
    Judge(test, Solve(test.problem));
  }
  ExpectUndecided(0);
}

// rho and the threshold of rays count a row of zeros in the units of b, so that its weight against the other rows
// depends on the units.
bool HasZeroRows(const LcpProblem& problem) { return (problem.DiagonalA().array() == 0).any(); }

TEST_P(DirectSolversLaw, PowersOfTwoChangeNoPivotAndNoBitOfTheAnswer) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const TestProblem test = PlantedExactly(seed, 25, true);
    if (HasZeroRows(test.problem) && !GetParam().powers_of_two_leave_zero_rows) continue;
    const Index n = test.problem.size();
    const LcpResult plain = Solve(test.problem);
    const auto expect_same = [&](const VectorXd& rows, double of_A, double of_b) {
      const LcpResult other = Solve(Rescaled(test, rows, of_A, of_b).problem);
      EXPECT_EQ(other.status, plain.status);
      EXPECT_EQ(other.iterations, plain.iterations);
      EXPECT_TRUE(other.f == of_b / of_A * plain.f.cwiseQuotient(rows));
    };
    const VectorXd ones = VectorXd::Ones(n);
    expect_same(ones, 0x1p40, 1);
    expect_same(ones, 0x1p-40, 1);
    expect_same(ones, 1, 0x1p-39);
    expect_same(ones, 1, 0x1p39);
    TestRandom random(seed);
    VectorXd rows(n);
    for (Index i = 0; i < n; ++i) rows[i] = std::ldexp(1.0, random.Integer(-20, 20));
    expect_same(rows, 1, 1);
  }
}

// In powers of ten, and in any.
TEST_P(DirectSolversLaw, OtherUnitsChangeNeitherVerdictNorW) {
  const auto check = [this](const TestProblem& test, unsigned seed) {
    if (HasZeroRows(test.problem)) return;
    const VectorXd ones = VectorXd::Ones(test.problem.size());
    for (const double unit : {1e-12, 1e12}) {
      if (seed >= 40) break;
      JudgeRescaled(test, ones, unit, 1);
      JudgeRescaled(test, ones, 1, unit);
    }
    TestRandom random(seed);
    VectorXd rows(test.problem.size());
    for (double& row : rows) row = std::pow(10.0, random.Integer(-6000, 6000) / 1000.0);
    JudgeRescaled(test, rows, 1, 1);
  };
  ForEachOf(SolvableFamilies(), 100, check);
  ExpectUndecided(0);
  ForEachOf(UnsolvableFamilies(), 100, check);
  ExpectUndecided(GetParam().undecided_rounded);
}

TEST_P(DirectSolversLaw, AStartFromTheAnswerTakesFewIterations) {
  constexpr unsigned kProblems = 300;
  Iterations full_rank;
  Iterations redundant;
  for (unsigned seed = 0; seed < kProblems; ++seed) {
    SCOPED_TRACE(seed);
    const Iterations full = SolveTwice(PlantedProblem(30, 40, seed, seed % 2 == 0 ? 5 : 0, 0));
    full_rank.cold += full.cold;
    full_rank.warm += full.warm;
    const Iterations other = SolveTwice(PlantedExactly(seed, 30, false));
    redundant.cold += other.cold;
    redundant.warm += other.warm;
  }
  EXPECT_GE(full_rank.cold, kProblems / 2);  // some start from blocks of rows, and count these as none
  EXPECT_LE(static_cast<double>(full_rank.warm), GetParam().warm_iterations * kProblems);
  EXPECT_LE(static_cast<double>(redundant.warm), GetParam().warm_part * static_cast<double>(redundant.cold));
}

TEST_P(DirectSolversLaw, AWrongStartDoesNoHarm) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const TestProblem test = PlantedExactly(seed, 30, false);
    TestRandom random(seed + 1000);
    VectorXd start(test.problem.size());
    for (Index i = 0; i < start.size(); ++i) start[i] = random.Integer(-3, 3);
    Judge(test, Solve(test.problem, {.initial_f = &start}));
  }
  ExpectUndecided(GetParam().undecided);
}

TEST_P(DirectSolversLaw, ALimitOfIterationsIsMetAndLeavesNonnegativeForces) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const TestProblem test = PlantedProblem(60, 30, seed, 0, 0);
    const std::int64_t needed = Solve(test.problem).iterations;
    for (std::int64_t limit = 1; limit < needed; limit += 1 + needed / 10) {
      const LcpResult result = Solve(test.problem, {.max_iterations = limit});
      if (result.status == LcpStatus::kSolved) continue;
      EXPECT_EQ(result.status, LcpStatus::kIterationLimit) << limit << ": " << result.detail;
      EXPECT_EQ(result.iterations, limit);
      EXPECT_TRUE(result.f.allFinite());
      EXPECT_GE(result.f.minCoeff(), 0) << limit;
    }
  }
}

// Asymmetric ones are refused by name in the contract of all solvers.
TEST_P(DirectSolversLaw, NegativeDiagonalsAreUnsupported) {
  const LcpResult negative = Solve(LcpProblem::FromDense("negative", -MatrixXd::Identity(2, 2), VectorXd::Ones(2)));
  EXPECT_EQ(negative.status, LcpStatus::kUnsupported) << negative.detail;
  EXPECT_FALSE(negative.detail.empty());
}

TEST_P(DirectSolversLaw, MoreRowsThanItsArraysAreMeantForAreUnsupported) {
  if (GetParam().row_limit == nullptr) GTEST_SKIP() << "takes any number of rows";
  const LcpProblem problem = PlantedProblem(8, 4, 1, 0, 0).problem;
  Settings settings = GetParam().settings;
  for (const bool fits : {false, true}) {
    settings[GetParam().row_limit] = fits ? "8" : "7";
    const LcpResult result = SolveWith(MakeSolver(GetParam().key, settings).get(), problem);
    EXPECT_EQ(result.status, fits ? LcpStatus::kSolved : LcpStatus::kUnsupported);
    EXPECT_TRUE(fits || result.detail.find(GetParam().row_limit) != std::string::npos) << result.detail;
  }
}

TEST_P(DirectSolversLaw, NothingWrongIsClaimedForAMatrixThatIsNotPsd) {
  MatrixXd A(2, 2);
  A << 1, -2, -2, 1;  // indefinite, without a solution
  const LcpProblem problem = LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -1));
  const LcpResult result = Solve(problem);
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  EXPECT_TRUE(result.status == LcpStatus::kIterationLimit || !result.detail.empty());
  for (unsigned seed = 1; seed <= 50; ++seed) {
    TestRandom random(seed);
    MatrixXd B = MatrixXd::Identity(6, 6);
    VectorXd b(6);
    for (Index i = 0; i < 6; ++i) {
      for (Index j = 0; j < i; ++j) B(i, j) = B(j, i) = random.Integer(-200, 200) / 100.0;
      b[i] = random.Integer(-100, 100) / 100.0;
    }
    const LcpProblem other = LcpProblem::FromDense("indefinite-" + std::to_string(seed), B, b);
    const LcpResult claim = Solve(other);
    const Verdict verdict = Verify(other, claim, 1e-9);
    EXPECT_FALSE(verdict.false_success) << seed;
    EXPECT_FALSE(verdict.false_infeasible) << seed;
  }
}

// By some without an LcpProblem, up to 128 rows: cold and warm, redundant or not.
TEST_P(DirectSolversLaw, ArraysAreSolvedAsTheirProblemIs) {
  static const std::set<std::string_view> kReadRows = {"dantzig", "lemke", "bpp_dense", "active_set",
                                                       "semismooth_newton"};
  CountAllocations(true);
  int asked = 0;
  int in_place = 0;
  for (const Index n : {1, 2, 3, 5, 6, 7, 8, 9, 16, 17, 30, 60, 100, 128, 129}) {
    for (unsigned seed = 0; seed < 8; ++seed) {
      const auto bodies = static_cast<int>(seed % 2 == 0 ? n : 1 + n / 4);
      const TestProblem test = PlantedProblem(n, bodies, seed, seed % 4 < 2 ? 0 : 5, 3);
      SCOPED_TRACE(test.problem.id());
      const ProblemArrays arrays = ProblemArrays::Of(test.problem);
      LcpResult result;
      solver_->SolveArrays(arrays, {}, &result);
      Judge(test, result);
      if (result.status != LcpStatus::kSolved) continue;
      const VectorXd f = result.f;
      const long before = AllocationCount();
      solver_->SolveArrays(arrays, {}, &result);
      asked += n <= 128 ? 1 : 0;
      in_place += AllocationCount() == before ? 1 : 0;
      EXPECT_EQ(result.f, f);
      solver_->SolveArrays(arrays, {.initial_f = &f}, &result);
      Judge(test, result);
    }
  }
  ExpectUndecided(GetParam().undecided_rounded);
  if (AllocationsAreCounted() && kReadRows.contains(GetParam().name)) {
    EXPECT_GE(in_place, 0.9 * asked);
  }
}

TEST_P(DirectSolversLaw, SolvingAgainDoesNotAllocate) {
  if (GetParam().allocates) GTEST_SKIP() << "does not promise that";
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  CountAllocations(true);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const TestProblem dense = PlantedExactly(seed, 60, false);
    const Index n = dense.problem.size();
    // The same kind of problem by factors, where w goes through body space.
    SparseMatrix J = MatrixXd(MatrixXd::Identity(n, n)).sparseView();
    for (Index i = 0; i + 1 < n; ++i) J.coeffRef(i, i + 1) = -0.5;
    const LcpProblem by_factors =
        LcpProblem::FromFactors("chain", J, VectorXd::Ones(n), VectorXd::LinSpaced(n, -1, 0.5));
    for (const LcpProblem& problem : {dense.problem, by_factors, PlantedProblem(40, 30, seed, 5, 3).problem}) {
      const std::unique_ptr<LcpSolver> solver = MakeSolver(GetParam().key, GetParam().settings);
      solver->Reserve(problem.size());
      solver->Prepare(problem);
      LcpResult result;
      solver->Solve(problem, {}, &result);
      ASSERT_EQ(result.status, LcpStatus::kSolved);
      const VectorXd f = result.f;
      const LcpOptions warm{.initial_f = &f};
      const long before = AllocationCount();
      solver->Solve(problem, {}, &result);
      solver->Solve(problem, warm, &result);
      EXPECT_EQ(AllocationCount() - before, 0) << "seed " << seed << ", " << problem.id();
      EXPECT_EQ(result.status, LcpStatus::kSolved);
    }
  }
}

}  // namespace
}  // namespace lcpbench
