#include "solvers/peers/protocol/external_solver.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

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

LcpResult SolveThere(ExternalSolver& solver, const LcpProblem& problem, double time_limit_s = 5) {
  return SolveWith(&solver, problem, {.time_limit_s = time_limit_s});
}

LcpResult SolveHere(const LcpProblem& problem) { return SolveBy("dantzig", problem); }

// How a worker fails; nothing where it does not.
template <typename Act>
std::optional<WorkerFailure::How> HowItFails(Act act) {
  try {
    act();
  } catch (const WorkerFailure& failure) {
    return failure.how();
  }
  return std::nullopt;
}

const LcpProblem& AnyProblem() {
  static const LcpProblem problem = PlantedProblem(8, 4, 3, 2, 0).problem;
  return problem;
}

TEST(ExternalSolver, GivesTheBitsOfTheSameSolverInThisProcess) {
  ExternalSolver external(Worker("dantzig"));
  EXPECT_EQ(external.Greet().name, "dantzig");
  const auto dantzig = MakeSolver("dantzig", {});
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LcpProblem problem = PlantedProblem(15, 5, seed, 3, 0).problem;
    const LcpResult here = SolveArraysWith(dantzig.get(), problem);  // a worker begins at arrays
    const LcpResult there = SolveThere(external, problem);
    EXPECT_EQ(there.status, here.status);
    EXPECT_EQ(there.f, here.f);
    EXPECT_EQ(there.iterations, here.iterations);
    EXPECT_GT(there.own_fresh_s, 0);
  }
}

TEST(ExternalSolver, AnotherBIsSolvedOnTheMatrixThatWasSent) {
  ExternalSolver external(Worker("dantzig"));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const LcpProblem problem = PlantedProblem(15, 5, seed, 3, 0).problem;
    SolveThere(external, problem);
    const LcpProblem other = problem.WithB(-problem.b());
    EXPECT_EQ(SolveThere(external, other).f, SolveHere(other).f);
    // And back: nothing of the other b is left.
    EXPECT_EQ(SolveThere(external, problem).f, SolveHere(problem).f);
  }
}

std::vector<ProblemArrays> Stream() {
  std::vector<ProblemArrays> stream;
  for (unsigned k = 0; k < 12; ++k) stream.push_back(ProblemArrays::Of(PlantedProblem(6 + k, 4, k, 2, 0).problem));
  return stream;
}

PassRequest Pass(PassKind kind, const std::vector<ProblemArrays>& stream) {
  PassRequest request;
  request.kind = kind;
  request.time_limit_s = 1;
  request.warm_up = {0, 5};
  request.order = {7, 1, 11, 2, 4};
  for (const std::uint32_t index : request.order) {
    request.other_b.push_back(-Eigen::Map<const Eigen::VectorXd>(stream[index].b.data(), stream[index].rows));
  }
  return request;
}

TEST(ExternalSolver, APassInTheWorkerGivesTheBitsOfOneHere) {
  const std::vector<ProblemArrays> stream = Stream();
  ExternalSolver external(Worker("dantzig"));
  external.LoadStream(stream);
  for (const PassKind kind : {PassKind::kFresh, PassKind::kParts, PassKind::kAgain}) {
    const PassRequest request = Pass(kind, stream);
    const PassReply there = external.RunPass(request, 10);
    const PassReply here = RunPass([] { return MakeSolver("dantzig"); }, stream, request);
    ASSERT_EQ(there.entries.size(), request.order.size());
    for (std::size_t k = 0; k < there.entries.size(); ++k) {
      EXPECT_EQ(there.entries[k].status, here.entries[k].status);
      EXPECT_EQ(there.entries[k].f, here.entries[k].f);
      EXPECT_GT(there.entries[k].seconds, 0);
    }
    ASSERT_TRUE(there.disturbance.has_value());
    EXPECT_GT(there.disturbance->probe_s, 0);
  }
  EXPECT_FALSE(external.is_version_1());
}

