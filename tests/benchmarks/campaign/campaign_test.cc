// A campaign goes on whatever a solver's process does, and says what that was.

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/subprocess.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

class Campaign : public CommandTest {
 protected:
  static std::string Data(const std::string& set) {
    return "run --suite " LCPBENCH_SOURCE_DIR "/data/" + set + ".json";
  }

  // The misbehaving worker under the key `key`; it may use half a gigabyte, so that exhausting it is quick.
  std::string External(const std::string& key, const std::string& manner) {
    const std::string limit =
        SanitizerReservesMemory() ? "export ASAN_OPTIONS=$ASAN_OPTIONS:hard_rss_limit_mb=512" : "ulimit -v 524288";
    Write(key + ".sh", limit + "\nexec " LCPBENCH_TEST_WORKER " " + manner + "\n");
    return " --external \"" + key + "=sh " + Path(key + ".sh") + "\"";
  }

  std::vector<Json> Cells() { return CellsOf(folder_ / "r"); }

  // What the tables of `lcpbench analyse` say of a solver, by column.
  std::map<std::string, std::string> Coverage(const std::string& solver) {
    std::map<std::string, std::string> found;
    const std::vector<std::string> rows = Lines(ReadFile(folder_ / "r/analysis/coverage.csv"));
    const std::vector<std::string> columns = Split(rows.at(0), ',');
    for (const std::string& row : rows) {
      if (row.find("," + solver + ",") == std::string::npos || !found.empty()) continue;
      const std::vector<std::string> cells = Split(row, ',');
      for (std::size_t k = 0; k < cells.size(); ++k) found[columns.at(k)] = cells[k];
    }
    EXPECT_FALSE(found.empty()) << solver << " has no row";
    return found;
  }
};

TEST_F(Campaign, GoesOnAfterAWorkerThatCrashesHangsOrExhaustsMemory) {
  struct Manner {
    std::string manner, claim, detail;  // of the worker, of its solves, of what became of the process
  };
  const std::map<std::string, Manner> workers = {
      {"crashing", {"crash", "numerical_failure", "signal 11"}},
      {"crashing-early", {"crash-in-prepare", "numerical_failure", ""}},
      {"hanging", {"hang", "time_limit", "killed"}},
      {"hoarding", {"memory", "numerical_failure", ""}},
      {"lying", {"print", "solved", ""}},
      {"not-a-number", {"nan", "solved", ""}},
      {"well", {"dantzig", "solved", ""}},
  };
  std::string solvers = "dantzig", externals;
  for (const auto& [key, worker] : workers) {
    solvers += "," + key;
    externals += External(key, worker.manner);
  }
  Succeed(Data("smoke") + " --filter '(disc-pile|rockers)-n8-' --tiers 1e-6 --time-limit " +
          (SanitizerReservesMemory() ? "2" : "0.1") + " --launches 2 --solvers " + solvers + externals + " -o " +
          Path("r"));

  std::size_t judged = 0;
  for (const Json& cell : Cells()) {
    const std::string key = cell["solver"];
    ++judged;
    const bool good = key == "well" || key == "dantzig";
    const Manner& expected = workers.at(good ? "well" : key);
    // On a busy machine the time may run out before the memory does.
    const bool out_of_time = key == "hoarding" && cell["claim"] == "time_limit";
    EXPECT_TRUE(out_of_time || cell["claim"] == expected.claim) << cell.dump();
    EXPECT_EQ(cell["passes"], good) << cell.dump();
    EXPECT_EQ(cell["false_success"], key == "lying" || key == "not-a-number") << cell.dump();
    EXPECT_EQ(cell["reason"].get<std::string>().empty(), good) << cell.dump();
    // What failed is not timed. One of the two warms the other's pass, in turns.
    EXPECT_EQ(cell["fresh_s"].size(), good ? 1U : 0U) << cell.dump();
    // What the process did is told, too.
    const std::string detail = cell["detail"];
    EXPECT_EQ(detail.empty(), expected.claim == "solved") << cell.dump();
    EXPECT_NE(detail.find(expected.detail), std::string::npos) << detail;
  }
  EXPECT_EQ(judged, 2 * (workers.size() + 1));

  Succeed("analyse " + Path("r"));
  for (const auto& [key, worker] : workers) {
    const bool good = key == "well";
    ExpectHas(Coverage(key), {{"problems", "2"},
                              {"verified", good ? "2" : "0"},
                              {"false_successes", !good && worker.claim == "solved" ? "2" : "0"}});
  }
}

