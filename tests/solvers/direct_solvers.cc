#include "tests/solvers/direct_solvers.h"

namespace lcpbench {

namespace {

DirectSolver Pivoting(const char* name, const char* key, const Settings& settings, int iterations_per_row,
                      double undecided_rounded) {
  return {.name = name,
          .key = key,
          .settings = settings,
          .iterations_per_row = iterations_per_row,
          .warm_iterations = 0.1,
          .warm_part = 0.05,
          .undecided_rounded = undecided_rounded,
          .row_limit = "max_rows"};
}

// Solvers that end at the tolerance.
DirectSolver Iterative(const char* name, const char* key, const Settings& settings, double warm_iterations,
                       double undecided_rounded, bool allocates) {
  return {.name = name,
          .key = key,
          .settings = settings,
          .rho = 1e-9,
          .warm_iterations = warm_iterations,
          .undecided_rounded = undecided_rounded,
          .powers_of_two_leave_zero_rows = false,
          .allocates = allocates};
}

}  // namespace

const std::vector<DirectSolver>& DirectSolvers() {
  static const std::vector<DirectSolver> solvers = [] {
    std::vector<DirectSolver> all = {
        Pivoting("dantzig", "dantzig", {}, 12, 0.005),
        Pivoting("dantzig_most_negative", "dantzig", {{"order", "most-negative"}}, 12, 0.005),
        Pivoting("lemke", "lemke", {}, 6, 0.006),  // 5 of 838 where the compiler fuses no operations
        Iterative("bpp_dense", "bpp", {{"form", "dense"}}, 1.1, 0.005, false),
        Iterative("bpp_sparse", "bpp", {{"form", "sparse"}}, 1.1, 0.005, false),
        Iterative("active_set", "active-set", {}, 1.1, 0.005, false),
        Iterative("active_set_by_continuation", "active-set", {{"continuation_rows", "1"}}, 1.1, 0.005, true),
        Iterative("semismooth_newton_by_continuation", "semismooth-newton", {{"continuation_rows", "1"}}, 1, 0, true),
        Iterative("semismooth_newton", "semismooth-newton", {}, 1, 0, false),
        // One iteration an island; naming the backend that answered may allocate.
        Iterative("auto", "auto", {}, 4, 0, true),
        Iterative("ipm", "ipm", {}, 0, 0, true),
        Iterative("hybrid", "hybrid", {}, 1.1, 0, true),
    };
    all[3].row_limit = "max_dense_rows";
    all[7].undecided = 0.0005;
    std::erase_if(all, [](const DirectSolver& solver) { return !FindSolver(solver.key).available; });
    return all;
  }();
  return solvers;
}

std::string NameOf(const testing::TestParamInfo<DirectSolver>& info) { return info.param.name; }

void DirectSolverTest::SetUp() { solver_ = MakeSolver(GetParam().key, GetParam().settings); }

void DirectSolverTest::ExpectSolved(const TestProblem& test, const LcpResult& result) {
  const Verdict verdict = Verify(test.problem, result, 1e-9, &test.reference);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << test.problem.id() << ": " << result.detail;
  EXPECT_TRUE(verdict.passes) << test.problem.id() << ": " << verdict.reason;
  EXPECT_LE(verdict.metrics.rho, GetParam().rho) << test.problem.id();
  EXPECT_LE(verdict.metrics.w_error, 1e-8) << test.problem.id();
}

void DirectSolverTest::Judge(const TestProblem& test, const LcpResult& result) {
  ++judged_;
  if (result.status == LcpStatus::kIterationLimit || result.status == LcpStatus::kNumericalFailure) {
    ++undecided_count_;
    undecided_ += " " + test.problem.id();
  } else if (test.reference.status == LcpReference::Status::kInfeasible) {
    ExpectRay(test.problem, result);
  } else {
    ExpectSolved(test, result);
  }
}

void DirectSolverTest::ExpectUndecided(double part) const {
  EXPECT_LE(undecided_count_, part * judged_) << "of " << judged_ << ":" << undecided_;
}

}  // namespace lcpbench
