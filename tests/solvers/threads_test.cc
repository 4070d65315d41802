// Distinct solver objects on distinct threads: the same bits as on one thread, also where the threads share a problem
// whose derived forms nobody has asked for yet. And what a solve must leave as it was. To be run under the thread
// sanitizer, too (preset tsan).

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <barrier>
#include <cfenv>
#include <clocale>
#include <csignal>
#include <locale>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/registry.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

constexpr int kThreads = 4;
constexpr double kTolerance = 1e-6;

// Regular, redundant, with joints, degenerate, infeasible and larger ones, none of which has its derived forms yet.
std::vector<LcpProblem> FreshProblems() {
  std::vector<LcpProblem> problems;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    problems.push_back(PlantedProblem(12, 8, seed, 0, 0).problem.CopyOfGivenForm());
    problems.push_back(PlantedProblem(20, 3, seed, 5, 3).problem.CopyOfGivenForm());
    problems.push_back(PlantedProblem(60, 30, seed, 0, 4).problem.CopyOfGivenForm());
  }
  const LcpProblem base = PlantedProblem(10, 2, 3, 0, 0).problem;
  problems.push_back(
      LcpProblem::FromFactors("pulled-apart", base.J(), base.inverse_mass(), Eigen::VectorXd::Constant(10, -1.0)));
  return problems;
}

LcpResult SolveOne(LcpSolver* solver, const LcpProblem& problem) {
  return SolveWith(solver, problem, {.tolerance = kTolerance});
}

void ExpectSameBits(const LcpResult& expected, const LcpResult& actual) {
  EXPECT_EQ(expected.status, actual.status) << expected.detail << " | " << actual.detail;
  EXPECT_EQ(expected.f, actual.f);
  EXPECT_EQ(expected.iterations, actual.iterations);
  EXPECT_EQ(expected.farkas_ray, actual.farkas_ray);
}

class ThreadsTest : public SolverTest {
 protected:
  std::vector<LcpResult> OnOneThread(const std::vector<LcpProblem>& problems) const {
    std::vector<LcpResult> results;
    results.reserve(problems.size());
    for (const LcpProblem& problem : problems) results.push_back(SolveOne(solver_.get(), problem.CopyOfGivenForm()));
    return results;
  }

  // Thread t begins with problem t * stride.
  void RunOnThreads(size_t stride) const {
    const std::vector<LcpProblem> problems = FreshProblems();
    const std::vector<LcpResult> expected = OnOneThread(problems);
    std::array<std::vector<LcpResult>, kThreads> results;
    std::array<std::vector<LcpProblem>, kThreads> copies;  // which share storage
    copies.fill(problems);
    std::barrier start(kThreads);
    std::vector<std::thread> threads;
    for (size_t t = 0; t < kThreads; ++t) {
      threads.emplace_back([&, t] {
        const std::unique_ptr<LcpSolver> solver = GetParam().make({});
        results[t].resize(problems.size());
        start.arrive_and_wait();
        for (size_t k = 0; k < problems.size(); ++k) {
          const size_t at = (k + t * stride) % problems.size();
          results[t][at] = SolveOne(solver.get(), copies[t][at]);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::vector<LcpResult>& of_thread : results) {
      for (size_t k = 0; k < problems.size(); ++k) {
        SCOPED_TRACE(problems[k].id());
        ExpectSameBits(expected[k], of_thread[k]);
      }
    }
  }
};

TEST_P(ThreadsTest, ShareAProblemAtTheSameTime) { RunOnThreads(0); }
TEST_P(ThreadsTest, SolveDifferentProblemsAtTheSameTime) { RunOnThreads(2); }

// What belongs to the whole process and a solve must not change.
struct ProcessState {
  ProcessState() : locale(std::setlocale(LC_ALL, nullptr)), cpp_locale(std::locale().name()) {
    constexpr unsigned kStatusFlags = 0x3f;  // raised by any inexact operation
    control = _mm_getcsr() & ~kStatusFlags;
    std::array<char, 4096> directory{};
    working_directory = getcwd(directory.data(), directory.size()) != nullptr ? directory.data() : "";
    for (char** variable = environ; *variable != nullptr; ++variable) environment.emplace_back(*variable);
    for (int number = 1; number < NSIG; ++number) {
      struct sigaction action {};
      handlers.push_back(sigaction(number, nullptr, &action) == 0 ? action.sa_handler : nullptr);
    }
    for (int number = 1; number < NSIG; ++number) {
      sigset_t mask;
      sigprocmask(SIG_SETMASK, nullptr, &mask);
      blocked.push_back(sigismember(&mask, number));
    }
  }
  bool operator==(const ProcessState&) const = default;

  int rounding = std::fegetround();
  int trapped = fegetexcept();
  unsigned control = 0;  // of SSE: rounding, flush to zero, denormals are zero, traps
  std::string locale;
  std::string cpp_locale;
  std::string working_directory;
  std::vector<std::string> environment;
  std::vector<void (*)(int)> handlers;
  std::vector<int> blocked;
};

TEST_P(ThreadsTest, LeavesTheProcessAsItWas) {
  const std::vector<LcpProblem> problems = FreshProblems();
  const ProcessState before;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const std::unique_ptr<LcpSolver> solver = GetParam().make({});
    for (const LcpProblem& problem : problems) SolveOne(solver.get(), problem);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  const ProcessState after;
  EXPECT_EQ(before.rounding, after.rounding);
  EXPECT_EQ(before.control, after.control);
  EXPECT_EQ(before.locale, after.locale);
  EXPECT_EQ(before.environment, after.environment);
  EXPECT_EQ(before.handlers, after.handlers);
  EXPECT_TRUE(before == after);
}

INSTANTIATE_TEST_SUITE_P(Own, ThreadsTest, testing::ValuesIn(PlainSolversOf(SolverOrigin::kOwn)), SolverTestName);

}  // namespace
}  // namespace lcpbench