// What only explains is given up at once: its halves are not tried.
TEST_F(Campaign, AProcessThatHangsOnAnotherBIsWaitedForOnce) {
  const CommandOutcome outcome =
      Succeed(Data("smoke") + " --filter 'n8-' --tiers 1e-6 --time-limit 1 --launches 1 --no-fills --solvers again" +
              External("again", "again-hangs") + " -o " + Path("r"));
  std::map<std::string, Json> lines;
  for (const Json& line : JsonLines(folder_ / "r/streams.jsonl")) lines[line["kind"]] = line;
  EXPECT_EQ(lines.at("parts")["outcome"], "completed");
  EXPECT_EQ(lines.at("again")["outcome"], "crashed");
  EXPECT_GT(lines.at("again")["failed"].size(), 1U) << lines.at("again").dump();
  EXPECT_EQ(std::ranges::count(Lines(outcome.error), "hangs"), 1) << outcome.error;
  for (const Json& cell : Cells()) EXPECT_TRUE(cell["passes"]) << cell.dump();
}

// What a line has in arrays is of the problems in their order.
TEST_F(Campaign, EveryProblemHasItsOwnNumbers) {
  Succeed(Data("smoke") + " --filter 'n(8|40)-' --tiers 1e-6 --launches 1 --no-fills --solvers pgs -o " + Path("r"));
  ProblemSource problems(LCPBENCH_SOURCE_DIR "/data");
  const auto solver = MakeSolver("pgs");
  std::map<std::string, Json> cells;
  for (const Json& cell : Cells()) cells[cell["problem"]] = cell;
  std::set<Json> seen;
  for (const ManifestEntry& entry : ReadManifest(LCPBENCH_SOURCE_DIR "/data/smoke.json").problems) {
    const auto cell = cells.find(entry.id);
    if (cell == cells.end()) continue;
    const LcpProblem problem = problems.Get(entry);
    LcpResult answer;
    solver->Solve(problem, {.tolerance = 1e-6}, &answer);
    EXPECT_EQ(cell->second["iterations"], answer.iterations) << entry.id;
    EXPECT_EQ(cell->second["rho"], Json(RoundedNumber(Verify(problem, answer, 1e-6).metrics.rho))) << entry.id;
    seen.insert(cell->second["rho"]);
  }
  EXPECT_EQ(cells.size(), seen.size());  // no two alike
  EXPECT_GT(seen.size(), 10U);
}

TEST_F(Campaign, AnswersAtTheFloorAreVerifiedAndTimed) {
  // Mass ratios of 1e6 put the floor far above this tier.
  Succeed(Data("standard") + " --filter 'tall-stacks-n64-s1/' --tiers 1e-15 --launches 2" +
          " --no-fills --solvers dantzig,lemke -o " + Path("r"));
  const double floor = JsonLines(folder_ / "r" / "problems.jsonl").at(0)["floor"];
  EXPECT_GT(floor, 1e-14);
  const std::vector<Json> cells = Cells();
  ASSERT_EQ(cells.size(), 2U);
  for (const Json& cell : cells) {
    ExpectHas(cell, {{"passes", true}, {"at_floor", true}, {"false_success", false}});
    EXPECT_GT(cell["rho"], 1e-15);
    EXPECT_LE(cell["rho"], floor);
    EXPECT_EQ(cell["fresh_s"].size(), 2U) << cell.dump();
  }
  Succeed("analyse " + Path("r"));
  EXPECT_EQ(Coverage("dantzig")["at_floor"], "1");
}

TEST_F(Campaign, StricterTiersAreNotTriedAfterTheTimeRanOut) {
  const std::string campaign = Data("smoke") + " --filter disc-pile-n8- --time-limit 0.1 --solvers hanging" +
                               External("hanging", "hang") + " -o " + Path("r");
  Succeed(campaign);
  const std::vector<Json> cells = Cells();
  ASSERT_EQ(cells.size(), 3U);
  ExpectHas(cells[0], {{"tier", 1e-3}, {"claim", "time_limit"}, {"excluded", ""}});
  for (const std::size_t k : {1U, 2U}) {
    ExpectHas(cells[k], {{"claim", "excluded"}, {"excluded", "out of time at the looser tier 1e-03"}});
  }
  // What was not tried is no reason not to go on.
  Succeed(campaign + " --resume");
  EXPECT_EQ(Cells(), cells);
}

