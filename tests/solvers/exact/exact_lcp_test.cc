// Exact answers: against the oracle's, against definitions on generated problems, and from no guess at all.

#include "solvers/exact/exact_lcp.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/measure/reference_solves.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;
using ExactStatus = ExactAnswer::Status;

std::vector<Rational> Exact(const Json& values) {
  std::vector<Rational> exact;
  for (const Json& value : values) exact.emplace_back(value.get<std::string>());
  return exact;
}

class ExactLcpTest : public testing::TestWithParam<bool> {
 protected:
  static ExactOptions Options() { return {.guess = GetParam() ? GuessBySolvers : decltype(ExactOptions::guess)()}; }
};

INSTANTIATE_TEST_SUITE_P(Guess, ExactLcpTest, testing::Bool(),
                         [](const auto& test) { return test.param ? "BySolvers" : "None"; });

TEST_P(ExactLcpTest, ReproducesEveryRecordOfTheOracle) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/tests/data/oracle/lcp.jsonl");
  int records = 0;
  for (std::string line; std::getline(file, line); ++records) {
    const Json expected = Json::parse(line);
    SCOPED_TRACE(expected["id"].get<std::string>());
    const ExactLcp problem = ParseExactLcp(line, "lcp.jsonl");
    const ExactAnswer answer = SolveExactly(problem, Options());
    EXPECT_EQ(FindFault(problem, answer), "");
    EXPECT_EQ(ToString(answer.status), expected["status"].get<std::string>());
    EXPECT_EQ(answer.rank, expected["rank_A"].get<Index>());
    EXPECT_TRUE(answer.rank_is_proved);
    if (answer.status != ExactStatus::kSolved) continue;
    EXPECT_EQ(answer.w, Exact(expected["w_exact"]));
    EXPECT_EQ(answer.f_least_norm, Exact(expected["f_minnorm_exact"]));
    EXPECT_EQ(answer.f_unique, expected["f_unique"].get<bool>());
    EXPECT_EQ(answer.nullity_on_active, expected["nullity_on_active"].get<Index>());
    EXPECT_EQ(answer.degenerate, expected["degenerate"].get<std::vector<Index>>());
  }
  EXPECT_EQ(records, 223);
}

TEST_P(ExactLcpTest, GeneratedProblemsHaveProvedAnswers) {
  for (const TestProblem& test : GeneratedProblems()) {
    if (test.problem.size() > 60) continue;
    SCOPED_TRACE(test.problem.id());
    const ExactLcp problem = ExactFrom(test.problem);
    const ExactAnswer answer = SolveExactly(problem, Options());
    EXPECT_EQ(FindFault(problem, answer), "");
    ASSERT_TRUE(answer.status == ExactStatus::kSolved || answer.status == ExactStatus::kInfeasible)
        << ToString(answer.status);
    if (answer.status == ExactStatus::kInfeasible) continue;
    ASSERT_EQ(answer.f_least_norm.size(), answer.f.size()) << answer.detail;
    EXPECT_TRUE(answer.f_unique.has_value());
    // Whatever else solves it is no shorter.
    const auto square = [](const auto& f) { return std::inner_product(f.begin(), f.end(), f.begin(), Rational(0)); };
    const Rational own = square(answer.f), least = square(answer.f_least_norm);
    EXPECT_LE(least, own);
    EXPECT_TRUE(answer.f_unique == false || least == own);
  }
}

// Redundant scenes are decided at rounding: doubles alone guess the active set wrong.
TEST_P(ExactLcpTest, ScenesOfEveryFamilyAreSolvedAndSolversAreNear) {
  for (const SceneFamily& scene : AllScenes()) {
    for (const int size : {10, 60}) {
      const LcpProblem given = AssembleContactLcp(GenerateScene(std::string(scene.key), size, 1)).problem;
      SCOPED_TRACE(given.id());
      const ExactLcp problem = ExactFrom(given);
      const ExactAnswer answer = SolveExactly(problem, Options());
      EXPECT_EQ(FindFault(problem, answer), "");
      if (answer.status == ExactStatus::kInfeasible) {
        // As their doubles say it, some closed rings of redundant contacts contradict themselves by a rounding.
        Rational size_of_terms = 0;
        for (size_t i = 0; i < answer.ray.size(); ++i) size_of_terms += abs(problem.b[i] * answer.ray[i]);
        EXPECT_GE(size_of_terms, 1e12);
        continue;
      }
      ASSERT_EQ(answer.status, ExactStatus::kSolved) << answer.detail;
      Eigen::VectorXd w;
      given.ComputeW(SolveBy("dantzig", given, 1e-12).f, &w);
      const Eigen::VectorXd root = given.DiagonalA().cwiseSqrt();
      for (Index i = 0; i < given.size(); ++i) w[i] -= answer.w[At(i)].convert_to<double>();
      const auto largest = [&root](const Eigen::VectorXd& x) { return x.cwiseQuotient(root).cwiseAbs().maxCoeff(); };
      EXPECT_LE(largest(w), 1e-9 * largest(given.b()));
    }
  }
}

ExactLcp Small(const char* line) { return ParseExactLcp(line, "small"); }

TEST(ExactLcp, FindFaultObjectsToEveryWrongNumber) {
  const ExactLcp problem = Small(R"({"A":[[2,1,3],[1,2,3],[3,3,6]],"b":[-1,"-1/3",-1]})");
  const ExactAnswer answer = SolveExactly(problem, {});
  ASSERT_EQ(answer.status, ExactStatus::kSolved);
  ASSERT_EQ(FindFault(problem, answer), "");
  const Rational little("1/1000000000000000000000000000000");
  for (size_t i = 0; i < 3; ++i) {
    for (std::vector<Rational> ExactAnswer::*part : {&ExactAnswer::w, &ExactAnswer::f, &ExactAnswer::f_least_norm}) {
      ExactAnswer wrong = answer;
      (wrong.*part)[i] += little;
      EXPECT_NE(FindFault(problem, wrong), "") << i;
    }
  }
}

