// lcpbench recommend: the race, how measurements are ranked, and the command from files, scenes and sequences to C++
// that compiles.

#include <boost/algorithm/string/replace.hpp>

#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"
#include "benchmarks/recommend/race.h"
#include "benchmarks/recommend/recommendation.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ----- the race

// A solver as the race sees it, on a clock that only its passes move.
struct Planted {
  double step_s = 1e-3;  // of a step
  int wrong = 0;         // steps whose answers are not verified, though it claims success
  int spikes = 0;        // steps that take a hundred times as long
  std::string outcome = "completed";
  double hangs_s = 0;  // beyond what the pass may take, until it is killed
};

struct PlantedRace {
  std::map<std::string, Planted> planted;
  size_t steps = 100;
  RecommendationRequest request = {1e-6, {}, true};
  RaceOptions options = {};
  double now = 0;
  double most_allowed = 0;
  std::vector<std::string> order = {};  // of passes

  PassRun Pass(const SequenceRequest& asked) {
    const Planted& solver = planted.at(asked.solver);
    EXPECT_GT(asked.budget_s, 0);
    EXPECT_LE(asked.budget_s, options.budget_s - now);
    EXPECT_LE(asked.limits.least_s, asked.limits.most_s);
    EXPECT_LE(asked.limits.most_s, asked.budget_s);
    order.push_back(asked.solver);
    StepRecord record(asked.judged);
    SequenceReply reply;
    reply.outcome = solver.outcome;
    double spent = 0;
    for (size_t step = 0; step < steps && reply.outcome == "completed"; ++step) {
      const int k = static_cast<int>(step);
      const double latency = solver.step_s * (k < solver.spikes ? 100 : 1);
      if (spent + latency > asked.budget_s) {
        reply.outcome = "budget";
        spent = asked.budget_s;
        break;
      }
      spent += latency;
      LcpResult result;
      result.status = LcpStatus::kSolved;
      Verdict verdict;
      verdict.metrics.rho = verdict.metrics.backward_error = k < solver.wrong ? 1 : 1e-12;
      record.Add(result, latency, false, &verdict);
    }
    now += solver.hangs_s > 0 ? asked.budget_s + solver.hangs_s : spent;
    reply.results = record.Results(static_cast<int>(steps));
    return {reply, false};
  }

  std::vector<Assessment> Run() {
    std::vector<std::string> keys;
    for (const auto& [key, solver] : planted) keys.push_back(key);
    SequenceRequest base;
    base.tier = request.tolerance;
    base.judged = {1e-3, 1e-6, 1e-9};
    std::vector<Measurement> raced;
    for (const Measurement& measured : Race(
             keys, false, request, options, base, steps, [this](const SequenceRequest& asked) { return Pass(asked); },
             [this] { return now; })) {
      if (measured.passes > 0) raced.push_back(measured);
    }
    return RankMeasurements(raced, request);
  }
  int PassesOf(const std::string& key) const { return static_cast<int>(std::count(order.begin(), order.end(), key)); }
};

TEST(Race, TheFastestThatIsRightWinsAndWhoIsSlowOrWrongIsDroppedWhateverTheOrder) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 50; ++round) {
    PlantedRace race;
    std::vector<std::string> keys = {"a", "b", "c", "d", "e", "f"};
    std::shuffle(keys.begin(), keys.end(), random);
    race.planted[keys[0]] = {.step_s = 1e-3};
    race.planted[keys[1]] = {.step_s = 1.5e-3};
    race.planted[keys[2]] = {.step_s = 50e-3};
    race.planted[keys[3]] = {.step_s = 1e-6, .wrong = 1};
    race.planted[keys[4]] = {.step_s = 1e-6, .wrong = 100};
    race.planted[keys[5]] = {.step_s = 1e-6, .outcome = "crashed"};
    const std::vector<Assessment> ranked = race.Run();
    EXPECT_EQ(ranked[0].measured.solver, keys[0]);
    EXPECT_EQ(ranked[1].measured.solver, keys[1]);
    EXPECT_EQ(ranked[2].measured.solver, keys[2]);
    for (size_t k = 0; k < keys.size(); ++k) EXPECT_EQ(race.PassesOf(keys[k]), k < 2 ? 5 : 1) << k;
    EXPECT_EQ(ranked[2].measured.dropped, "50 x the median of " + keys[0]);
    for (const Assessment& each : ranked) {
      EXPECT_EQ(each.meets, each.verified == 1);
      if (each.measured.solver == keys[3]) {
        EXPECT_EQ(each.measured.dropped, "right on fewer steps than " + keys[0]);
      }
    }
  }
}

