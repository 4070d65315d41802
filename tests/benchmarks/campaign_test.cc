// A campaign goes on whatever a solver's process does.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/benchmarks/command_fixture.h"

namespace lcpbench {
namespace {

using Row = std::map<std::string, std::string>;

// Cells with commas are quoted; quotes do not occur in them.
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<Row> ReadTable(const std::filesystem::path& path) {
  std::istringstream text(ReadFile(path));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> columns = Cells(line);
  std::vector<Row> rows;
  while (std::getline(text, line)) {
    const std::vector<std::string> cells = Cells(line);
    EXPECT_EQ(cells.size(), columns.size()) << line;
    Row row;
    for (std::size_t i = 0; i < std::min(cells.size(), columns.size()); ++i) row[columns[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

class Campaign : public CommandTest {
 protected:
  // The misbehaving worker under the key `key`; it may use half a gigabyte, so that exhausting it is quick.
  std::string External(const std::string& key, const std::string& manner) {
    Write(key + ".sh", "ulimit -v 524288\nexec " LCPBENCH_TEST_WORKER " " + manner + "\n");
    return " --external \"" + key + "=sh " + Path(key + ".sh") + "\"";
  }
};

TEST_F(Campaign, GoesOnAfterAWorkerThatCrashesHangsOrExhaustsMemory) {
  std::string externals;
  const std::map<std::string, std::string> manners = {{"crashing", "crash"}, {"crashing-early", "crash-in-prepare"},
                                                      {"hanging", "hang"},   {"hoarding", "memory"},
                                                      {"lying", "print"},    {"not-a-number", "nan"},
                                                      {"well", "dantzig"}};
  for (const auto& [key, manner] : manners) externals += External(key, manner);
  const CommandOutcome run =
      Run("run --suite quick --scenes disc-pile --sizes 6,9 --tiers 1e-6 --time-limit 0.1 --min-time 0.001"
          " --solvers crashing,crashing-early,hanging,hoarding,lying,not-a-number,well,dantzig" +
          externals + " -o " + Path("r"));
  ASSERT_EQ(run.status, 0) << run.error;

  const std::map<std::string, std::string> claims = {{"crashing", "numerical_failure"},
                                                     {"crashing-early", "numerical_failure"},
                                                     {"hanging", "time_limit"},
                                                     {"hoarding", "numerical_failure"},
                                                     {"lying", "solved"},
                                                     {"not-a-number", "solved"},
                                                     {"well", "solved"},
                                                     {"dantzig", "solved"}};
  const std::vector<Row> rows = ReadTable(folder_ / "r/accuracy.csv");
  EXPECT_EQ(rows.size(), 2 * claims.size());
  for (Row row : rows) {
    const std::string key = row["solver"];
    const bool good = key == "well" || key == "dantzig";
    // On a busy machine the time may run out before the memory does.
    const bool out_of_time = key == "hoarding" && row["claim"] == "time_limit";
    EXPECT_TRUE(out_of_time || row["claim"] == claims.at(key)) << key << ": " << row["claim"];
    EXPECT_EQ(row["passes"], good ? "true" : "false") << key;
    EXPECT_EQ(row["false_success"], key == "lying" || key == "not-a-number" ? "true" : "false") << key;
    EXPECT_EQ(row["reason"].empty(), good) << key;
    // What the process did is told, too.
    EXPECT_EQ(row["detail"].empty(), claims.at(key) == "solved") << key << row["detail"];
    if (key == "crashing") {
      EXPECT_NE(row["detail"].find("signal 11"), std::string::npos) << row["detail"];
    }
    if (key == "hanging") {
      EXPECT_NE(row["detail"].find("killed"), std::string::npos) << row["detail"];
    }
  }

  int timed = 0;
  int failed = 0;
  const nlohmann::json timing = nlohmann::json::parse(ReadFile(folder_ / "r/timing.json"));
  for (const nlohmann::json& entry : timing["benchmarks"]) {
    const std::string name = entry["name"];
    if (!name.starts_with("solve/") || entry["run_type"] != "iteration") continue;
    const bool good = name.find("/well/") != std::string::npos || name.find("/dantzig/") != std::string::npos;
    EXPECT_EQ(entry.value("error_occurred", false), !good) << name;
    (good ? timed : failed) += 1;
    if (good) {
      EXPECT_GT(entry["real_time"].get<double>(), 0) << name;
    } else {
      EXPECT_FALSE(entry["error_message"].get<std::string>().empty()) << name;
    }
  }
  EXPECT_GE(timed, 4);
  EXPECT_GE(failed, 12);

  const CommandOutcome report = Run("report " + Path("r") + " -o " + Path("page.html"));
  EXPECT_EQ(report.status, 0) << report.error;
  EXPECT_NE(ReadFile(folder_ / "page.html").find("hoarding"), std::string::npos);
  EXPECT_NE(ReadFile(folder_ / "page.csv").find("hanging,external,disc-pile,6,1e-6,time limit"), std::string::npos);
}

TEST_F(Campaign, EveryAnswerIsJudgedByItsProblemsFloor) {
  const CommandOutcome run =
      Run("run --suite quick --scenes tall-stacks,boxes-and-discs --sizes 8,20 --min-time 0.0001"
          " --solvers pgs,dantzig -o " +
          Path("r"));
  ASSERT_EQ(run.status, 0) << run.error;
  std::map<std::string, std::string> floors;
  for (const Row& row : ReadTable(folder_ / "r/problems.csv")) {
    floors[row.at("problem")] = row.at("floor");
    EXPECT_EQ(row.at("floor_solver"), "auto");
    EXPECT_GT(std::stod(row.at("floor")), 0);
    EXPECT_LT(std::stod(row.at("floor")), 1e-12);
  }
  EXPECT_EQ(floors.size(), 4u);
  const std::vector<Row> rows = ReadTable(folder_ / "r/accuracy.csv");
  ASSERT_EQ(rows.size(), 4u * 2 * 3);
  for (const Row& row : rows) {
    EXPECT_EQ(row.at("floor"), floors.at(row.at("problem")));
    EXPECT_FALSE(row.at("answer_floor").empty());
    EXPECT_EQ(row.at("at_floor"), "false");
  }
}

TEST_F(Campaign, AnswersAtTheFloorAreVerifiedAndTimed) {
  // Mass ratios of 1e6 put the floor at 7e-14, far above this tier.
  const CommandOutcome run =
      Run("run --suite quick --scenes tall-stacks --sizes 300 --tiers 1e-15 --min-time 0.0001"
          " --solvers dantzig,lemke -o " +
          Path("r"));
  ASSERT_EQ(run.status, 0) << run.error;
  const std::vector<Row> rows = ReadTable(folder_ / "r/accuracy.csv");
  ASSERT_EQ(rows.size(), 2u);
  for (const Row& row : rows) {
    EXPECT_EQ(row.at("passes"), "true") << row.at("reason");
    EXPECT_EQ(row.at("at_floor"), "true");
    EXPECT_EQ(row.at("false_success"), "false");
    EXPECT_GT(std::stod(row.at("rho")), 1e-15);
    EXPECT_LE(std::stod(row.at("rho")), std::stod(row.at("floor")));
  }
  // Both passes judge alike: nothing was left out of the timing.
  int timed = 0;
  const nlohmann::json timing = nlohmann::json::parse(ReadFile(folder_ / "r/timing.json"));
  for (const nlohmann::json& entry : timing["benchmarks"]) {
    EXPECT_FALSE(entry.value("error_occurred", false)) << entry.dump();
    timed += entry["name"].get<std::string>().starts_with("solve/") ? 1 : 0;
  }
  EXPECT_GE(timed, 2);

  const CommandOutcome report = Run("report " + Path("r") + " -o " + Path("page.html"));
  EXPECT_EQ(report.status, 0) << report.error;
  EXPECT_NE(ReadFile(folder_ / "page.html").find("2 runs passed thanks to it only"), std::string::npos);
}

TEST_F(Campaign, StricterTiersAreNotTriedAfterTheTimeRanOut) {
  const CommandOutcome run = Run("run --suite quick --scenes disc-pile --sizes 6 --time-limit 0.1 --solvers hanging" +
                                 External("hanging", "hang") + " -o " + Path("r"));
  ASSERT_EQ(run.status, 0) << run.error;
  const std::vector<Row> rows = ReadTable(folder_ / "r/accuracy.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("claim"), "time_limit");
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_EQ(rows[i].at("claim"), "");
    EXPECT_EQ(rows[i].at("excluded"), "out of time at the looser tier 1e-03");
  }
}

}  // namespace
}  // namespace lcpbench
