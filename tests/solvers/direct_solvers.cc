#include "tests/solvers/direct_solvers.h"

namespace lcpbench {

const std::vector<DirectSolver>& DirectSolvers() {
  static const std::vector<DirectSolver> solvers = {
      {.name = "dantzig",
       .key = "dantzig",
       .iterations_per_row = 12,
       .warm_iterations = 0.1,
       .warm_part = 0.05,
       .undecided_rounded = 0.005,
       .row_limit = "max_rows"},
      {.name = "dantzig_most_negative",
       .key = "dantzig",
       .settings = {{"order", "most-negative"}},
       .iterations_per_row = 12,
       .warm_iterations = 0.1,
       .warm_part = 0.05,
       .undecided_rounded = 0.005,
       .unit_problems_missed = 3,
       .row_limit = "max_rows"},
      {.name = "lemke",
       .key = "lemke",
       .iterations_per_row = 6,
       .warm_iterations = 0.1,
       .warm_part = 0.05,
       .undecided_rounded = 0.006,  // 5 of 838 where the compiler fuses no operations
       .unit_problems_missed = 1,
       .row_limit = "max_rows"},
      {.name = "bpp_dense",
       .key = "bpp",
       .settings = {{"form", "dense"}},
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .undecided_rounded = 0.005,
       .powers_of_two_leave_zero_rows = false,
       .row_limit = "max_dense_rows"},
      {.name = "bpp_sparse",
       .key = "bpp",
       .settings = {{"form", "sparse"}},
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .undecided_rounded = 0.005,
       .powers_of_two_leave_zero_rows = false},
      {.name = "active_set",
       .key = "active-set",
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .undecided_rounded = 0.005,
       .powers_of_two_leave_zero_rows = false},
      {.name = "active_set_through_bodies",
       .key = "active-set",
       .settings = {{"form", "bodies"}},
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .undecided_rounded = 0.005,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
      {.name = "active_set_by_continuation",
       .key = "active-set",
       .settings = {{"continuation_rows", "1"}},
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .undecided_rounded = 0.005,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
      {.name = "semismooth_newton_by_continuation",
       .key = "semismooth-newton",
       .settings = {{"continuation_rows", "1"}},
       .rho = 1e-9,
       .undecided = 0.0005,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
      {.name = "semismooth_newton", .key = "semismooth-newton", .rho = 1e-9, .powers_of_two_leave_zero_rows = false},
      // Naming the backend that answered may allocate.
      {.name = "auto",
       .key = "auto",
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
      {.name = "ipm",
       .key = "ipm",
       .rho = 1e-9,
       .warm_iterations = 0,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
      {.name = "hybrid",
       .key = "hybrid",
       .rho = 1e-9,
       .warm_iterations = 1.1,
       .powers_of_two_leave_zero_rows = false,
       .allocates = true},
  };
  return solvers;
}

std::string NameOf(const testing::TestParamInfo<DirectSolver>& info) { return info.param.name; }

void DirectSolverTest::SetUp() {
  if (!FindSolver(GetParam().key).available) GTEST_SKIP() << GetParam().key << " is not in this build";
  solver_ = MakeSolver(GetParam().key, GetParam().settings);
}

LcpResult DirectSolverTest::Solve(const LcpProblem& problem, const LcpOptions& options) {
  LcpResult result;
  solver_->Solve(problem, options, &result);
  return result;
}

void DirectSolverTest::ExpectSolved(const TestProblem& test, const LcpResult& result) {
  const Verdict verdict = Verify(test.problem, result, 1e-9, &test.reference);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << test.problem.id() << ": " << result.detail;
  EXPECT_TRUE(verdict.passes) << test.problem.id() << ": " << verdict.reason;
  EXPECT_LE(verdict.metrics.rho, GetParam().rho) << test.problem.id();
  EXPECT_LE(verdict.metrics.w_error, 1e-8) << test.problem.id();
}

void DirectSolverTest::ExpectProof(const LcpProblem& problem, const LcpResult& result) {
  EXPECT_EQ(result.status, LcpStatus::kInfeasible) << problem.id() << ": " << result.detail;
  ASSERT_TRUE(result.farkas_ray.has_value()) << problem.id();
  const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
  EXPECT_TRUE(verdict.accepted) << problem.id() << ": " << verdict.reason;
}

void DirectSolverTest::Judge(const TestProblem& test, const LcpResult& result) {
  ++judged_;
  if (result.status == LcpStatus::kIterationLimit || result.status == LcpStatus::kNumericalFailure) {
    ++undecided_count_;
    undecided_ += " " + test.problem.id();
  } else if (test.reference.status == LcpReference::Status::kInfeasible) {
    ExpectProof(test.problem, result);
  } else {
    ExpectSolved(test, result);
  }
}

void DirectSolverTest::ExpectUndecided(double part) const {
  EXPECT_LE(undecided_count_, part * judged_) << "of " << judged_ << ":" << undecided_;
}

}  // namespace lcpbench
