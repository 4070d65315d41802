#include "solvers/external/external_solver.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

ExternalSolverOptions Worker(const std::string& manner) {
  ExternalSolverOptions options;
  options.command = {LCPBENCH_TEST_WORKER, manner};
  options.start_limit_s = 10;
  options.prepare_limit_s = 10;
  options.grace_s = 0.2;
  return options;
}

LcpResult SolveWith(ExternalSolver& solver, const LcpProblem& problem, double time_limit_s = 5) {
  LcpOptions options;
  options.time_limit_s = time_limit_s;
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

const LcpProblem& AnyProblem() {
  static const LcpProblem problem = PlantedProblem(8, 4, 3, 2, 0).problem;
  return problem;
}

TEST(ExternalSolver, GivesTheBitsOfTheSameSolverInThisProcess) {
  ExternalSolver external(Worker("dantzig"));
  EXPECT_EQ(external.Greet().name, "dantzig");
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LcpProblem problem = PlantedProblem(15, 5, seed, 3, 0).problem;
    LcpResult here;
    MakeSolver("dantzig")->Solve(problem, {}, &here);
    const LcpResult there = SolveWith(external, problem);
    EXPECT_EQ(there.status, here.status);
    EXPECT_EQ(there.f, here.f);
    EXPECT_EQ(there.iterations, here.iterations);
    EXPECT_GT(there.own_solve_s, 0);
  }
}

TEST(ExternalSolver, RepetitionsAreAveragedInTheWorker) {
  ExternalSolver external(Worker("dantzig"));
  LcpOptions options;
  options.repetitions = 1000;
  LcpResult result;
  const double start = SteadyNow();
  external.Solve(AnyProblem(), options, &result);
  EXPECT_EQ(result.status, LcpStatus::kSolved);
  EXPECT_LE(1000 * result.own_solve_s, SteadyNow() - start);
}

struct Manner {
  const char* name;
  LcpStatus status;
  const char* detail;
};

// Every kind of bad worker leaves a status and a reason, and the next solve works again.
TEST(ExternalSolver, OutlivesAWorkerThatMisbehaves) {
  const Manner manners[] = {
      {"crash", LcpStatus::kNumericalFailure, "signal 11"},
      {"crash-in-prepare", LcpStatus::kNumericalFailure, "signal 6"},
      {"exit", LcpStatus::kNumericalFailure, "exit status 3"},
      {"throw", LcpStatus::kNumericalFailure, "the library gave up"},
      {"hang", LcpStatus::kTimeLimit, "was killed"},
  };
  for (const Manner& manner : manners) {
    SCOPED_TRACE(manner.name);
    ExternalSolver solver(Worker(manner.name));
    for (int time = 0; time < 2; ++time) {
      const LcpResult result = SolveWith(solver, AnyProblem(), 0.2);
      EXPECT_EQ(result.status, manner.status) << result.detail;
      EXPECT_NE(result.detail.find(manner.detail), std::string::npos) << result.detail;
      EXPECT_EQ(result.f.size(), AnyProblem().size());
      EXPECT_FALSE(Verify(AnyProblem(), result, 1e-9).false_success);
    }
  }
}

TEST(ExternalSolver, MemoryIsBounded) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more than any limit";
#endif
  ExternalSolverOptions options = Worker("memory");
  options.memory_limit = std::uint64_t{512} << 20U;
  ExternalSolver solver(options);
  const LcpResult result = SolveWith(solver, AnyProblem(), 20);
  EXPECT_EQ(result.status, LcpStatus::kNumericalFailure) << result.detail;
}

TEST(ExternalSolver, ClaimsAreJudgedLikeAnyOthers) {
  for (const char* manner : {"print", "nan"}) {
    ExternalSolver solver(Worker(manner));
    const LcpResult result = SolveWith(solver, AnyProblem());
    EXPECT_EQ(result.status, LcpStatus::kSolved) << manner;
    EXPECT_TRUE(Verify(AnyProblem(), result, 1e-9).false_success) << manner;
  }
}

TEST(ExternalSolver, WhatIsNoWorkerIsRefusedByName) {
  for (const char* manner : {"garbage", "mute"}) {
    ExternalSolverOptions options = Worker(manner);
    options.start_limit_s = 0.5;
    ExternalSolver solver(options);
    EXPECT_THROW(solver.Greet(), InputError) << manner;
    EXPECT_EQ(SolveWith(solver, AnyProblem()).status, LcpStatus::kNumericalFailure) << manner;
  }
  ExternalSolver missing({{"/no/such/program"}});
  try {
    missing.Greet();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/program"), std::string::npos);
  }
  EXPECT_THROW(ExternalSolver({}), InputError);
}

TEST(ExternalSolver, RegistersUnderAKeyOfItsOwn) {
  RegisterExternalSolver("test-worker", {LCPBENCH_TEST_WORKER, "dantzig"});
  const SolverEntry& entry = FindSolver("test-worker");
  EXPECT_EQ(entry.origin, SolverOrigin::kExternal);
  EXPECT_EQ(WorkerVersion("test-worker"), "1.0");
  LcpResult result;
  entry.make({})->Solve(AnyProblem(), {}, &result);
  EXPECT_TRUE(Verify(AnyProblem(), result, 1e-9).passes);
  EXPECT_THROW(RegisterExternalSolver("test-worker", {"x"}), InputError);
  EXPECT_THROW(RegisterExternalSolver("Bad Key", {"x"}), InputError);
  EXPECT_THROW(RegisterExternalSolver("empty", {}), InputError);
}

TEST(ExternalSolver, ThePythonExampleSolves) {
  if (std::system("/usr/bin/python3 -c 'import scipy' 2>/dev/null") != 0) GTEST_SKIP() << "SciPy is not installed";
  ExternalSolver solver({{"/usr/bin/python3", LCPBENCH_SOURCE_DIR "/examples/external_solver.py"}});
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const LcpProblem problem = PlantedProblem(12, 5, seed, 2, 0).problem;
    const LcpResult result = SolveWith(solver, problem, 20);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-6).passes) << Verify(problem, result, 1e-6).reason;
  }
}

}  // namespace
}  // namespace lcpbench