// Its frames are those of its version, and of problems it cannot be told of it is not asked; nor is one that takes no
// friction, and says so.
TEST(ExternalSolver, AWorkerOfAnOlderVersionIsSentPlainProblemsOnly) {
  const LcpProblem plain = PlantedProblem(8, 3, 2, 2, 0).problem;
  RowBounds bounds = plain.bounds();
  std::vector<Index> unilateral;
  for (Index row = 0; row < plain.size(); ++row) {
    if (!plain.is_bilateral(row)) unilateral.push_back(row);
  }
  bounds.bounded = {{unilateral[0], -1, 1}};
  const LcpProblem bounded = plain.WithBounds(bounds);
  bounds.friction = {{unilateral[1], unilateral[2], 0.5}};
  const LcpProblem friction = plain.WithBounds(bounds);
  for (const char* manner : {"version-1-given", "version-2", "version-3", "version-4", "dantzig"}) {
    ExternalSolver external(Worker(manner));
    for (const auto& [problem, rows] : {std::pair(&friction, "friction rows"), std::pair(&bounded, "bounded rows")}) {
      const LcpResult result = SolveThere(external, *problem);
      EXPECT_EQ(result.status, LcpStatus::kUnsupported) << manner;
      EXPECT_EQ(result.f.size(), problem->size());
      const std::string told = manner == std::string("dantzig") ? "" : ", for which its worker has to speak version 5";
      EXPECT_TRUE(result.detail.starts_with(rows + told)) << manner << ": " << result.detail;
    }
    const LcpResult result = SolveThere(external, plain);  // by the same worker
    EXPECT_EQ(result.status, LcpStatus::kSolved) << manner << ": " << result.detail;
    EXPECT_LE((result.f - SolveHere(plain).f).norm(), 1e-9 * result.f.norm()) << manner;
    const std::vector<ProblemArrays> stream = {ProblemArrays::Of(plain), ProblemArrays::Of(friction)};
    external.LoadStream(stream);
    PassRequest request;
    request.time_limit_s = 5;
    request.order = {0, 1};
    const PassReply reply = external.RunPass(request, 10);
    EXPECT_EQ(reply.entries[0].status, LcpStatus::kSolved) << manner;
    EXPECT_EQ(reply.entries[1].status, LcpStatus::kUnsupported) << manner;
  }
}

// The one that did it is for the caller to find; the stream is there again with the next worker.
TEST(ExternalSolver, APassSaysHowItsWorkerEndedAndTheNextGoesOn) {
  const std::vector<ProblemArrays> stream = Stream();
  for (const char* manner : {"crash-at-nine", "hang-at-nine"}) {
    ExternalSolver external(Worker(manner));
    external.LoadStream(stream);
    PassRequest request = Pass(PassKind::kFresh, stream);
    EXPECT_EQ(external.RunPass(request, 10).entries.size(), request.order.size());
    request.order.push_back(3);  // nine rows
    EXPECT_EQ(HowItFails([&] { external.RunPass(request, 0.2); }),
              std::string(manner) == "hang-at-nine" ? WorkerFailure::How::kTimeLimit : WorkerFailure::How::kEnded);
    request.order.pop_back();
    EXPECT_EQ(external.RunPass(request, 10).entries.size(), request.order.size());
  }
  ExternalSolver missing({{"/no/such/program"}});
  EXPECT_EQ(HowItFails([&] { missing.LoadStream(stream); }), WorkerFailure::How::kNotStarted);
}

TEST(ExternalSolver, AWorkerOfVersion1GetsTheFormItWantsAndFormingItIsTimedHere) {
  const std::vector<ProblemArrays> stream = Stream();
  for (const char* manner : {"version-1-dense", "version-1-sparse", "version-1-given"}) {
    SCOPED_TRACE(manner);
    ExternalSolver external(Worker(manner));
    EXPECT_TRUE(external.is_version_1());
    const LcpProblem problem = PlantedProblem(15, 5, 1, 3, 0).problem;
    const LcpResult here = SolveHere(problem);
    const LcpResult there = SolveThere(external, problem);
    EXPECT_EQ(there.status, LcpStatus::kSolved) << there.detail;
    EXPECT_LE((there.f - here.f).norm(), 1e-9 * here.f.norm());
    // 0.25 of conversion and 0.5 of the solve, as that worker says.
    EXPECT_GT(external.formed_on_host_s(), 0);
    EXPECT_DOUBLE_EQ(there.own_fresh_s, external.formed_on_host_s() + 0.25 + 0.5);
    external.LoadStream(stream);
    for (const PassKind kind : {PassKind::kFresh, PassKind::kParts, PassKind::kAgain}) {
      const PassRequest request = Pass(kind, stream);
      const PassReply reply = external.RunPass(request, 10);
      const PassReply wanted = RunPass([] { return MakeSolver("dantzig"); }, stream, request);
      ASSERT_EQ(reply.entries.size(), request.order.size());
      for (std::size_t k = 0; k < reply.entries.size(); ++k) {
        const PassEntry& entry = reply.entries[k];
        EXPECT_LE((entry.f - wanted.entries[k].f).norm(), 1e-9 * wanted.entries[k].f.norm());
        EXPECT_DOUBLE_EQ(entry.seconds, entry.problem_s + 0.25 + 0.5);
      }
      EXPECT_FALSE(reply.disturbance.has_value());  // such a worker cannot say
    }
  }
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
      const LcpResult result = SolveThere(solver, AnyProblem(), 0.2);
      EXPECT_EQ(result.status, manner.status) << result.detail;
      EXPECT_NE(result.detail.find(manner.detail), std::string::npos) << result.detail;
      EXPECT_EQ(result.f.size(), AnyProblem().size());
      EXPECT_FALSE(Verify(AnyProblem(), result, 1e-9).false_success);
    }
  }
}

