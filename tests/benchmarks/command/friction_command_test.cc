// Problems with friction, sliding and bounded rows through the command: a set of them, a campaign, its report.

#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

constexpr const char* kOracle = LCPBENCH_SOURCE_DIR "/tests/data/oracle/friction.jsonl";

class FrictionCommand : public CommandTest {
 protected:
  // A set of the oracle's problems, whose records are `oracle_`, and of a plain one.
  void Import() {
    fs::create_directories(folder_ / "set");
    fs::copy_file(kOracle, folder_ / "set/friction.jsonl");
    Write("set/plain.jsonl", R"({"id": "plain", "A": [[2, 1], [1, 2]], "b": [-1, 3]})");
    Succeed("import " + Path("set") + " --provenance oracle --licence Apache-2.0");
    for (const Json& record : JsonLines(kOracle)) oracle_[record["id"]] = record;
  }

  std::map<std::string, Json> oracle_;
};

TEST_F(FrictionCommand, ASetKnowsWhatTheOracleKnows) {
  Import();
  std::size_t known = 0;
  const Json manifest = ReadJson(folder_ / "set/manifest.json");
  for (const Json& entry : manifest["problems"]) {
    if (!oracle_.contains(entry["id"])) {
      EXPECT_FALSE(entry.contains("friction") || entry.contains("bounded")) << entry.dump();
      continue;
    }
    const Json& record = oracle_[entry["id"]];
    EXPECT_EQ(entry.value("friction", 0U), record.contains("friction") ? record["friction"]["row"].size() : 0U);
    EXPECT_EQ(entry.value("bounded", 0U), record.contains("bounded") ? record["bounded"]["row"].size() : 0U);
    const Json& reference = entry["reference"];
    EXPECT_EQ(reference["kind"], "certified") << entry.dump();
    EXPECT_EQ(reference["status"], record["status"]) << entry.dump();
    // Above 4096 modes one solution is looked for, and nothing is said of others.
    if (record["status"] != "solved" || reference["f_unique"].is_null()) continue;
    EXPECT_EQ(reference["f_unique"], record["f_unique"]) << entry.dump();
    ++known;
  }
  EXPECT_GE(known, 70U);
}

// How a cell of a problem that is not plain is counted [docs/friction.md section 4].
void ExpectCountedRightly(const Json& cell, const Json& record) {
  const SolverEntry& solver = FindSolver(cell["solver"].get<std::string>());
  const bool is_taken =
      (!record.contains("friction") || solver.takes_friction) && (!record.contains("bounded") || solver.takes_bounded);
  const bool claims_solved = cell["claim"] == "solved";
  EXPECT_EQ(cell["excluded"], "");
  if (!is_taken) {
    EXPECT_EQ(cell["claim"], "unsupported");
    EXPECT_TRUE(cell["detail"] == "friction rows" || cell["detail"] == "bounded rows") << cell["detail"];
    EXPECT_FALSE(cell["passes"] || cell["false_success"] || cell["false_infeasible"]);
    EXPECT_TRUE(cell["rho"].is_null() && cell["fresh_s"].empty());
    return;
  }
  const double tier = cell["tier"];
  const bool has_model = cell.contains("model_rho") && cell["model_rho"].is_number();
  EXPECT_EQ(has_model, solver.key == "relaxation" && cell["claim"] != "unsupported");
  // A wrong claim is about the solver's own model; whether it passes is about Coulomb's law.
  const bool is_wrong = has_model ? cell["model_rho"] > tier : cell["passes"] == false;
  EXPECT_EQ(cell["false_success"], claims_solved && is_wrong);
  EXPECT_TRUE(cell["passes"] == false || (cell["rho"] <= tier && record["status"] == "solved"));
  const bool has_solution = record["status"] == "solved";
  EXPECT_EQ(cell["w_error"].is_number(), has_solution && record["w_unique"] == true) << "of what is unique alone";
  EXPECT_EQ(cell["f_error"].is_number(), has_solution && record["f_unique"] == true);
  double sum = 0;
  for (const char* part : {"penetration", "adhesion", "separation", "cone", "dissipation", "joints", "beyond_bounds"}) {
    sum += std::pow(cell[part].get<double>(), 2);
  }
  const double squared = std::pow(cell["rho"].get<double>(), 2);
  constexpr double kDigits = 1e-3;  // four of them are written
  EXPECT_TRUE((0.5 - kDigits) * squared <= sum && sum <= (2 + kDigits) * squared) << sum << " " << squared;
}

