// lcpbench recommend: what is known of problems, which rules are taken, how measurements are ranked, and the command
// from files, scenes and sequences to C++ that compiles.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/measure/quantile.h"
#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"
#include "benchmarks/recommend/recommendation.h"
#include "benchmarks/recommend/rules.h"
#include "tests/benchmarks/command_fixture.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ----- features

// Bodies of mass 2, 8 and 4: the first lies on the ground and the second on it and on a shelf; the third hangs alone.
LcpProblem ThreeBodies(double arm) {
  SparseMatrix J(4, 9);
  J.insert(0, 1) = 1;
  if (arm != 0) J.insert(0, 2) = arm;
  J.insert(1, 1) = -1;
  J.insert(1, 4) = 1;
  J.insert(2, 4) = 1;
  J.insert(3, 6) = 1;
  Eigen::VectorXd inverse_mass(9);
  inverse_mass << 0.5, 0.5, 1, 0.125, 0.125, 0.5, 0.25, 0.25, 1;
  return LcpProblem::FromFactors("three", J, inverse_mass, Eigen::VectorXd::Constant(4, -1),
                                 RowBounds::WithBilateralRows(4, {3}));
}

TEST(ProblemFeatures, AreCountedExactlyAndNullWhereTheyAreNotKnown) {
  MatrixFacts of_rank_one;
  of_rank_one.rank = 1;
  const std::pair<LcpProblem, Json> cases[] = {
      // 2 + 3 + 2 + 1 entries in four rows; diagonal 0.625 to 0.125; three rows on two columns.
      {ThreeBodies(0),
       {{"rows", 4},
        {"bilateral", 0.25},
        {"couplings", 2},
        {"diagonal_spread", 5},
        {"islands", 2},
        {"largest_island", 0.75},
        {"mass_spread", 4},
        {"redundancy", 0.25}}},
      // An arm of rounding errors carries nothing.
      {ThreeBodies(1e-17), {{"redundancy", 0.25}}},
      {ThreeBodies(0.1), {{"redundancy", 0}}},
      {LcpProblem::FromDense("diagonal", Eigen::Vector3d(4, 1, 2).asDiagonal(), Eigen::Vector3d(-1, 0, 1)),
       {{"islands", 3}, {"diagonal_spread", 4}, {"mass_spread", nullptr}, {"redundancy", nullptr}}},
      {LcpProblem::FromDense("ones", Eigen::MatrixXd::Ones(2, 2), Eigen::Vector2d(-1, -1), {}, of_rank_one),
       {{"redundancy", 0.5}}}};
  for (const auto& [problem, expected] : cases) {
    Json found = Describe(MeasureFeatures(problem));
    EXPECT_EQ(found.size(), AllFeatures().size());
    for (const auto& [name, value] : expected.items()) EXPECT_EQ(found[name], value) << problem.id() << " " << name;
  }
}

// ----- rules

Json Region(double tier, double from, const Json& to, const std::vector<std::string>& candidates) {
  return {{"tier", tier},
          {"where", {{"rows", {from, to}}}},
          {"problems", 12},
          {"families", 4},
          {"candidates", candidates},
          {"peers", Json::array()},
          {"solvers", {{{"solver", "pgs"}, {"verified", 0.5}, {"within", 0.25}}}}};
}

Json Rules() {
  return {{"schema", "lcpbench-recommendation/1"},
          {"campaigns", {{{"name", "made-up"}, {"commit", "0123456789abcdef"}, {"cpu", "none"}}}},
          {"regions",
           {Region(1e-3, 0, nullptr, {"pgs"}), Region(1e-6, 0, 17, {"dantzig", "bpp"}),
            Region(1e-6, 17, nullptr, {"dantzig", "nncg"}), Region(1e-9, 0, nullptr, {"lemke"})}}};
}