TEST(Race, WhereNoneIsRightOnAllStepsThoseOfTheLargestShareStay) {
  PlantedRace race{
      .planted = {{"few", {.wrong = 10}}, {"many", {.step_s = 1e-4, .wrong = 60}}, {"none", {.wrong = 100}}}};
  const std::vector<Assessment> ranked = race.Run();
  EXPECT_EQ(ranked[0].measured.solver, "few");
  EXPECT_FALSE(ranked[0].meets);
  EXPECT_EQ(race.PassesOf("few"), 5);
  EXPECT_EQ(race.PassesOf("many") + race.PassesOf("none"), 2);
}

// Steps are ranked by the tail: a median alone drops nobody.
TEST(Race, WhoHasTheBetterTailOrTheBetterMedianStays) {
  PlantedRace race{.planted = {{"spiky", {.step_s = 1e-4, .spikes = 5}}, {"steady", {.step_s = 9e-4}}}};
  EXPECT_EQ(race.Run()[0].measured.solver, "steady");
  EXPECT_EQ(race.PassesOf("spiky"), 5);
  race.request.by_tail = false;
  race.now = 0;
  EXPECT_EQ(race.Run()[0].measured.solver, "spiky");
  EXPECT_EQ(race.PassesOf("steady"), 6);
}

TEST(Race, PassesEndWithinTheBudgetAndASlowOneLeavesTimeForTheOthers) {
  std::mt19937_64 random(6);
  for (int round = 0; round < 60; ++round) {
    PlantedRace race;
    race.options.budget_s = 60;
    for (int k = 0; k < 8; ++k) {
      race.planted[std::string(1, static_cast<char>('a' + k))] = {
          .step_s = std::exp(std::uniform_real_distribution<double>(-12, 2)(random)),
          .wrong = static_cast<int>(random() % 3) * 20};
    }
    race.Run();
    EXPECT_LE(race.now, race.options.budget_s);
    EXPECT_GE(race.order.size(), race.planted.size());
  }
  PlantedRace race{.planted = {{"a-slow", {.step_s = 100}}, {"b", {.step_s = 1e-2}}, {"c", {.step_s = 2e-2}}}};
  const std::vector<Assessment> ranked = race.Run();
  EXPECT_EQ(ranked[0].measured.solver, "b");
  EXPECT_EQ(ranked.back().measured.solver, "a-slow");
  EXPECT_EQ(ranked.back().measured.outcome, "budget");
  EXPECT_EQ(race.PassesOf("b"), 5);
}