TEST_F(Campaign, WhoRunsOutOfTimeOnHalfOfTheFirstProblemsIsNotGivenTheOthers) {
  Succeed(Data("smoke") + " --filter n8- --tiers 1e-6 --time-limit 0.05 --launches 1 --no-fills --solvers hanging,pgs" +
          External("hanging", "hang") + " -o " + Path("r"));
  const std::size_t most = SolveLimits().most_late;
  std::map<std::string, std::size_t> tried, left_out;
  for (const Json& cell : Cells()) {
    const std::string solver = cell["solver"];
    ++(cell["excluded"] == "" ? tried : left_out)[solver];
    if (cell["excluded"] != "") {
      EXPECT_EQ(cell["excluded"], OutOfTimeRule(SolveLimits())) << cell.dump();
    }
  }
  EXPECT_EQ(tried["hanging"], most);
  EXPECT_GT(left_out["hanging"], 0U);
  EXPECT_EQ(left_out["pgs"], 0U);
}

// A solver whose time is over has been judged on one problem of the class; the others have no cell.
TEST_F(Campaign, WhoHasHadHisTimeForAClassHasNoTurnAtItsOtherProblems) {
  Succeed(Data("smoke") +
          " --filter n8- --tiers 1e-6 --launches 1 --no-fills --solvers dantzig,pgs --class-limit 1e-9 -o " +
          Path("r"));
  std::set<std::string> judged;
  for (const Json& cell : Cells()) EXPECT_TRUE(judged.insert(cell["solver"]).second) << cell.dump();
  EXPECT_EQ(judged.size(), 2U);
}

// Whoever takes longer than the limit is out of time, also with an answer: it is not timed, nor tried at stricter
// tiers.
TEST_F(Campaign, AnAnswerBeyondTheLimitIsOutOfTime) {
  Succeed(Data("smoke") + " --filter disc-pile-n40- --tiers 1e-3,1e-6 --time-limit 1e-6 --launches 1 --no-fills " +
          "--solvers pgs -o " + Path("r"));
  const std::vector<Json> cells = Cells();
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_TRUE(cells[0]["claim"] == "time_limit" || cells[0]["first_s"] > 1e-6) << cells[0].dump();
  EXPECT_TRUE(cells[0]["fresh_s"].empty()) << cells[0].dump();
  EXPECT_EQ(cells[1]["excluded"], OutOfTimeRule(1e-3)) << cells[1].dump();
}

TEST_F(Campaign, SolversThatAreNotInTheBuildAreNamedAndHaveNoCells) {
  const CommandOutcome run =
      Succeed(Data("smoke") + " --filter disc-pile-n8- --tiers 1e-3 --launches 1 -o " + Path("r"));
  std::set<std::string> with_cells;
  for (const Json& cell : Cells()) with_cells.insert(cell["solver"].get<std::string>());
  const Json campaign = ReadJson(folder_ / "r/campaign.json");
  EXPECT_GT(campaign["solvers"].size(), 14U);
  std::string missing;
  for (const std::string& line : Lines(run.error)) {
    if (line.starts_with("not in this build: ")) missing = line + ",";
  }
  for (const Json& solver : campaign["solvers"]) {
    const std::string key = solver["key"];
    const bool available = solver["available"];
    EXPECT_EQ(with_cells.count(key) == 1, available && FindSolver(key).takes_plain) << key;
    EXPECT_EQ(missing.find(" " + key + ",") == std::string::npos, available) << key << missing;
  }
}

// ----- which sizes a solver is not given

TEST(SizeLimits, ALimitIsTheLargestSizeThatIsRunAndSaysWhy) {
  for (const SolverEntry& entry : AllSolvers()) {
    SCOPED_TRACE(entry.key);
    const std::optional<SizeLimit> limit = SizeLimitOf(entry.method_class);
    EXPECT_EQ(SizeRefusal(entry, limit ? limit->largest : 1'000'000), "");
    if (!limit) continue;
    const std::string rule = SizeRefusal(entry, limit->largest + 1);
    EXPECT_EQ(rule, "not above n = " + std::to_string(limit->largest) + ": " + std::string(limit->reason));
  }
}

TEST(SizeLimits, AVariantIsOfItsBasesClass) {
  const auto status = [] {
    RegisterSolverVariant("dantzig-for-exclusion", "dantzig", {});
    return SizeRefusal(FindSolver("dantzig-for-exclusion"), 5001).empty() ? 1 : 0;
  };
  // In a process of its own, because other tests compare the registry with the command's.
  EXPECT_EXIT(std::exit(status()), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lcpbench