// The last candidate of the region of so many rows.
std::string CandidateOf(const RecommendationRules& rules, double rows, double tolerance,
                        std::optional<double> redundancy = {}) {
  ProblemFeatures features;
  features.rows = rows;
  features.redundancy = redundancy;
  return FindRegion(rules, features, tolerance).candidates.back();
}

class RulesFile : public CommandTest {
 protected:
  RecommendationRules Read(const Json& json) const {
    Write("rules.json", json.dump());
    return ReadRecommendationRules(Path("rules.json"));
  }
};

TEST_F(RulesFile, TheRegionIsThatOfTheFeaturesAtTheLoosestTierThatIsStrictEnough) {
  const RecommendationRules rules = Read(Rules());
  EXPECT_EQ(CandidateOf(rules, 16, 1e-6), "bpp");
  EXPECT_EQ(CandidateOf(rules, 17, 1e-6), "nncg");
  EXPECT_EQ(CandidateOf(rules, 1e6, 1e-6), "nncg");
  EXPECT_EQ(CandidateOf(rules, 5, 1e-2), "pgs");
  EXPECT_EQ(CandidateOf(rules, 5, 1e-5), "bpp");     // 1e-3 would be too loose
  EXPECT_EQ(CandidateOf(rules, 5, 1e-12), "lemke");  // there is nothing stricter
  EXPECT_EQ(rules.made_of, "made-up (commit 0123456789ab, none)");
}

TEST_F(RulesFile, WhatIsNotKnownExcludesNoRegion) {
  Json json = Rules();
  json["regions"] = {Region(1e-6, 0, nullptr, {"lemke"}), Region(1e-6, 0, nullptr, {"pgs"})};
  json["regions"][0]["where"]["redundancy"] = {0.1, 1};
  EXPECT_EQ(CandidateOf(Read(json), 3, 1e-6), "lemke");
  EXPECT_EQ(CandidateOf(Read(json), 3, 1e-6, 0), "pgs");
}

TEST_F(RulesFile, MistakesNameFileAndField) {
  const std::tuple<std::string, Json, std::string> mistakes[] = {
      {"/regions/1/candidates/0", "danzig", ": expected the key of a solver, found \"danzig\""},
      {"/regions/0/tier", "strict", ": expected a number, found \"strict\""},
      {"/schema", "lcpbench-tuned/1", ": expected \"lcpbench-recommendation/1\", found \"lcpbench-tuned/1\""},
      {"/regions/0/where/colour", {0, 1}, ": expected a feature"},
      {"/regions/0/solvers/0/within", 7, ": expected a number of 0"},
      {"/regions", Json::array(), ": expected one region or more"},
      {"/regions/2/peers", Json::value_t::discarded, ": missing field, expected an array"}};
  for (const auto& [field, value, expected] : mistakes) {
    const Json::json_pointer place(field);
    Json json = Rules();
    json[place] = value;
    if (value.is_discarded()) json[place.parent_pointer()].erase(place.back());
    const std::string message = RefusalOf([&] { Read(json); });
    EXPECT_TRUE(message.starts_with(Path("rules.json") + ": " + field + expected)) << message;
  }
  EXPECT_NE(RefusalOf([] { ReadRecommendationRules("/nowhere/rules.json"); }).find("/nowhere/rules.json: cannot be"),
            std::string::npos);
}

TEST(CommittedRules, CoverEverySizeAtEveryTier) {
  const RecommendationRules rules = ReadRecommendationRules(LCPBENCH_SOURCE_DIR "/data/recommendation.json");
  for (const double rows : {1.0, 16.0, 17.0, 100.0, 5000.0, 1e6}) {
    for (const double tolerance : {1e-2, 1e-3, 1e-6, 1e-9, 1e-12}) EXPECT_NO_THROW(CandidateOf(rules, rows, tolerance));
  }
}

// ----- ranking

