// What is particular to block principal pivoting; the contract that it shares with all solvers is in contract_test.cc.

#include "solvers/bpp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
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
using Form = BppOptions::Form;

constexpr Form kForms[] = {Form::kDense, Form::kSparse};

BppOptions InForm(Form form) {
  BppOptions options;
  options.form = form;
  return options;
}

LcpResult SolveWith(const BppOptions& method, const LcpProblem& problem, const LcpOptions& options = {}) {
  BppSolver solver(method);
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

TEST(Bpp, FindsPlantedSolutionsOfEveryRankInBothForms) {
  for (const Form form : kForms) {
    BppSolver solver(InForm(form));
    for (const bool wide_masses : {false, true}) {
      for (unsigned seed = 0; seed < 1000; ++seed) {
        const TestProblem planted = PlantedExactly(seed, 30, wide_masses);
        SCOPED_TRACE(planted.problem.id() + (wide_masses ? " with wide masses" : ""));
        LcpResult result;
        solver.Solve(planted.problem, {}, &result);
        const Verdict verdict = Verify(planted.problem, result, 1e-9, &planted.reference);
        EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
        EXPECT_TRUE(verdict.passes) << verdict.reason;
        EXPECT_LE(verdict.metrics.w_error, 1e-7);
      }
    }
  }
}

TEST(Bpp, ProvesPlantedInfeasibilityByTheDirectionOfItsSteps) {
  for (const Form form : kForms) {
    for (unsigned seed = 0; seed < 500; ++seed) {
      const LcpProblem problem = InfeasibleExactly(seed, 30);
      const LcpResult result = SolveWith(InForm(form), problem);
      EXPECT_EQ(result.status, LcpStatus::kInfeasible) << "seed " << seed << ": " << result.detail;
      ASSERT_TRUE(result.farkas_ray.has_value()) << "seed " << seed;
      const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
      EXPECT_TRUE(verdict.accepted) << "seed " << seed << ": " << verdict.reason;
    }
  }
}

TEST(Bpp, EndsOnFullyDegenerateProblems) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const LcpProblem problem = FullyDegenerate(seed, 40);
    const LcpResult result = SolveWith({}, problem);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
  }
}

// Blocks alone come back to a set F that they had before; both remedies lead out.
TEST(Bpp, LeavesACycleOfBlocks) {
  MatrixXd A(3, 3);
  A << 5, -9, -8,  //
      -9, 19, 15,  //
      -8, 15, 13;
  const LcpProblem problem = LcpProblem::FromDense("cycling", A, Eigen::Vector3d(2, -1, -3), {}, SymmetricPsd());

  BppOptions blocks_only;
  blocks_only.patience = 100;
  blocks_only.largest_proximal = blocks_only.proximal;
  LcpOptions limited;
  limited.max_iterations = 90;
  EXPECT_EQ(SolveWith(blocks_only, problem, limited).status, LcpStatus::kIterationLimit);

  BppOptions papers = blocks_only;
  papers.patience = 3;
  const LcpResult by_single_exchanges = SolveWith(papers, problem);
  EXPECT_EQ(by_single_exchanges.status, LcpStatus::kSolved);
  EXPECT_NE(by_single_exchanges.detail.find("single exchange"), std::string::npos);
  EXPECT_TRUE(Verify(problem, by_single_exchanges, 1e-9).passes);
  EXPECT_LE(by_single_exchanges.iterations, 12);

  const LcpResult by_a_heavier_term = SolveWith({}, problem);
  EXPECT_EQ(by_a_heavier_term.status, LcpStatus::kSolved);
  EXPECT_EQ(by_a_heavier_term.detail, "");
  EXPECT_TRUE(Verify(problem, by_a_heavier_term, 1e-9).passes);
}

TEST(Bpp, TakesOneFactorisationWhereAllRowsAct) {
  for (const Index n : {1, 5, 40}) {
    const MatrixXd A = 2 * MatrixXd::Identity(n, n) + MatrixXd::Ones(n, n);
    const LcpResult result = SolveWith({}, LcpProblem::FromDense("all-act", A, -VectorXd::Ones(n), {}, SymmetricPsd()));
    EXPECT_EQ(result.status, LcpStatus::kSolved);
    EXPECT_EQ(result.iterations, 1);
    EXPECT_LE((result.f.array() - 1 / (2 + static_cast<double>(n))).abs().maxCoeff(), 1e-15);
  }
}

