// Units of mass and load, and the scale of single rows, change nothing but f and w accordingly: bit by bit for powers
// of two, and the verdict and w for any other factor, which rounds A.

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "tests/solvers/direct_solvers.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

class DirectSolversUnits : public DirectSolverTest {
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
};

// rho and the threshold of rays count a row of zeros in the units of b, so that its weight against the other rows
// depends on the units.
bool HasZeroRows(const LcpProblem& problem) { return (problem.DiagonalA().array() == 0).any(); }

INSTANTIATE_TEST_SUITE_P(All, DirectSolversUnits, testing::ValuesIn(DirectSolvers()), NameOf);

TEST_P(DirectSolversUnits, PowersOfTwoChangeNoPivotAndNoBitOfTheAnswer) {
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

void ForEachOf(std::span<const ExactFamily> families, unsigned seeds,
               const std::function<void(const TestProblem& test, unsigned seed)>& check) {
  for (const ExactFamily& family : families) {
    for (unsigned seed = 0; seed < seeds; ++seed) {
      const TestProblem test = family.make(seed);
      if (HasZeroRows(test.problem)) continue;
      SCOPED_TRACE(std::string(family.name) + " seed " + std::to_string(seed));
      check(test, seed);
    }
  }
}

TEST_P(DirectSolversUnits, PowersOfTenChangeNeitherVerdictNorW) {
  const auto check = [this](const TestProblem& test, unsigned /*seed*/) {
    const VectorXd ones = VectorXd::Ones(test.problem.size());
    for (const double unit : {1e-12, 1e12}) {
      JudgeRescaled(test, ones, unit, 1);
      JudgeRescaled(test, ones, 1, unit);
    }
  };
  ForEachOf(SolvableFamilies(), 40, check);
  ExpectUndecided(0);
  ForEachOf(UnsolvableFamilies(), 40, check);
  ExpectUndecided(GetParam().undecided_rounded);
}

TEST_P(DirectSolversUnits, AnyFactorsOfSingleRowsChangeNeitherVerdictNorW) {
  const auto check = [this](const TestProblem& test, unsigned seed) {
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

}  // namespace
}  // namespace lcpbench