Measurement Measured(const std::string& solver, const std::vector<double>& latency_s, int passed = -1) {
  Measurement measured;
  measured.solver = solver;
  measured.outcome = "completed";
  measured.latency_s = latency_s;
  const int steps = static_cast<int>(latency_s.size());
  measured.passed = {{1e-3, steps}, {1e-6, passed < 0 ? steps : passed}, {1e-9, 0}};
  return measured;
}

// What is made of measurements: who comes first, and why the others do not meet the request.
using Ranking = std::vector<std::pair<std::string, std::string>>;
Ranking Rank(const std::vector<Measurement>& measurements, const RecommendationRequest& request) {
  Ranking ranking;
  for (const Assessment& each : RankMeasurements(measurements, request)) {
    EXPECT_EQ(each.meets, each.shortcoming.empty());
    ranking.emplace_back(each.measured.solver, each.shortcoming);
  }
  return ranking;
}

TEST(RankMeasurements, RanksStepsByTheTailAndOneProblemByTheMedianAndKeepsTheOrderOfEqualOnes) {
  const std::vector<Measurement> measurements = {Measured("steady", {3, 3, 3, 3, 3}),
                                                 Measured("spiky", {1, 1, 1, 1, 9}), Measured("a", {3, 3, 3, 3, 3})};
  EXPECT_EQ(Rank(measurements, {1e-6, {}, true}), (Ranking{{"steady", ""}, {"a", ""}, {"spiky", ""}}));
  EXPECT_EQ(Rank(measurements, {1e-6, {}, false}), (Ranking{{"spiky", ""}, {"steady", ""}, {"a", ""}}));
}

TEST(RankMeasurements, WhoFailsComesAfterWhoIsSlowAndSaysHow) {
  Measurement lying = Measured("lying", {1, 1, 1, 1}, 0);
  lying.passed[1e-3] = 0;
  lying.false_successes = 2;
  Measurement killed = Measured("killed", {kInfinity, kInfinity}, 0);
  killed.passed.clear();
  killed.outcome = "killed";
  killed.detail = "killed after 2 s in step 0 or soon after";
  EXPECT_EQ(Rank({killed, lying, Measured("loose", {.5, .5, .5, .5}, 0), Measured("mostly", {1, 1, 1, 1}, 3),
                  Measured("slow", {8, 8, 8, 8})},
                 {1e-6, 10.0, true}),
            (Ranking{{"slow", ""},
                     {"mostly", "fails 1 of 4 steps, meets 1e-3 only"},
                     {"loose", "meets 1e-3 only"},
                     {"lying", "not verified, claims success falsely"},
                     {"killed", "killed: killed after 2 s in step 0 or soon after"}}));
}