TEST(Bpp, PowersOfTwoChangeNoFactorisationAndNoBitOfTheAnswer) {
  for (const Form form : kForms) {
    for (unsigned seed = 0; seed < 150; ++seed) {
      const TestProblem planted = PlantedExactly(seed, 25, true);
      // rho counts a row of zeros in the units of b, so that its weight against the others is not invariant.
      if ((planted.problem.DiagonalA().array() == 0).any()) continue;
      const Index n = planted.problem.size();
      const MatrixXd& A = planted.problem.DenseA();
      const VectorXd& b = planted.problem.b();
      const RowBounds bounds = RowBounds::WithBilateralRows(n, planted.problem.bilateral_rows());
      const LcpResult plain = SolveWith(InForm(form), planted.problem);
      const auto expect_same = [&](const MatrixXd& other_A, const VectorXd& other_b, const VectorXd& force_unit) {
        const LcpResult other =
            SolveWith(InForm(form), LcpProblem::FromDense("rescaled", other_A, other_b, bounds, SymmetricPsd()));
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
}

TEST(Bpp, OtherUnitsGetTheSameVerdict) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const TestProblem planted = PlantedExactly(seed, 25, false);
    const RowBounds bounds = RowBounds::WithBilateralRows(planted.problem.size(), planted.problem.bilateral_rows());
    for (const double unit : {1e-12, 1e12}) {
      for (const bool of_A : {false, true}) {
        const LcpProblem problem =
            LcpProblem::FromDense("units", (of_A ? unit : 1.0) * planted.problem.DenseA(),
                                  (of_A ? 1.0 : unit) * planted.problem.b(), bounds, SymmetricPsd());
        const LcpResult result = SolveWith({}, problem);
        EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
        EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
      }
    }
  }
}

TEST(Bpp, WarmStartFromTheSolutionTakesOneFactorisation) {
  std::int64_t cold = 0;
  std::int64_t warm = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const TestProblem test = PlantedProblem(30, 40, seed, seed % 2 == 0 ? 5 : 0, 0);
    const LcpResult first = SolveWith({}, test.problem);
    LcpOptions options;
    options.initial_f = &first.f;
    const LcpResult again = SolveWith({}, test.problem, options);
    EXPECT_EQ(again.status, LcpStatus::kSolved) << "seed " << seed << ": " << again.detail;
    cold += first.iterations;
    warm += again.iterations;
  }
  EXPECT_GE(cold, 700);
  EXPECT_LE(warm, 330);
}

TEST(Bpp, StopsAtItsLimitsWithNonnegativeForces) {
  const TestProblem test = PlantedProblem(60, 30, 4, 0, 0);
  LcpOptions options;
  options.max_iterations = 2;
  LcpResult result = SolveWith({}, test.problem, options);
  EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_GE(result.f.minCoeff(), 0);

  // The clock is read before each factorisation at least: one that passes the limit at the third read stops the second.
  static int reads;
  reads = 0;
  options.max_iterations = 0;
  options.time_limit_s = 1;
  options.now = [] { return ++reads > 2 ? 2.0 : 0.0; };
  result = SolveWith({}, test.problem, options);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_GE(result.f.minCoeff(), 0);
}

TEST(Bpp, SolvesTheUnitProblemsOfAnotherEngine) {
  const std::vector<LcpProblem> problems = RecordedUnitProblems();
  if (problems.empty()) GTEST_SKIP() << "the outside data is not there";
  for (const LcpProblem& problem : problems) {
    const LcpResult result = SolveWith({}, problem);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << ": " << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << problem.id();
  }
}

TEST(Bpp, RefusesWhatItIsNotFor) {
  MatrixXd A = MatrixXd::Identity(2, 2);
  A(0, 1) = 0.5;
  EXPECT_EQ(SolveWith({}, LcpProblem::FromDense("asymmetric", A, VectorXd::Ones(2))).status, LcpStatus::kUnsupported);
  EXPECT_EQ(SolveWith({}, LcpProblem::FromDense("negative", -MatrixXd::Identity(2, 2), VectorXd::Ones(2))).status,
            LcpStatus::kUnsupported);
  // Symmetric and indefinite, without a solution: no claim may come of it.
  A << 1, -2, -2, 1;
  const LcpResult result = SolveWith({}, LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -1)));
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  BppOptions small = InForm(Form::kDense);
  small.max_dense_rows = 7;
  const LcpProblem eight = PlantedProblem(8, 4, 1, 0, 0).problem;
  EXPECT_EQ(SolveWith(small, eight).status, LcpStatus::kUnsupported);
  small.form = Form::kAuto;
  EXPECT_EQ(SolveWith(small, eight).status, LcpStatus::kSolved) << "by the sparse form";
}

TEST(Bpp, ReadsItsSettings) {
  const BppOptions options = BppOptions::FromSettings(
      {{"form", "sparse"}, {"proximal", "1e-5"}, {"largest_proximal", "1e-3"}, {"patience", "7"}});
  EXPECT_EQ(options.form, Form::kSparse);
  EXPECT_EQ(options.proximal, 1e-5);
  EXPECT_EQ(options.largest_proximal, 1e-3);
  EXPECT_EQ(options.patience, 7);
  EXPECT_THROW(BppOptions::FromSettings({{"form", "banded"}}), InputError);
}

TEST(Bpp, SolvingAgainDoesNotAllocate) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  for (const Form form : kForms) {
    for (unsigned seed = 0; seed < 50; ++seed) {
      for (const LcpProblem& problem :
           {PlantedExactly(seed, 60, false).problem, PlantedProblem(40, 30, seed, 5, 3).problem}) {
        BppSolver solver(InForm(form));
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
}

}  // namespace
}  // namespace lcpbench
