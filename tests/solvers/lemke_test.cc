// What is particular to lexicographic Lemke; the contract that it shares with all solvers is in contract_test.cc.

#include "solvers/lemke.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/allocation_count.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LcpResult Solve(const LcpProblem& problem, const LcpOptions& options = {}) {
  LemkeSolver solver;
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

void ExpectProof(const LcpProblem& problem, const LcpResult& result) {
  EXPECT_EQ(result.status, LcpStatus::kInfeasible) << result.detail;
  ASSERT_TRUE(result.farkas_ray.has_value());
  const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
  EXPECT_TRUE(verdict.accepted) << verdict.reason;
}

TEST(Lemke, FindsPlantedSolutionsOfEveryRank) {
  LemkeSolver solver;
  for (const bool wide_masses : {false, true}) {
    for (unsigned seed = 0; seed < 1000; ++seed) {
      const TestProblem planted = PlantedExactly(seed, 30, wide_masses);
      SCOPED_TRACE(planted.problem.id() + (wide_masses ? " with wide masses" : ""));
      LcpResult result;
      solver.Solve(planted.problem, {}, &result);
      const Verdict verdict = Verify(planted.problem, result, 1e-9, &planted.reference);
      EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
      EXPECT_TRUE(verdict.passes) << verdict.reason;
      EXPECT_LE(verdict.metrics.rho, 1e-10) << "a direct method aims at rounding, whatever the tolerance";
      EXPECT_LE(verdict.metrics.w_error, 1e-8);
      EXPECT_LE(result.iterations, 6 * planted.problem.size() + 6);
    }
  }
}

TEST(Lemke, FollowsThePathOfATwoByTwoProblemByHand) {
  // d = (1, 1), so b + d = (1.5, 0): row 1 enters at z = 1 and f_1 = 1 - z; w_0 = 0.5 + z + 0.5 f_1 stays positive.
  MatrixXd A(2, 2);
  A << 1, 0.5,  //
      0.5, 1;
  const LcpResult result = Solve(LcpProblem::FromDense("by-hand", A, Eigen::Vector2d(0.5, -1), {}, SymmetricPsd()));
  EXPECT_EQ(result.status, LcpStatus::kSolved);
  EXPECT_DOUBLE_EQ(result.f[0], 0);
  EXPECT_DOUBLE_EQ(result.f[1], 1);
  EXPECT_EQ(result.iterations, 2) << "one event at z = 1, and the step to z = 0";
}

TEST(Lemke, EndsOnFullyDegenerateProblems) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    const LcpProblem problem = FullyDegenerate(seed, 40);
    const LcpResult result = Solve(problem);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
    EXPECT_LE(result.iterations, 4 * problem.size() + 4) << "seed " << seed;
  }
}

// All contacts of a symmetric problem reach 0 at the same z, so that every pivot is a tie: without an order among tied
// rows the path may go round.
TEST(Lemke, ResolvesTiesOfEqualRows) {
  for (const Index n : {2, 3, 8, 25, 60}) {
    for (const double coupling : {0.0, 0.5, 1.0}) {
      const MatrixXd A = (1 - coupling) * MatrixXd::Identity(n, n) + coupling * MatrixXd::Ones(n, n);
      const LcpProblem problem = LcpProblem::FromDense("equal-rows", A, -VectorXd::Ones(n), {}, SymmetricPsd());
      const LcpResult result = Solve(problem);
      EXPECT_EQ(result.status, LcpStatus::kSolved) << n << " " << coupling << ": " << result.detail;
      EXPECT_LE(result.iterations, 2 * n + 2) << coupling;
      if (coupling == 1.0) {
        EXPECT_NEAR(result.f.sum(), 1, 1e-14);  // one row carries all
      } else {
        EXPECT_LE((result.f.array() - 1 / (1 + coupling * static_cast<double>(n - 1))).abs().maxCoeff(), 1e-14);
      }
    }
  }
}

TEST(Lemke, ProvesPlantedInfeasibility) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    const LcpProblem problem = InfeasibleExactly(seed, 30);
    ExpectProof(problem, Solve(problem));
  }
}

TEST(Lemke, TheRayOfTwoOpposedContactsThatSqueezeIsBoth) {
  MatrixXd A(2, 2);
  A << 1, -1,  //
      -1, 1;
  const LcpProblem squeezed = LcpProblem::FromDense("squeezed", A, Eigen::Vector2d(-1, -2), {}, SymmetricPsd());
  const LcpResult result = Solve(squeezed);
  ExpectProof(squeezed, result);
  EXPECT_DOUBLE_EQ((*result.farkas_ray)[0], (*result.farkas_ray)[1]);
  const LcpProblem held = LcpProblem::FromDense("held", A, Eigen::Vector2d(-1, 1), {}, SymmetricPsd());
  EXPECT_EQ(Solve(held).status, LcpStatus::kSolved);
}