TEST(RankMeasurements, ADeadlineIsMetAtTheNinetyNinthPercentile) {
  std::vector<double> seldom_late(201, 1.0);
  seldom_late[0] = 5;
  std::vector<double> often_late(100, 0.5);
  std::fill_n(often_late.begin(), 4, 5.0);
  const std::vector<Measurement> measurements = {Measured("often", often_late), Measured("seldom", seldom_late)};
  EXPECT_EQ(Rank(measurements, {1e-6, 2.0, true}),
            (Ranking{{"seldom", ""}, {"often", "deadline missed in 4 % of the steps"}}));
  EXPECT_DOUBLE_EQ(RankMeasurements(measurements, {1e-6, 2.0, true})[1].in_time, 0.96);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(Quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(Quantile({10, 20}, 0.99), 19.9);
  EXPECT_DOUBLE_EQ(Quantile({7}, 0.99), 7);
  EXPECT_EQ(Quantile({1, kInfinity, kInfinity}, 0.75), kInfinity);
}

// ----- the lines of C++

class EmbeddingCodeTest : public CommandTest {
 protected:
  // Against the headers alone: what the linker needs, the test of the installed package has.
  CommandOutcome Compile(const std::string& code) {
    Write("engine.cc", code);
    program_ = LCPBENCH_COMPILER;
    return Run("-std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " LCPBENCH_SOURCE_DIR
               " -isystem " LCPBENCH_EIGEN_INCLUDE " " +
               Path("engine.cc"));
  }
};

TEST_F(EmbeddingCodeTest, CompilesInEveryFormUnlessAMemberIsWrong) {
  for (const bool warm : {false, true}) {
    for (const std::optional<double> deadline : {std::optional<double>(), std::optional<double>(1e-4)}) {
      const std::string code = EmbeddingCode("bpp", warm, {1e-6, deadline, true});
      const CommandOutcome compiled = Compile(code);
      EXPECT_EQ(compiled.status, 0) << code << compiled.error;
      EXPECT_EQ(code.find('@'), std::string::npos) << code;
      EXPECT_EQ(code.find("initial_f") != std::string::npos, warm);
      EXPECT_EQ(code.find("time_limit_s = 1e-04;") != std::string::npos, deadline.has_value()) << code;
    }
  }
  EXPECT_NE(
      Compile(boost::algorithm::replace_first_copy(EmbeddingCode("bpp", false, {}), "tolerance", "toleranse")).status,
      0);
}

TEST_F(EmbeddingCodeTest, OfStepsCompilesInEveryFormUnlessAMemberIsWrong) {
  for (const int p : {3, 6}) {
    for (const bool warm : {false, true}) {
      for (const std::optional<double> deadline : {std::optional<double>(), std::optional<double>(1e-4)}) {
        const std::string code =
            StepEmbeddingCode({.rows = 77, .bodies = 33, .columns_per_body = p}, warm, {1e-6, deadline, true});
        const CommandOutcome compiled = Compile(code);
        EXPECT_EQ(compiled.status, 0) << code << compiled.error;
        for (const auto& [part, is_there] : {std::pair{"@", false},
                                             {"StepOptions{.tolerance = 1e-06", true},
                                             {", .time_limit_s = 1e-04", deadline.has_value()},
                                             {"forces_before", warm},
                                             {"most_rows = 77, lcpbench::Index most_bodies = 33", true},
                                             {"rows.columns_per_body = 6", p == 6}}) {
          EXPECT_EQ(code.find(part) != std::string::npos, is_there) << part << " in " << code;
        }
      }
    }
  }
  EXPECT_NE(Compile(boost::algorithm::replace_first_copy(StepEmbeddingCode({}, false, {}), ".status", ".state")).status,
            0);
}

TEST(StepSizes, AreKnownWhereTheStepSolverTakesAllProblems) {
  const auto steps = [](const std::vector<LcpProblem>& problems) {
    std::vector<SequenceStep> made;
    for (const LcpProblem& problem : problems) made.push_back({problem, {}, {}});
    return FindStepSizes(made);
  };
  const auto bodies = [](Index rows, Index columns, int columns_per_body) {
    SparseMatrix J(rows, columns);
    for (Index i = 0; i < rows; ++i) J.insert(i, i % columns) = 1;
    MatrixFacts facts;
    facts.columns_per_body = columns_per_body;
    return LcpProblem::FromFactors("bodies", J, Eigen::VectorXd::Ones(columns), Eigen::VectorXd::Constant(rows, -1), {},
                                   facts);
  };
  const std::optional<StepSizes> sizes = steps({bodies(4, 9, 3), bodies(7, 3, 3), ThreeBodies(0)});
  ASSERT_TRUE(sizes.has_value());
  EXPECT_EQ(sizes->rows, 7);
  EXPECT_EQ(sizes->bodies, 3);
  EXPECT_EQ(sizes->columns_per_body, 3);
  EXPECT_EQ(steps({bodies(4, 12, 6)}).value().columns_per_body, 6);
  EXPECT_TRUE(steps({bodies(kMostStepRows, 9, 3)}).has_value());
  EXPECT_FALSE(steps({bodies(4, 9, 3), bodies(kMostStepRows + 1, 9, 3)}).has_value());
  EXPECT_FALSE(steps({bodies(4, 12, 3), bodies(4, 12, 6)}).has_value());
  EXPECT_FALSE(
      steps({LcpProblem::FromDense("A", Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(-1, -1))}).has_value());
  SparseMatrix of_three(1, 9);
  for (const Index column : {0, 3, 6}) of_three.insert(0, column) = 1;
  EXPECT_FALSE(steps({LcpProblem::FromFactors("three", of_three, Eigen::VectorXd::Ones(9), Eigen::VectorXd::Ones(1))})
                   .has_value());
}

// ----- the command

class RecommendCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    Write("rules.json", Rules().dump());
  }
  // Recommends for `input`, as JSON.
  Json Recommend(const std::string& input) {
    const CommandOutcome outcome = Succeed("recommend --json --rounds 2 --rules " + Path("rules.json") + " " + input);
    return Json::parse(outcome.out, nullptr, false);
  }
  static const Json& RowOf(const Json& found, const std::string& solver, const std::string& start = "cold") {
    for (const Json& row : found["ranked"]) {
      if (row["solver"] == solver && row["start"] == start) return row;
    }
    static const Json none;
    ADD_FAILURE() << "no row of " << solver << " in " << found.dump();
    return none;
  }
};