// Nor is a pass begun in later rounds that would not end in time: cut short, it would speak against its solver.
TEST(Race, WhoseTurnDoesNotComeHasNoPass) {
  PlantedRace race{.planted = {{"a", {.step_s = 0.1}}, {"b-hanging", {.outcome = "killed", .hangs_s = 40}}, {"c", {}}}};
  const std::vector<Assessment> ranked = race.Run();
  EXPECT_EQ(race.order, (std::vector<std::string>{"a", "b-hanging"}));
  ASSERT_EQ(ranked.size(), 2U);
  EXPECT_EQ(ranked[0].measured.solver, "a");
  EXPECT_EQ(ranked[0].measured.passes, 1);
  EXPECT_TRUE(ranked[0].meets);
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

TEST(Quantile, IsByWeight) {
  EXPECT_EQ(WeightedQuantile({{3, 1}, {1, 1}, {2, 1}}, 0.5), 2);
  EXPECT_EQ(WeightedQuantile({{4, 1}, {1, 1}, {2, 1}, {3, 1}}, 0.5), 2.5);
  EXPECT_EQ(WeightedQuantile({{1, 0.5}, {2, 0.5}, {3, 3}}, 0.5), 3);
  // Three variants of one base weigh as much as one problem: half of the weight is at 1, half at 5.
  EXPECT_EQ(WeightedQuantile({{1, 1}, {5, 1.0 / 3}, {5, 1.0 / 3}, {5, 1.0 / 3}}, 0.5), 3);
  EXPECT_EQ(WeightedQuantile({{1, 1}, {2, 1}, {3, 1}, {4, 1}}, 1), 4);
  EXPECT_EQ(WeightedQuantile({{1, 1}, {kInfinity, 2}}, 0.5), kInfinity);
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
  const auto expect = [&](const std::string& code, const std::vector<std::pair<const char*, bool>>& parts) {
    const CommandOutcome compiled = Compile(code);
    EXPECT_EQ(compiled.status, 0) << code << compiled.error;
    EXPECT_EQ(code.find('@'), std::string::npos) << code;
    for (const auto& [part, is_there] : parts) {
      EXPECT_EQ(code.find(part) != std::string::npos, is_there) << part << " in " << code;
    }
  };
  for (const bool warm : {false, true}) {
    for (const std::optional<double> deadline : {std::optional<double>(), std::optional<double>(1e-4)}) {
      const bool late = deadline.has_value();
      expect(EmbeddingCode("bpp", warm, {1e-6, deadline, true}),
             {{"initial_f", warm}, {"time_limit_s = 1e-04;", late}});
      const int p = warm == late ? 3 : 6;
      expect(StepEmbeddingCode({.rows = 77, .bodies = 33, .columns_per_body = p}, warm, {1e-6, deadline, true}),
             {{"StepOptions{.tolerance = 1e-06", true},
              {", .time_limit_s = 1e-04", late},
              {"forces_before", warm},
              {"most_rows = 77, lcpbench::Index most_bodies = 33", true},
              {"rows.columns_per_body = 6", p == 6}});
    }
  }
  using boost::algorithm::replace_first_copy;
  EXPECT_NE(Compile(replace_first_copy(EmbeddingCode("bpp", false, {}), "tolerance", "toleranse")).status, 0);
  EXPECT_NE(Compile(replace_first_copy(StepEmbeddingCode({}, false, {}), ".status", ".state")).status, 0);
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
  const std::optional<StepSizes> sizes = steps({bodies(4, 9, 3), bodies(7, 3, 3)});
  ASSERT_TRUE(sizes.has_value());
  EXPECT_EQ(std::tuple(sizes->rows, sizes->bodies, sizes->columns_per_body), std::tuple(7, 3, 3));
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
  // Recommends for `input`, as JSON.
  Json Recommend(const std::string& input) {
    const CommandOutcome outcome = Succeed("recommend --json --rounds 2 " + input);
    return Json::parse(outcome.out, nullptr, false);
  }
  static std::string ReasonOf(const Json& found, const std::string& solver) {
    for (const Json& one : found["not_tried"]) {
      if (one["solver"] == solver) return one["reason"];
    }
    return "";
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
  EXPECT_EQ(found["ranked_by"], "p50_s");
  EXPECT_GT(found["spent_s"], 0);
  EXPECT_EQ(found["budget_s"], 60);
  const Json& best = found["ranked"][0];
  EXPECT_EQ(found["recommended"], best["solver"]);
  EXPECT_TRUE(best["meets"]);
  EXPECT_LE(best["rho"], 1e-6);
  EXPECT_LE(best["p50_s"], best["p99_s"]);
  double before = 0;
  for (const Json& row : found["ranked"]) {
    EXPECT_EQ(row["start"], "cold");
    EXPECT_GE(row["passes"], 1);
    if (!row["meets"]) break;
    EXPECT_LE(before, row["p50_s"]);
    before = row["p50_s"];
  }
}

// Every solver of the registry either runs or is named with a reason.
TEST_F(RecommendCommand, WhatWasNotTriedIsNamedWithItsReason) {
  const Json small = Recommend("--scene disc-pile --size 8");
  const Json named = Recommend("--scene disc-pile --size 8 --candidates dantzig,pgs");
  for (const Json& found : {small, named}) {
    std::set<std::string> known;
    for (const char* list : {"ranked", "not_tried"}) {
      for (const Json& one : found[list]) EXPECT_TRUE(known.insert(one["solver"]).second) << one;
    }
    for (const SolverEntry& entry : AllSolvers()) {
      EXPECT_EQ(known.count(entry.key), 1U) << entry.key;
      const std::string reason = ReasonOf(found, entry.key);
      if (!entry.available) {
        EXPECT_EQ(reason, "not in this build");
      }
      if (entry.available && entry.origin == SolverOrigin::kPeer) {
        EXPECT_EQ(reason, "a peer: --peers tries it");
      }
    }
  }
  EXPECT_EQ(named["ranked"].size(), 2U);
  EXPECT_EQ(ReasonOf(named, "auto"), "not named by --candidates");
  const CommandOutcome text = Succeed("recommend --rounds 1 --scene disc-pile --size 8 --candidates dantzig");
  const auto not_named = std::count_if(AllSolvers().begin(), AllSolvers().end(), [&](const SolverEntry& entry) {
    return ReasonOf(named, entry.key) == "not named by --candidates";
  });
  EXPECT_GT(not_named, 7);
  ExpectPart(text.out, " and " + std::to_string(not_named + 1 - 8) + " more (not named by --candidates)");
  const Json large = Recommend("--scene disc-pile --size 5010 --candidates pgs --budget 4");
  EXPECT_TRUE(ReasonOf(large, "lemke").starts_with("not above n = 5000"));
}

TEST_F(RecommendCommand, FeaturesAreThoseOfManifestsAndOfIslands) {
  Write("two.jsonl", R"({"id":"diagonal","A":[[4,0,0],[0,1,0],[0,0,2]],"b":[-1,0,1]}
{"id":"ones","A":[[1,1],[1,1]],"b":[-1,-1],"bilateral":[1]}
{"id":"none","A":[],"b":[]}
)");
  const std::vector<Json> lines = Answers("recommend --features " + Path("two.jsonl"));
  ASSERT_EQ(lines.size(), 3U);
  for (const auto& [line, expected] :
       {std::pair{0, Json{{"problem", "diagonal"}, {"rows", 3}, {"islands", 3}, {"diagonal_spread", 4}, {"rank", 3}}},
        {1, Json{{"rows", 2}, {"bilateral", 1}, {"islands", 1}, {"largest_island", 1}, {"redundancy", 0.5}}},
        {2, Json{{"rows", 0}}}}) {
    for (const auto& [name, value] : expected.items()) EXPECT_EQ(lines[static_cast<size_t>(line)][name], value) << name;
  }
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
    ExpectPart(found["cpp"], part);
  }
}

TEST_F(RecommendCommand, ASequenceIsRunFromWarmStartsTooWhetherRecordedOrMoving) {
  Succeed("sequence gear-train --size 20 --steps 8 -o " + Path("gears.jsonl"));
  for (const std::string& input : {Path("gears.jsonl"), std::string("--scene newtons-cradle --size 18 --steps 8")}) {
    const Json found = Recommend(input + " --deadline 1s");
    EXPECT_GE(found["problems"], 8);
    ExpectHas(found, {{"samples", found["problems"]}, {"ranked_by", "p99_s"}, {"deadline_s", 1}});
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
  for (const int n : {2, 40}) {
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
    ExpectPart(found["note"], "solvers that take it: pgs, ");
    for (const Json& row : found["ranked"]) EXPECT_EQ(row["claims"].count("unsupported"), 0U) << row;
    EXPECT_TRUE(ReasonOf(found, "lemke").starts_with("A is not symmetric")) << found["not_tried"];
    const CommandOutcome text = Succeed("recommend --rounds 1 " + Path("other.jsonl"));
    ExpectPart(text.out, "note: A is not symmetric; solvers that take it: pgs, ");
  }
}

TEST_F(RecommendCommand, ReadersHaveTheirOptions) {
  Write("friction.dat", "2 2 0 4 4 4 4  4 9 1 9  9 9 9 9  1 9 3 9  9 9 9 9  -1 8 -2 8  0 0.5\n");
  EXPECT_EQ(Answer("convert " + Path("friction.dat"))["friction"]["mu"], Json({0.5}));
  EXPECT_EQ(Recommend(Path("friction.dat") + " --without-friction")["rows"], Json({2.0, 2.0}));
  Write("nearly.jsonl", R"({"id":"p","A":[[4,1.0625],[1,4]],"b":[-1,2]})");
  EXPECT_TRUE(Recommend(Path("nearly.jsonl") + " --symmetrize 0.1")["note"].is_null());
}

TEST_F(RecommendCommand, TheTextEndsWithLinesForCMakeUnlessNothingMeetsTheRequest) {
  const std::string arguments = "recommend --rounds 1 --scene rockers --size 18";
  const std::string late = arguments + " --deadline 1e-9";
  const CommandOutcome text = Succeed(arguments);
  EXPECT_TRUE(text.out.ends_with("target_link_libraries(your_engine PRIVATE lcpbench::step)\n")) << text.out;
  const CommandOutcome none = Succeed(late);
  for (const auto& [out, part] : {std::pair{text.out, "recommended: "},
                                  {text.out, "not tried: "},
                                  {none.out, "nothing that was tried meets the request; nearest: "},
                                  {none.out, "deadline missed in 100 % of the steps"}}) {
    ExpectPart(out, part);
  }
  EXPECT_EQ(none.out.find("MakeSolver"), std::string::npos) << none.out;
  EXPECT_TRUE(Json::parse(Run(late + " --json").out)["recommended"].is_null());
}

// In campaigns, too, a proof is a right answer.
TEST_F(RecommendCommand, AProofThatThereIsNoSolutionIsARightAnswer) {
  const std::string solvable = R"({"id":"ok","A":[[4,1],[1,3]],"b":[-1,-2]})";
  // A row that nothing moves, opposed rows, joints that contradict each other, and a row without an upper bound.
  for (const char* none : {R"({"id":"p","A":[[0]],"b":[-1]})", R"({"id":"p","A":[[1,-1],[-1,1]],"b":[1,-2]})",
                           R"({"id":"p","A":[[1,1],[1,1]],"b":[1,2],"bilateral":[0,1]})",
                           R"({"id":"p","A":[[0]],"b":[-1],"bounded":{"row":[0],"lower":[-1],"upper":[null]}})"}) {
    for (const int solved : {0, 1}) {
      SCOPED_TRACE(none);
      Write("none.jsonl", (solved > 0 ? solvable + "\n" : std::string()) + none + "\n");
      const Json found = Recommend(Path("none.jsonl") + " --candidates auto,pgs");
      EXPECT_EQ(found["recommended"], "auto");
      const Json& row = RowOf(found, "auto");
      ExpectHas(row, {{"verified", 1}, {"proofs", found["samples"].get<int>() - solved}, {"shortcoming", ""}});
      EXPECT_EQ(row["rho"].is_null(), solved == 0) << row;
    }
  }
  const CommandOutcome text = Succeed("recommend --rounds 1 --candidates auto " + Path("none.jsonl"));
  ExpectPart(text.out, "shows that 1 of 2 steps have no solution");
}

TEST(StepRecord, OnlyAnAcceptedProofIsARightAnswerWithoutForces) {
  LcpResult result;
  result.status = LcpStatus::kInfeasible;
  Verdict proof;
  proof.metrics.rho = proof.metrics.backward_error = 1;
  proof.farkas.emplace().accepted = true;
  Verdict refused = proof, solvable = proof, without = proof;
  refused.farkas->accepted = false;
  solvable.false_infeasible = true;
  without.farkas.reset();
  StepRecord record({1e-3, 1e-9});
  for (const Verdict& verdict : {proof, refused, solvable, without}) record.Add(result, 1, false, &verdict);
  record.Add(result, 1, false, nullptr);
  result.status = LcpStatus::kNumericalFailure;
  record.Add(result, 1, false, &proof);
  const Json found = record.Results(6);
  for (const Json& verdict : found["verdicts"]) EXPECT_EQ(verdict["failed_steps"], Json({1, 2, 3, 4, 5}));
  EXPECT_EQ(found["late"], Json({4}));
  EXPECT_EQ(found["rho"], Json({nullptr, 1, 1, 1, nullptr, 1}));
}

TEST_F(RecommendCommand, AHangingOrLyingCandidateEndsAsAnEvidenceAgainstIt) {
  const std::string problem = R"({"id":"one","A":[[2,1],[1,2]],"b":[-5,-6]})";
  Write("two.jsonl", problem + "\n" + problem + "\n");
  const Json found = Recommend(Path("two.jsonl") + " --candidates hanging,crashing,lying,dantzig --external hanging='" +
                               LCPBENCH_TEST_WORKER " hang' --external crashing='" LCPBENCH_TEST_WORKER
                                                    " crash' --external lying='" LCPBENCH_TEST_WORKER " lie'");
  EXPECT_EQ(found["recommended"], "dantzig");
  for (const char* bad : {"hanging", "crashing", "lying"}) {
    ExpectHas(RowOf(found, bad), {{"meets", false}, {"verified", 0}});
    EXPECT_NE(RowOf(found, bad)["shortcoming"], "");
  }
  EXPECT_EQ(RowOf(found, "lying")["false_successes"], 2);
}

}  // namespace
}  // namespace lcpbench