TEST(Lemke, ARowOfZerosIsRightOrProvedImpossible) {
  MatrixXd A = MatrixXd::Zero(3, 3);
  A(1, 1) = 2;
  const auto solve = [&](double b0, double b2, const std::vector<Index>& bilateral) {
    const LcpProblem problem = LcpProblem::FromDense("zero-rows", A, Eigen::Vector3d(b0, -4, b2),
                                                     RowBounds::WithBilateralRows(3, bilateral), SymmetricPsd());
    const LcpResult result = Solve(problem);
    if (result.status == LcpStatus::kSolved) {
      EXPECT_DOUBLE_EQ(result.f[1], 2);
    } else {
      ExpectProof(problem, result);
    }
    return result.status;
  };
  EXPECT_EQ(solve(0, 5, {}), LcpStatus::kSolved);
  EXPECT_EQ(solve(1, 0, {2}), LcpStatus::kSolved);
  EXPECT_EQ(solve(-1, 5, {}), LcpStatus::kInfeasible);
  EXPECT_EQ(solve(0, -5, {2}), LcpStatus::kInfeasible);
}

TEST(Lemke, ARedundantJointIsLeftOutOrProvedImpossible) {
  // Rows 0 and 1 are one joint written twice, row 2 a contact.
  MatrixXd A(3, 3);
  A << 1, -2, 0.5,  //
      -2, 4, -1,    //
      0.5, -1, 1;
  for (const double mismatch : {0.0, 1.0, -1.0}) {
    const LcpProblem problem = LcpProblem::FromDense("joint-twice", A, Eigen::Vector3d(3, -6 + mismatch, -2),
                                                     RowBounds::WithBilateralRows(3, {0, 1}), SymmetricPsd());
    const LcpResult result = Solve(problem);
    if (mismatch == 0) {
      EXPECT_TRUE(Verify(problem, result, 1e-9).passes);
    } else {
      ExpectProof(problem, result);
    }
  }
}

TEST(Lemke, PowersOfTwoChangeNoPivotAndNoBitOfTheAnswer) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const TestProblem planted = PlantedExactly(seed, 25, true);
    const Index n = planted.problem.size();
    const MatrixXd& A = planted.problem.DenseA();
    const VectorXd& b = planted.problem.b();
    const RowBounds bounds = RowBounds::WithBilateralRows(n, planted.problem.bilateral_rows());
    const LcpResult plain = Solve(planted.problem);
    const auto expect_same = [&](const MatrixXd& other_A, const VectorXd& other_b, const VectorXd& force_unit) {
      const LcpResult other = Solve(LcpProblem::FromDense("rescaled", other_A, other_b, bounds, SymmetricPsd()));
      EXPECT_EQ(other.status, plain.status) << "seed " << seed;
      EXPECT_EQ(other.iterations, plain.iterations) << "seed " << seed;
      EXPECT_TRUE(other.f == force_unit.cwiseProduct(plain.f)) << "seed " << seed;
    };
    const VectorXd ones = VectorXd::Ones(n);
    expect_same(std::ldexp(1.0, 41) * A, b, std::ldexp(1.0, -41) * ones);
    expect_same(A, std::ldexp(1.0, -39) * b, std::ldexp(1.0, -39) * ones);
    TestRandom random(seed);
    VectorXd S(n);
    for (Index i = 0; i < n; ++i) S[i] = std::ldexp(1.0, random.Integer(-20, 20));
    expect_same(S.asDiagonal() * A * S.asDiagonal(), S.cwiseProduct(b), S.cwiseInverse());
  }
}

TEST(Lemke, OtherUnitsGetTheSameVerdict) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const TestProblem planted = PlantedExactly(seed, 25, false);
    const RowBounds bounds = RowBounds::WithBilateralRows(planted.problem.size(), planted.problem.bilateral_rows());
    for (const double unit : {1e-12, 1e12}) {
      for (const bool of_A : {false, true}) {
        const LcpProblem problem =
            LcpProblem::FromDense("units", (of_A ? unit : 1.0) * planted.problem.DenseA(),
                                  (of_A ? 1.0 : unit) * planted.problem.b(), bounds, SymmetricPsd());
        const LcpResult result = Solve(problem);
        EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
        EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
      }
    }
  }
}