TEST_F(RecommendCommand, NamesASolverForAProblemFileWithItsEvidence) {
  Succeed("generate disc-pile --size 20 -o " + Path("pile.jsonl"));
  const Json found = Recommend(Path("pile.jsonl"));
  EXPECT_EQ(found["features"]["rows"], 20);
  EXPECT_EQ(found["ranked_by"], "p50_s");
  ASSERT_EQ(found["ranked"].size(), 2U);  // those of the rules, from cold starts
  const Json& best = found["ranked"][0];
  EXPECT_EQ(found["recommended"], best["solver"]);
  EXPECT_TRUE(best["meets"]);
  EXPECT_LE(best["rho"], 1e-6);
  EXPECT_LE(best["p50_s"], found["ranked"][1]["p50_s"]);
  EXPECT_LE(best["p50_s"], best["p99_s"]);
  EXPECT_NE(found["cpp"].get<std::string>().find("MakeSolver(\"" + best["solver"].get<std::string>() + "\")"),
            std::string::npos);
  // The same numbers for a scene, and for files of many problems.
  EXPECT_EQ(found["features"], Recommend("--scene disc-pile --size 20")["features"]);
  Json line = Json::parse(Succeed("recommend --features " + Path("pile.jsonl")).out);
  EXPECT_EQ(line.erase("problem"), 1U);
  EXPECT_EQ(line, found["features"]);
  // The first of what was not tried is what the rules know.
  EXPECT_EQ(found["not_tried"][0], (Json{{"solver", "pgs"}, {"rank", 1}, {"within", 0.25}}));
}

TEST_F(RecommendCommand, PrintsTheStepInterfaceWhereAutoTakesTwoBodiesARow) {
  Write("dense.jsonl", R"({"id":"one","A":[[2,1],[1,2]],"b":[-5,-6]})");
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {"--scene disc-pile --size 20", "auto", "StepSolver solver_{"},
      {"--scene disc-pile --size 1010", "auto", "MakeSolver(\"auto\")"},
      {"--scene disc-pile --size 20", "dantzig", "MakeSolver(\"dantzig\")"},
      {Path("dense.jsonl"), "auto", "MakeSolver(\"auto\")"}};
  for (const auto& [input, solver, part] : cases) {
    const Json found = Recommend(input + " --candidates " + solver);
    ASSERT_TRUE(found["cpp"].is_string()) << found.dump();
    EXPECT_NE(found["cpp"].get<std::string>().find(part), std::string::npos) << input << ": " << found["cpp"];
  }
}

