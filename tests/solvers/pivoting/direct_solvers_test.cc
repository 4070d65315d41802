// Answers and proofs of all direct solvers on problems that are exact in double: generated families, small problems
// without exception, those worked out by hand, and outside data. What is particular to one method is in its own file.

#include "tests/solvers/direct_solvers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class DirectSolversAnswer : public DirectSolverTest {};

INSTANTIATE_TEST_SUITE_P(All, DirectSolversAnswer, testing::ValuesIn(DirectSolvers()), NameOf);

TEST_P(DirectSolversAnswer, EveryGeneratedFamilyIsSolved) {
  for (const ExactFamily& family : SolvableFamilies()) {
    for (unsigned seed = 0; seed < 300; ++seed) {
      const TestProblem test = family.make(seed);
      SCOPED_TRACE(std::string(family.name) + " seed " + std::to_string(seed));
      const LcpResult result = Solve(test.problem);
      Judge(test, result);
      if (GetParam().iterations_per_row > 0) {
        EXPECT_LE(result.iterations, GetParam().iterations_per_row * (test.problem.size() + 1));
      }
    }
  }
  ExpectUndecided(GetParam().undecided);
}

TEST_P(DirectSolversAnswer, ManyPlantedSolutionsOfEveryRankAreFound) {
  for (const bool wide_masses : {false, true}) {
    for (unsigned seed = 300; seed < 1000; ++seed) {
      const TestProblem test = PlantedExactly(seed, 30, wide_masses);
      SCOPED_TRACE(wide_masses);
      Judge(test, Solve(test.problem));
    }
  }
  ExpectUndecided(GetParam().undecided);
}

TEST_P(DirectSolversAnswer, EveryUnsolvableFamilyIsProved) {
  for (const ExactFamily& family : UnsolvableFamilies()) {
    for (unsigned seed = 0; seed < 500; ++seed) {
      const TestProblem test = family.make(seed);
      SCOPED_TRACE(std::string(family.name) + " seed " + std::to_string(seed));
      Judge(test, Solve(test.problem));
    }
  }
  ExpectUndecided(GetParam().undecided);
}

// All symmetric PSD A of one and two rows with entries up to 2 in size, all b up to 2, contacts and joints.
TEST_P(DirectSolversAnswer, EveryProblemOfTwoSmallRowsIsSolvedOrProved) {
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

TEST_P(DirectSolversAnswer, ARowOfZerosIsRightOrProvedImpossible) {
  MatrixXd A = MatrixXd::Zero(3, 3);
  A(1, 1) = 2;
  const auto solve = [&](double b0, double b2, const std::vector<Index>& bilateral) {
    const LcpProblem problem = LcpProblem::FromDense("zero-rows", A, Eigen::Vector3d(b0, -4, b2),
                                                     RowBounds::WithBilateralRows(3, bilateral), SymmetricPsd());
    const LcpResult result = Solve(problem);
    if (result.status == LcpStatus::kSolved) {
      EXPECT_NEAR(result.f[1], 2, 1e-9);
    } else {
      ExpectProof(problem, result);
    }
    return result.status;
  };
  EXPECT_EQ(solve(0, 5, {}), LcpStatus::kSolved);
  EXPECT_EQ(solve(1, 0, {2}), LcpStatus::kSolved);
  EXPECT_EQ(solve(-1, 5, {}), LcpStatus::kInfeasible);
  EXPECT_EQ(solve(0, 5, {2}), LcpStatus::kInfeasible);
  EXPECT_EQ(solve(0, -5, {2}), LcpStatus::kInfeasible);
}

TEST_P(DirectSolversAnswer, ARedundantJointIsLeftOutOrProvedImpossible) {
  // Rows 0 and 1 are one joint written twice, row 2 a contact.
  MatrixXd A(3, 3);
  A << 1, -2, 0.5,  //
      -2, 4, -1,    //
      0.5, -1, 1;
  for (const double mismatch : {0.0, 1.0, -1.0}) {
    const LcpProblem problem = LcpProblem::FromDense("joint-twice", A, Eigen::Vector3d(3, -6 + mismatch, -2),
                                                     RowBounds::WithBilateralRows(3, {0, 1}), SymmetricPsd());
    LcpReference reference;
    if (mismatch != 0) reference.status = LcpReference::Status::kInfeasible;
    Judge({problem, reference}, Solve(problem));
  }
  ExpectUndecided(GetParam().undecided > 0 ? 1.0 / 3 : 0);
}

TEST_P(DirectSolversAnswer, TwoOpposedContactsSqueezeOrHold) {
  MatrixXd A(2, 2);
  A << 1, -1,  //
      -1, 1;
  const LcpProblem squeezed = LcpProblem::FromDense("squeezed", A, Eigen::Vector2d(-1, -2), {}, SymmetricPsd());
  const LcpResult result = Solve(squeezed);
  ExpectProof(squeezed, result);
  EXPECT_NEAR((*result.farkas_ray)[0] / (*result.farkas_ray)[1], 1, 1e-12) << "the ray of both";
  const LcpProblem held = LcpProblem::FromDense("held", A, Eigen::Vector2d(-1, 1), {}, SymmetricPsd());
  ExpectSolved(held, Solve(held));
}

TEST_P(DirectSolversAnswer, EveryOracleProblemIsSolvedExactlyOrProved) {
  const std::vector<TestProblem> problems = OracleProblems();
  if (problems.empty()) GTEST_SKIP() << "the outside oracle data is not there";
  for (const TestProblem& test : problems) {
    Judge(test, Solve(test.problem));
  }
  ExpectUndecided(0);
}

TEST_P(DirectSolversAnswer, TheUnitProblemsOfAnotherEngineAreSolved) {
  const std::vector<LcpProblem> problems = RecordedUnitProblems();
  if (problems.empty()) GTEST_SKIP() << "the outside data is not there";
  int missed = 0;
  for (const LcpProblem& problem : problems) {
    const LcpResult result = Solve(problem);
    const Verdict verdict = Verify(problem, result, 1e-9);
    EXPECT_FALSE(verdict.false_success || verdict.false_infeasible) << problem.id() << ": " << verdict.reason;
    if (!verdict.passes) ++missed;
  }
  EXPECT_LE(missed, GetParam().unit_problems_missed);
}

// First-order methods included: whoever claims a solution has the w of all others.
TEST(Solvers, AllThatClaimSuccessAgreeInW) {
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kOwn || !entry.available) continue;
    const std::unique_ptr<LcpSolver> solver = entry.make({});
    LcpOptions options;
    options.max_iterations = entry.uses_tolerance ? 2000 : 0;  // sweeps
    int claims = 0;
    for (const ExactFamily& family : SolvableFamilies()) {
      for (unsigned seed = 0; seed < 15; ++seed) {
        const TestProblem test = family.make(seed);
        LcpResult result;
        solver->Solve(test.problem, options, &result);
        if (result.status != LcpStatus::kSolved) continue;
        ++claims;
        const Verdict verdict = Verify(test.problem, result, options.tolerance, &test.reference);
        EXPECT_FALSE(verdict.false_success) << entry.key << " on " << test.problem.id() << ": " << verdict.reason;
        EXPECT_LE(verdict.metrics.w_error, 1e-7) << entry.key << " on " << test.problem.id();
      }
    }
    EXPECT_GT(claims, 15) << entry.key;
  }
}

}  // namespace
}  // namespace lcpbench
