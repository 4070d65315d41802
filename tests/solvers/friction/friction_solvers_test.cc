// Solvers that take friction, on the records of the oracle: docs/friction.md section 11.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "solvers/exact/unique_forces.h"
#include "solvers/lcp/verify.h"
#include "solvers/pivoting/least_norm.h"
#include "solvers/registry.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

LcpResult SolveAt(LcpSolver* solver, const LcpProblem& problem, double tolerance, std::int64_t iterations = 2000) {
  return SolveWith(solver, problem, {.tolerance = tolerance, .max_iterations = iterations, .time_limit_s = 5});
}

class FrictionSolvers : public ::testing::TestWithParam<std::string> {
 protected:
  const std::unique_ptr<LcpSolver> solver_ = MakeSolver(GetParam());
};

// A solver may fail, but must not claim what does not hold.
TEST_P(FrictionSolvers, ClaimNothingFalse) {
  for (const FrictionRecord& record : FrictionRecords()) {
    for (const double tolerance : kTiers) {
      const LcpResult result = SolveAt(solver_.get(), record.problem(), tolerance);
      const Verdict verdict = Verify(record.problem(), result, tolerance, &record.parsed.reference);
      EXPECT_FALSE(verdict.false_success) << record.problem().id() << " " << verdict.reason;
      EXPECT_FALSE(verdict.false_infeasible) << record.problem().id();
      if (!record.is_solved() && result.model == FrictionModel::kCoulomb) {
        EXPECT_NE(result.status, LcpStatus::kSolved) << record.problem().id();
      }
    }
  }
}

TEST_P(FrictionSolvers, SameAnswersFromEveryForm) {
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpProblem& problem = record.problem();
    if (!record.is_solved() || !problem.has_factors() || record.json.value("w_unique", false) == false) continue;
    const LcpResult by_factors = SolveAt(solver_.get(), problem, 1e-9);
    const LcpResult by_matrix = SolveAt(solver_.get(), InForm(problem, MatrixForm::kDense), 1e-9);
    if (by_factors.status != LcpStatus::kSolved || by_matrix.status != LcpStatus::kSolved) continue;
    const Metrics one = ComputeMetrics(problem, by_factors.f);
    const Metrics other = ComputeMetrics(problem, by_matrix.f);
    EXPECT_LE((one.w - other.w).cwiseAbs().maxCoeff(), 1e-6 * (1 + problem.b().cwiseAbs().maxCoeff())) << problem.id();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FrictionSolvers,
                         ::testing::Values("auto", "lagged-bounds", "lemke", "mode-newton", "pgs", "psor", "relaxation",
                                           "shift"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(FrictionSolver, SweepsSolveMostRecords) {
  for (const char* key : {"pgs", "psor"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    int right = 0, solvable = 0;
    for (const FrictionRecord& record : FrictionRecords()) {
      if (!record.is_solved()) continue;
      ++solvable;
      const LcpResult result = SolveAt(solver.get(), record.problem(), 1e-9, 20'000);
      if (result.status != LcpStatus::kSolved) continue;
      ++right;
      EXPECT_LE(ComputeMetrics(record.problem(), result.f, &record.parsed.reference).w_error, 1e-6)
          << key << " " << record.problem().id();
    }
    EXPECT_GE(right, 9 * solvable / 10) << key;
  }
}

// Its w is unique: that of the record's `relaxation`, which another program has.
TEST(FrictionSolver, TheRelaxationIsThatOfTheRecords) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("relaxation");
  int compared = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.json.contains("models") || !record.json["models"].contains("relaxation")) continue;
    const LcpResult result = SolveAt(solver.get(), record.problem(), 1e-9, 0);
    ASSERT_EQ(result.status, LcpStatus::kSolved) << record.problem().id() << " " << result.detail;
    EXPECT_EQ(result.model, FrictionModel::kRelaxation);
    const Verdict verdict = Verify(record.problem(), result, 1e-9);
    EXPECT_LE(verdict.model_rho, 1e-9) << record.problem().id();
    const Eigen::VectorXd w = ToVector(record.json["models"]["relaxation"]["w_exact"]);
    EXPECT_LE((verdict.metrics.w - w).cwiseAbs().maxCoeff(), 1e-7 * (1 + record.problem().b().cwiseAbs().maxCoeff()))
        << record.problem().id();
    ++compared;
  }
  EXPECT_GE(compared, 55);
}

// What is known of plain problems is not said of others: their forces may be unique where rows of A are dependent.
TEST(FrictionSolver, UniqueAndLeastNormForcesAreOfPlainProblemsOnly) {
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.is_solved() || !record.json.contains("f_exact") || record.problem().is_plain()) continue;
    const Eigen::VectorXd f = ToVector(record.json["f_exact"]);
    EXPECT_FALSE(UniqueForces(record.problem(), f).has_value()) << record.problem().id();
    const LeastNormForces least = FindLeastNormForces(record.problem(), f);
    EXPECT_EQ(least.status, LcpStatus::kUnsupported) << record.problem().id();
    EXPECT_EQ(least.f, f);
  }
}

}  // namespace
}  // namespace lcpbench