TEST_F(RecommendCommand, ASequenceIsRunFromWarmStartsTooWhetherRecordedOrMoving) {
  Succeed("sequence gear-train --size 20 --steps 8 -o " + Path("gears.jsonl"));
  for (const std::string& input : {Path("gears.jsonl"), std::string("--scene newtons-cradle --size 18 --steps 8")}) {
    const Json found = Recommend(input + " --deadline 1s");
    EXPECT_GE(found["problems"], 8);
    EXPECT_EQ(found["samples"], found["problems"]);
    EXPECT_EQ(found["ranked_by"], "p99_s");
    EXPECT_EQ(found["deadline_s"], 1);
    EXPECT_EQ(RowOf(found, "dantzig", "warm")["in_time"], 1);
    for (const char* start : {"cold", "warm"}) EXPECT_EQ(RowOf(found, "dantzig", start)["verified"], 1);
  }
}

TEST_F(RecommendCommand, ProblemsWithoutRowsAreRecommendedFor) {
  const Json none = Recommend(LCPBENCH_SOURCE_DIR "/tests/data/reports/no-rows.jsonl");
  EXPECT_EQ(none["rows"], Json({0.0, 0.0}));
  EXPECT_TRUE(none["recommended"].is_string()) << none;
  Write("steps.jsonl", R"({"A":[],"b":[],"previous":[]}
{"A":[[1]],"b":[-1],"previous":[-1]}
{"A":[],"b":[],"previous":[]}
)");
  const Json steps = Recommend(Path("steps.jsonl"));
  EXPECT_EQ(steps["problems"], 3);
  EXPECT_EQ(steps["ranked"][0]["verified"], 1) << steps;
}

// Row diagonally dominant, so that projected Gauss-Seidel converges.
TEST_F(RecommendCommand, WhereAIsNotSymmetricThoseThatTakeItAreTriedAndNamed) {
  std::mt19937_64 random(7);
  for (const int n : {2, 5, 40}) {
    Json A = Json::array(), b = Json::array();
    for (int i = 0; i < n; ++i) {
      Json row = Json::array();
      for (int j = 0; j < n; ++j) row.push_back(i == j ? 2.0 * n : static_cast<double>(random() % 7) - 3.0);
      A.push_back(row);
      b.push_back(static_cast<double>(random() % 9) - 6.0);
    }
    A[0][1] = A[1][0].get<double>() + 1;
    Write("other.jsonl", Json{{"id", "p"}, {"A", A}, {"b", b}}.dump());
    const Json found = Recommend(Path("other.jsonl"));
    EXPECT_TRUE(found["recommended"].is_string()) << found;
    EXPECT_NE(found["note"].get<std::string>().find("solvers that take it: pgs, "), std::string::npos) << found["note"];
    for (const Json& row : found["ranked"]) EXPECT_EQ(row["claims"].count("unsupported"), 0U) << row;
    for (const Json& untried : found["not_tried"]) EXPECT_NE(untried["solver"], "lemke");
    const CommandOutcome text = Succeed("recommend --rounds 1 " + Path("other.jsonl"));
    EXPECT_NE(text.out.find("note: A is not symmetric; solvers that take it: pgs, "), std::string::npos) << text.out;
  }
}

TEST_F(RecommendCommand, ReadersHaveTheirOptions) {
  Write("friction.dat", "2 2 0 4 4 4 4  4 9 1 9  9 9 9 9  1 9 3 9  9 9 9 9  -1 8 -2 8  0 0.5\n");
  ExpectMistake("recommend " + Path("friction.dat"),
                "friction coefficients 0, or `lcpbench convert --without-friction`");
  EXPECT_EQ(Recommend(Path("friction.dat") + " --without-friction")["rows"], Json({2.0, 2.0}));
  Write("nearly.jsonl", R"({"id":"p","A":[[4,1.0625],[1,4]],"b":[-1,2]})");
  EXPECT_TRUE(Recommend(Path("nearly.jsonl") + " --symmetrize 0.1")["note"].is_null());
}

