// Principal pivoting on a dense tableau: closed forms, every padding, parts, guesses, units.

#include "solvers/pivoting/small_pivoting.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The problems have full rank; some have joints or degenerate rows.
LcpProblem Definite(Index n, unsigned seed) {
  const int bilateral_every = (seed / 1000 + seed) % 3 == 0 ? 7 : 0, degenerate_every = seed / 1000 % 2 == 0 ? 0 : 5;
  const auto bodies = static_cast<int>(2 * n);
  return InForm(PlantedProblem(n, bodies, seed, bilateral_every, degenerate_every).problem, MatrixForm::kDense);
}

class SmallPivotingTest : public testing::TestWithParam<InstructionSet> {};

TEST_P(SmallPivotingTest, SolvesDefiniteProblemsOfEverySize) {
  SmallPivoting tableau(GetParam());
  tableau.Reserve(SmallPivoting::kMaxRows);
  for (Index n = 1; n <= SmallPivoting::kMaxRows; ++n) {
    for (unsigned seed = 0; seed < (n <= 2 ? 200U : 5U); ++seed) {
      const LcpProblem problem = Definite(n, 1000 * seed + static_cast<unsigned>(n));
      VectorXd f(n);
      const auto [rho, rounding, rows_meet, rows_are_clear] = tableau.Solve(problem, {}, &f);
      EXPECT_LE(rho, 1e-13) << n;
      const Verdict verdict = Verify(problem, Claim(f), 1e-9);
      EXPECT_TRUE(verdict.passes) << n << ": " << verdict.reason;
      EXPECT_TRUE(rows_meet);
      EXPECT_LE(rounding, 1e-10);
      EXPECT_LE(verdict.metrics.rho, rho + rounding);
      EXPECT_NEAR(rho, verdict.metrics.rho, 1e-14);
      EXPECT_TRUE(n > 2 || tableau.pivots() == 0) << "one and two rows have closed forms";
    }
  }
}

TEST_P(SmallPivotingTest, GivesTheSameForcesFromAnyFormAndBySse2) {
  SmallPivoting tableau(GetParam());
  SmallPivoting narrow(InstructionSet::kSse2);
  for (SmallPivoting* each : {&tableau, &narrow}) each->Reserve(SmallPivoting::kMaxRows);
  for (Index n = 1; n <= SmallPivoting::kMaxRows; ++n) {
    const LcpProblem problem = Definite(n, static_cast<unsigned>(n));
    VectorXd f(n);
    VectorXd other(n);
    tableau.Solve(problem, {}, &f);
    narrow.Solve(problem, {}, &other);
    EXPECT_LE((f - other).cwiseAbs().maxCoeff(), 1e-12 * (1 + f.cwiseAbs().maxCoeff())) << n;
    for (const MatrixForm form : {MatrixForm::kDense, MatrixForm::kSparse}) {
      const LcpProblem given = InForm(problem, form);
      const ProblemArrays arrays = ProblemArrays::Of(given);
      MatrixArrays matrix;
      ASSERT_TRUE(matrix.Take(arrays));
      tableau.SolveMatrix(matrix, {}, other.data());
      EXPECT_EQ(f, other) << n;
    }
  }
}

// Half as many degrees of freedom as rows: most active sets leave violated rows that depend on them. Principal pivoting
// exchanges nearly all of these; the other rules leave a quarter of the problems to the caller.
TEST_P(SmallPivotingTest, RowsThatDependOnOthersTakeTheirPlaces) {
  for (const auto& [rule, least_solved] :
       {std::pair(TableauRule::kMostViolated, 0.99), std::pair(TableauRule::kDriven, 0.7),
        std::pair(TableauRule::kAlongPath, 0.7)}) {
    SmallPivoting tableau(GetParam(), rule);
    tableau.Reserve(SmallPivoting::kMaxRows);
    int solved = 0;
    int problems = 0;
    for (Index n = 6; n <= SmallPivoting::kMaxRows; n += 6) {
      for (unsigned seed = 0; seed < 20; ++seed, ++problems) {
        const LcpProblem problem =
            PlantedProblem(n, static_cast<int>(n / 6), 100 * seed + static_cast<unsigned>(n), 5, 4).problem;
        VectorXd f(n);
        const SmallPivoting::Answer answer = tableau.Solve(problem, {}, &f);
        if (!(answer.rho <= 1e-9)) continue;
        ++solved;
        EXPECT_LE(ComputeMetrics(problem, f).rho, answer.rho + answer.rounding) << n << ' ' << seed;
      }
    }
    EXPECT_GE(solved, least_solved * problems) << static_cast<int>(rule);
  }
}