TEST_F(FrictionCommand, ACampaignCountsByTheRulesAndReportsThemApart) {
  Import();
  Succeed("run --suite " + Path("set/manifest.json") +
          " --solvers pgs,relaxation,apgd,dantzig --launches 1 --time-limit 60 -o " + Path("c"));
  std::map<std::string, int> passed, relaxed;
  for (const Json& cell : CellsOf(folder_ / "c")) {
    SCOPED_TRACE(cell.dump());
    const auto record = oracle_.find(cell["problem"]);
    if (record == oracle_.end()) {
      EXPECT_EQ(cell["passes"], cell["solver"] != "relaxation" || cell["claim"] == "solved");
      continue;
    }
    // Above 4096 modes the set does not know whether w and f are unique.
    if (record->second["pieces"].is_array() && record->second["n"] > 12) continue;
    ExpectCountedRightly(cell, record->second);
    if (cell["passes"]) ++passed[cell["solver"]];
    if (cell["claim"] == "solved" && cell["passes"] == false && cell["false_success"] == false)
      ++relaxed[cell["solver"]];
  }
  EXPECT_GT(passed["pgs"], passed["relaxation"]);
  EXPECT_GT(passed["relaxation"], 0);
  EXPECT_EQ(relaxed.size(), 1U) << "solves its model and not Coulomb's law: the relaxation alone";
  for (const Json& problem : JsonLines(folder_ / "c/problems.jsonl")) {
    EXPECT_EQ(problem["counts"], problem["problem"] == "plain") << problem.dump();
  }

  Succeed("report " + Path("c") + " -o " + Path("report/index.html"));
  const std::string page = ReadFile(folder_ / "report/index.html");
  EXPECT_NE(page.find("<h2>Friction</h2>"), std::string::npos);
  const std::string summary = ReadFile(folder_ / "report" / "summary.md");
  EXPECT_NE(summary.find("## Friction"), std::string::npos);
  EXPECT_NE(summary.find("`dantzig`"), std::string::npos);
}

TEST_F(FrictionCommand, SolveNamesWhatIsRefusedAndJudgesARelaxedAnswerTwice) {
  std::map<std::string, int> refused, judged;
  for (const char* key : {"dantzig", "relaxation"}) {
    for (const Json& answer : Answers(std::string("solve --solver ") + key + " " + kOracle)) {
      if (answer["status"] == "unsupported") {
        ++refused[answer["detail"]];
      } else if (answer["status"] == "solved") {
        judged[key] += answer["verdict"]["passes"] == false && answer["verdict"]["model_rho"] < 1e-9;
        EXPECT_EQ(answer["verdict"]["false_success"], false) << answer.dump();
      }
    }
  }
  EXPECT_GT(refused["friction rows"], 70);
  EXPECT_GT(refused["sliding rows"], 0);
  EXPECT_GT(judged["relaxation"], 10);
}

TEST_F(FrictionCommand, OnlyWhoTakesTheRowsRaces) {
  Write("first.jsonl", Lines(ReadFile(kOracle)).front());
  const Json race = Answer("recommend --json --rounds 1 --budget 60 " + Path("first.jsonl"));
  for (const Json& ranked : race["ranked"]) {
    EXPECT_TRUE(FindSolver(ranked["solver"].get<std::string>()).takes_friction);
    EXPECT_EQ(ranked["law"], ranked["solver"] == "relaxation" ? "relaxed" : "Coulomb");
  }
  EXPECT_FALSE(race["ranked"].empty());
  for (const Json& left : race["not_tried"]) {
    const SolverEntry& solver = FindSolver(left["solver"].get<std::string>());
    const bool is_asked = solver.origin == SolverOrigin::kOwn && solver.available;
    EXPECT_EQ(left["reason"] == "friction rows", is_asked && !solver.takes_friction) << left;
  }
}

}  // namespace
}  // namespace lcpbench