// A problem that is larger than any buffer between the processes: the host waits within its writing, too.
TEST(ExternalSolver, AWorkerThatStopsWhileItTakesAProblemIsOverAtTheTimeLimitOfTheSolve) {
  const LcpProblem large = PlantedProblem(400, 4, 3, 2, 0).problem;
  for (const char* manner : {"stop-before-problem", "stop-within-problem", "stop-within-answer"}) {
    SCOPED_TRACE(manner);
    ExternalSolverOptions options = Worker(manner);
    options.prepare_limit_s = 1000;
    ExternalSolver solver(options);
    const LcpResult result = SolveThere(solver, InForm(large, MatrixForm::kDense), 0.1);
    EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << result.detail;
    EXPECT_NE(result.detail.find("gave no answer within 0."), std::string::npos) << result.detail;
  }
}

TEST(ExternalSolver, MemoryIsBounded) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more than any limit";
#endif
  ExternalSolverOptions options = Worker("memory");
  options.memory_limit = std::uint64_t{512} << 20U;
  ExternalSolver solver(options);
  const LcpResult result = SolveThere(solver, AnyProblem(), 20);
  EXPECT_EQ(result.status, LcpStatus::kNumericalFailure) << result.detail;
}

TEST(ExternalSolver, WhatIsNoWorkerIsRefusedByName) {
  for (const char* manner : {"garbage", "mute"}) {
    ExternalSolverOptions options = Worker(manner);
    options.start_limit_s = 0.5;
    ExternalSolver solver(options);
    EXPECT_THROW(solver.Greet(), InputError) << manner;
    EXPECT_EQ(SolveThere(solver, AnyProblem()).status, LcpStatus::kNumericalFailure) << manner;
  }
  ExternalSolver missing({{"/no/such/program"}});
  ExpectRefused([&] { missing.Greet(); }, "/no/such/program");
  EXPECT_THROW(ExternalSolver({}), InputError);
}

// Whatever a program does that is no worker, it is over at the start limit, and the message has the limit and its name.
TEST(ExternalSolver, AProgramThatNeverGreetsIsOverAtItsStartLimit) {
  for (const char* script : {"sleep 1000", "trap '' TERM; while :; do sleep 1; done", "sleep 1000 & wait",
                             "sleep 1000 & exit", "exec >&- <&-; sleep 1000"}) {
    SCOPED_TRACE(script);
    ExternalSolverOptions options{.command = {"/bin/sh", "-c", script}, .name = "mine", .start_limit_s = 0.25};
    ExternalSolver solver(options);
    const bool closes = std::string(script).find(">&-") != std::string::npos;
    ExpectRefused([&] { solver.Greet(); }, closes ? "mine" : "'mine' did not greet within its start limit of 0.25 s");
  }
}

TEST(ExternalSolver, AWorkerThatRefusesIsQuoted) {
  ExternalSolver solver({{LCPBENCH_TEST_WORKER, "refuse"}});
  ExpectRefused([&] { solver.Greet(); }, "expected speed in (0, 1)");
}

TEST(ExternalSolver, RegistersUnderAKeyOfItsOwn) {
  RegisterExternalSolver("test-worker", {LCPBENCH_TEST_WORKER, "dantzig"});
  const SolverEntry& entry = FindSolver("test-worker");
  EXPECT_EQ(entry.origin, SolverOrigin::kExternal);
  EXPECT_EQ(WorkerVersion("test-worker"), "1.0");
  ExpectSolved(AnyProblem(), SolveBy(entry.key, AnyProblem()));
  EXPECT_THROW(RegisterExternalSolver("test-worker", {"x"}), InputError);
  EXPECT_THROW(RegisterExternalSolver("Bad Key", {"x"}), InputError);
  EXPECT_THROW(RegisterExternalSolver("empty", {}), InputError);
}

TEST(ExternalSolver, ThePythonExampleSolves) {
  if (std::system("/usr/bin/python3 -c 'import scipy' 2>/dev/null") != 0) GTEST_SKIP() << "SciPy is not installed";
  ExternalSolver solver({{"/usr/bin/python3", LCPBENCH_SOURCE_DIR "/examples/external_solver.py"}});
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const LcpProblem problem = PlantedProblem(12, 5, seed, 2, 0).problem;
    const LcpResult result = SolveThere(solver, problem, 20);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
    EXPECT_TRUE(Verify(problem, result, 1e-6).passes) << Verify(problem, result, 1e-6).reason;
  }
}

}  // namespace
}  // namespace lcpbench