TEST_F(RecommendCommand, TheTextEndsWithLinesForCMakeUnlessNothingMeetsTheRequest) {
  const std::string arguments = "recommend --rounds 1 --scene rockers --size 18 --rules " + Path("rules.json");
  const std::string late = arguments + " --deadline 1e-9";
  const CommandOutcome text = Succeed(arguments);
  EXPECT_TRUE(text.out.ends_with("target_link_libraries(your_engine PRIVATE lcpbench::solvers)\n")) << text.out;
  const CommandOutcome none = Succeed(late);
  for (const auto& [out, part] : {std::pair{text.out, "recommended: "},
                                  {text.out, "not tried: "},
                                  {none.out, "nothing that was tried meets the request; nearest: "},
                                  {none.out, "deadline missed in 100 % of the steps"}}) {
    EXPECT_NE(out.find(part), std::string::npos) << out;
  }
  EXPECT_EQ(none.out.find("MakeSolver"), std::string::npos) << none.out;
  EXPECT_TRUE(Json::parse(Run(late + " --json").out)["recommended"].is_null());
  Write("none.jsonl", R"({"id":"none","A":[[0,0],[0,1]],"b":[-1,-1]})");
  const Json unsolvable = Recommend(Path("none.jsonl"));
  EXPECT_TRUE(unsolvable["recommended"].is_null());
  EXPECT_EQ(unsolvable["ranked"][0]["verified"], 0);
}

TEST_F(RecommendCommand, AHangingOrLyingCandidateEndsAsAnEvidenceAgainstIt) {
  const std::string problem = R"({"id":"one","A":[[2,1],[1,2]],"b":[-5,-6]})";
  Write("two.jsonl", problem + "\n" + problem + "\n");
  const Json found = Recommend(Path("two.jsonl") + " --candidates hanging,crashing,lying,dantzig --external hanging='" +
                               LCPBENCH_TEST_WORKER " hang' --external crashing='" LCPBENCH_TEST_WORKER
                                                    " crash' --external lying='" LCPBENCH_TEST_WORKER " lie'");
  EXPECT_EQ(found["recommended"], "dantzig");
  for (const char* bad : {"hanging", "crashing", "lying"}) {
    EXPECT_FALSE(RowOf(found, bad)["meets"]);
    EXPECT_EQ(RowOf(found, bad)["verified"], 0);
    EXPECT_NE(RowOf(found, bad)["shortcoming"], "");
  }
  EXPECT_EQ(RowOf(found, "lying")["false_successes"], 2);
}

TEST_F(RecommendCommand, MistakesAreOneLineAndStatusTwo) {
  Write("torn.jsonl", R"({"id":"a","A":[[1]],"b":[-1],"previous":[3]})");
  Write("empty.jsonl", "");
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"", "expected one FILE or --scene, found 0"},
      {"a.jsonl b.jsonl", "expected one FILE or --scene, found 2"},
      {"--scene disc-pile --deadline 3min", "--deadline: expected a time > 0"},
      {"--scene disc-pile --tolerance 2", "--tolerance: expected a number in (0, 1)"},
      {"--scene disc-pile --rounds 0", "--rounds: expected"},
      {"--scene disc-pile --candidates danzig", "danzig"},
      {"--scene disc-pyle", "disc-pyle"},
      {Path("nowhere.jsonl"), "cannot be opened"},
      {Path("empty.jsonl"), "is empty"},
      {Path("torn.jsonl"), "torn.jsonl:1: field 'previous': expected a row of the line before"},
      {"--scene disc-pile --rules " + Path("empty.jsonl"), "not valid JSON"}};
  for (const auto& [arguments, expected] : mistakes) ExpectMistake("recommend " + arguments, expected);
}

}  // namespace
}  // namespace lcpbench