TEST(ExactLcp, RaysAreExactAndJointsThatContradictThemselvesHaveOne) {
  for (const char* line :
       {R"({"A":[[1,-1],[-1,1]],"b":[-1,"1/3"]})", R"({"A":[[1,1],[1,1]],"b":[1,2],"bilateral":[0,1]})",
        R"({"A":[[0,0],[0,1]],"b":[-1,-1]})"}) {
    const ExactLcp problem = Small(line);
    const ExactAnswer answer = SolveExactly(problem, {});
    EXPECT_EQ(answer.status, ExactStatus::kInfeasible) << line;
    EXPECT_EQ(FindFault(problem, answer), "") << line;
    ExactAnswer wrong = answer;
    wrong.ray[0] += Rational(1, 1000003);
    EXPECT_NE(FindFault(problem, wrong), "") << line;
  }
}

TEST(ExactLcp, WhatIsNoPositiveSemidefiniteMatrixIsSaidToBeNone) {
  EXPECT_THROW(Small(R"({"A":[[1,2],[3,1]],"b":[1,1]})"), InputError);
  for (const char* line :
       {R"({"A":[[0,1],[1,0]],"b":[-1,-1]})", R"({"A":[[1,2],[2,1]],"b":[-1,-1]})", R"({"A":[[-1]],"b":[-1]})"}) {
    EXPECT_EQ(SolveExactly(Small(line), {}).status, ExactStatus::kNotSemidefinite) << line;
  }
}

TEST(ExactLcp, NoRowsAreSolvedWithRankZero) {
  for (const char* line : {R"({"A":[],"b":[]})", R"({"A":{"shape":[0,0],"row":[],"col":[],"val":[]},"b":[]})",
                           R"({"J":[],"invM":[],"b":[]})", R"({"J":[],"invM":["1/3"],"b":[]})"}) {
    const ExactLcp problem = Small(line);
    const ExactAnswer answer = SolveExactly(problem, {});
    EXPECT_EQ(answer.status, ExactStatus::kSolved) << line;
    EXPECT_EQ(answer.rank, 0) << line;
    EXPECT_TRUE(answer.rank_is_proved && answer.f_unique.value_or(false)) << line;
    EXPECT_EQ(FindFault(problem, answer), "") << line;
  }
}

TEST(ExactLcp, DoublesAreTheRationalsThatTheyAre) {
  // 0.1 is no tenth: 3 * 0.1 - 0.3 is not 0.
  const ExactLcp problem = Small(R"({"A":[[0.1]],"b":[-0.3]})");
  const ExactAnswer answer = SolveExactly(problem, {});
  EXPECT_NE(answer.f[0], 3);
  EXPECT_EQ(answer.f[0], Rational(0.3) / Rational(0.1));
  const ExactLcp exact = Small(R"({"A":[["1/10"]],"b":["-3/10"]})");
  EXPECT_EQ(SolveExactly(exact, {}).f[0], 3);
}

// Wherever the clock runs out, what is answered is right, and what is not is said to be open.
TEST(ExactLcp, TheTimeLimitEndsWhatIsKnownBesidesTheAnswerToo) {
  static int reads_left = 0;
  const ExactLcp problem = ExactFrom(PlantedProblem(14, 2, 1, 0, 3).problem);
  int open = 0;
  for (int reads = 1; reads < 40; ++reads) {
    reads_left = reads;
    ExactOptions options;
    options.time_limit_s = 1;
    options.now = [] { return --reads_left > 0 ? 0.0 : 2.0; };
    const ExactAnswer answer = SolveExactly(problem, options);
    EXPECT_EQ(FindFault(problem, answer), "") << reads;
    if (answer.status != ExactStatus::kSolved) {
      EXPECT_EQ(answer.status, ExactStatus::kTimeLimit) << reads;
    } else if (!answer.f_unique.has_value()) {
      ++open;
      EXPECT_NE(answer.detail.find("out of time"), std::string::npos) << reads;
    }
  }
  EXPECT_GT(open, 0);
}

// Power-of-two changes of units are exact, and so is the change of the answer.
TEST(ExactLcp, AnswersScaleWithTheUnits) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LcpProblem given = PlantedProblem(12, 3, seed, static_cast<int>(seed % 3), 4).problem;
    Eigen::VectorXd scale(given.size());
    for (Index i = 0; i < scale.size(); ++i) scale[i] = std::ldexp(1.0, static_cast<int>((seed * 7 + 5 * i) % 60) - 30);
    const ExactAnswer one = SolveExactly(ExactFrom(given), {});
    const ExactAnswer other = SolveExactly(ExactFrom(ScaleRows(given, scale, 1)), {});
    ASSERT_EQ(one.status, other.status);
    EXPECT_EQ(one.rank, other.rank);
    if (one.status != ExactStatus::kSolved) continue;
    EXPECT_EQ(one.f_unique, other.f_unique);
    EXPECT_EQ(one.nullity_on_active, other.nullity_on_active);
    for (Index i = 0; i < given.size(); ++i) {
      EXPECT_EQ(one.w[static_cast<size_t>(i)] * Rational(scale[i]), other.w[static_cast<size_t>(i)]);
    }
  }
}

}  // namespace
}  // namespace lcpbench