TEST(Lemke, WarmStartFromTheSolutionTakesFewPivots) {
  std::int64_t cold_pivots = 0;
  std::int64_t warm_pivots = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const TestProblem planted = PlantedExactly(seed, 30, false);
    const LcpResult cold = Solve(planted.problem);
    LcpOptions options;
    options.initial_f = &cold.f;
    const LcpResult warm = Solve(planted.problem, options);
    EXPECT_EQ(warm.status, LcpStatus::kSolved) << "seed " << seed << ": " << warm.detail;
    cold_pivots += cold.iterations;
    warm_pivots += warm.iterations;
  }
  EXPECT_LE(20 * warm_pivots, cold_pivots);
}

TEST(Lemke, AWrongWarmStartDoesNoHarm) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const TestProblem planted = PlantedExactly(seed, 30, false);
    TestRandom random(seed + 1000);
    VectorXd start(planted.problem.size());
    for (Index i = 0; i < start.size(); ++i) start[i] = random.Integer(-3, 3);
    LcpOptions options;
    options.initial_f = &start;
    const LcpResult result = Solve(planted.problem, options);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
    EXPECT_TRUE(Verify(planted.problem, result, 1e-9, &planted.reference).passes) << "seed " << seed;
  }
}

TEST(Lemke, StopsAtItsLimitsOnThePathWithNonnegativeForces) {
  const Index n = 12;
  MatrixXd A = MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Ones(n, n);
  const LcpProblem problem = LcpProblem::FromDense("limits", A, -VectorXd::LinSpaced(n, 1, 2), {}, SymmetricPsd());
  LcpOptions options;
  options.max_iterations = 3;
  LcpResult result = Solve(problem, options);
  EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_GE(result.f.minCoeff(), 0);

  options.max_iterations = 0;
  options.time_limit_s = 1;
  options.now = [] {
    static double time = 0;
    return time += 2;
  };
  result = Solve(problem, options);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_GE(result.f.minCoeff(), 0);
}

TEST(Lemke, SolvesTheUnitProblemsOfAnotherEngine) {
  const std::vector<LcpProblem> problems = RecordedUnitProblems();
  if (problems.empty()) GTEST_SKIP() << "the outside data is not there";
  int solved = 0;
  for (const LcpProblem& problem : problems) {
    const LcpResult result = Solve(problem);
    EXPECT_FALSE(Verify(problem, result, 1e-9).false_success) << problem.id();
    if (result.status == LcpStatus::kSolved) ++solved;
  }
  EXPECT_GE(solved, static_cast<int>(problems.size()) - 1) << "one of them misses its own null space by 1e-9";
}

TEST(Lemke, RefusesWhatItIsNotFor) {
  MatrixXd A = MatrixXd::Identity(2, 2);
  A(0, 1) = 0.5;
  EXPECT_EQ(Solve(LcpProblem::FromDense("asymmetric", A, VectorXd::Ones(2))).status, LcpStatus::kUnsupported);
  EXPECT_EQ(Solve(LcpProblem::FromDense("negative", -MatrixXd::Identity(2, 2), VectorXd::Ones(2))).status,
            LcpStatus::kUnsupported);
  // Symmetric and indefinite, without a solution: no claim may come of it.
  A << 1, -2, -2, 1;
  const LcpResult result = Solve(LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -1)));
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  EXPECT_FALSE(result.detail.empty());
  const LcpProblem eight = PlantedProblem(8, 4, 1, 0, 0).problem;
  LcpResult other;
  LemkeSolver(LemkeOptions::FromSettings({{"max_rows", "7"}})).Solve(eight, {}, &other);
  EXPECT_EQ(other.status, LcpStatus::kUnsupported);
}

TEST(Lemke, ReadsItsSettings) {
  EXPECT_EQ(LemkeOptions::FromSettings({{"rank_tolerance", "1e-10"}}).rank_tolerance, 1e-10);
  EXPECT_THROW(LemkeOptions::FromSettings({{"rank_tolerance", "0"}}), InputError);
}

TEST(Lemke, SolvingAgainDoesNotAllocate) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  for (unsigned seed = 0; seed < 50; ++seed) {
    for (const LcpProblem& problem :
         {PlantedExactly(seed, 60, false).problem, PlantedProblem(40, 30, seed, 5, 3).problem}) {
      LemkeSolver solver;
      solver.Reserve(problem.size());
      solver.Prepare(problem);
      LcpResult result;
      solver.Solve(problem, {}, &result);
      ASSERT_EQ(result.status, LcpStatus::kSolved);
      const VectorXd f = result.f;
      LcpOptions warm;
      warm.initial_f = &f;
      const long before = AllocationCount();
      solver.Solve(problem, {}, &result);
      solver.Solve(problem, warm, &result);
      EXPECT_EQ(AllocationCount() - before, 0) << "seed " << seed << ", " << problem.id();
    }
  }
}

}  // namespace
}  // namespace lcpbench