// Each way of choosing pivots ends at the one solution of a definite problem.
TEST_P(SmallPivotingTest, DrivenRowsAndLemkesPathEndAtTheSamePoint) {
  SmallPivoting principal(GetParam());
  principal.Reserve(SmallPivoting::kMaxRows);
  for (const TableauRule rule : {TableauRule::kDriven, TableauRule::kAlongPath}) {
    SmallPivoting tableau(GetParam(), rule);
    tableau.Reserve(SmallPivoting::kMaxRows);
    for (Index n = 1; n <= SmallPivoting::kMaxRows; ++n) {
      for (unsigned seed = 0; seed < (n <= 3 ? 100U : 5U); ++seed) {
        const LcpProblem problem = Definite(n, 1000 * seed + static_cast<unsigned>(n));
        VectorXd expected(n);
        principal.Solve(problem, {}, &expected);
        VectorXd f(n);
        EXPECT_LE(tableau.Solve(problem, {}, &f).rho, 1e-13) << n << ' ' << seed;
        EXPECT_LE((f - expected).cwiseAbs().maxCoeff(), 1e-11 * (1 + expected.cwiseAbs().maxCoeff())) << n;
        // Rows with a force have entered, joints and those of a force by rounding apart.
        const auto active = (f.array().abs() > 1e-9).count();
        EXPECT_GE(tableau.pivots(), active - static_cast<Index>(problem.bilateral_rows().size())) << n;
      }
    }
  }
}

TEST_P(SmallPivotingTest, APartIsSolvedAsTheProblemOfItsRows) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::vector<LcpProblem> parts;
    for (unsigned k = 0; k < 4; ++k) {
      parts.push_back(PlantedProblem(4 + static_cast<Index>(k) * 5, 12, 10 * seed + k, 4, 3).problem);
    }
    const LcpProblem problem = Compose(parts, seed);
    Islands islands;
    islands.Reserve(problem.size());
    islands.Find(problem.SparseA(), std::vector<char>(static_cast<size_t>(problem.size()), 1));
    SmallPivoting tableau(GetParam());
    tableau.Reserve(64, problem.size());
    VectorXd whole = VectorXd::Zero(problem.size());
    for (Index k = 0; k < islands.count(); ++k) {
      const auto rows = islands.rows(k);
      const double rho = tableau.SolvePart(problem, rows, {}, &whole).rho;
      const LcpProblem part = Subproblem(problem, rows);
      VectorXd f(part.size());
      EXPECT_EQ(tableau.Solve(part, {}, &f).rho, rho);
      for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(f[static_cast<Index>(i)], whole[rows[i]]);
    }
  }
}

TEST_P(SmallPivotingTest, ARightGuessNeedsNoTableauAndAWrongOneDoesNoHarm) {
  SmallPivoting tableau(GetParam());
  tableau.Reserve(SmallPivoting::kMaxRows);
  for (Index n = 3; n <= SmallPivoting::kMaxRows; n += 7) {
    const LcpProblem problem = Definite(n, static_cast<unsigned>(n));
    VectorXd cold(n);
    tableau.Solve(problem, {}, &cold);
    VectorXd f(n);
    EXPECT_LE(tableau.Solve(problem, {1e-6, cold.data(), nullptr}, &f).rho, 1e-13);
    EXPECT_EQ(tableau.pivots(), 1);
    EXPECT_LE((f - cold).cwiseAbs().maxCoeff(), 1e-11 * (1 + cold.cwiseAbs().maxCoeff()));
    TestRandom random(static_cast<unsigned>(n));
    VectorXd wrong(n);
    for (Index i = 0; i < n; ++i) wrong[i] = random.Integer(-1, 1);
    EXPECT_LE(tableau.Solve(problem, {1e-6, wrong.data(), nullptr}, &f).rho, 1e-13);
    EXPECT_LE((f - cold).cwiseAbs().maxCoeff(), 1e-11 * (1 + cold.cwiseAbs().maxCoeff()));
  }
}

INSTANTIATE_TEST_SUITE_P(Machine, SmallPivotingTest, testing::ValuesIn(AvailableInstructionSets()),
                         [](const auto& test) { return std::string(ToString(test.param)); });

}  // namespace
}  // namespace lcpbench
