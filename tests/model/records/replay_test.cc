#include "model/records/replay.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "support/input_error.h"
#include "tests/support/refusal.h"

namespace lcpbench::testing {
namespace {

nlohmann::json HandMade() {
  return nlohmann::json::parse(R"({"id": "disc-on-floor", "n": 1, "bodies": [
      {"name": "disc", "fixed": false, "m": 2, "I": 1, "x": 0, "y": 1.25, "angle": 0.5, "vx": 3, "vy": -0.5,
       "omega": -2, "ax": 0, "ay": -10, "alpha": 0},
      {"name": "floor", "fixed": true, "m": null, "I": null, "x": 0, "y": -1, "angle": 0, "vx": 0, "vy": 0,
       "omega": 0, "ax": 0, "ay": 0, "alpha": 0}],
    "contacts": [{"kind": "straight_curved", "p": 0, "q": 1, "n": [0, 1], "normalFixed": false, "R1": [0, -1.25],
      "R2": [0, 1], "U1": [0, 0], "U2": [0, 1], "radius1": 1.25, "radius2": null, "distance": 0.25, "vn": -0.5,
      "extra": -4}],
    "A": [0.5], "b": [-14]})");
}

// What the corrections are worth for every kind of contact, public recordings show (replay_command_test.cc).
TEST(Replay, SummaryCountsAndListsWhatIsLeftOver) {
  ReplayRecord record = ParseReplayRecord(HandMade().dump(), "file:1");
  const auto summarise = [&] {
    ReplaySummary summary;
    summary.Add(record, Replay(record), "file:1");
    return summary;
  };
  EXPECT_TRUE(summarise().AllAgree()) << summarise().Table();
  record.b[0] += 1e-6;
  record.A(0, 0) += 1e-6;
  const ReplaySummary summary = summarise();
  EXPECT_FALSE(summary.AllAgree());
  const nlohmann::json json = nlohmann::json::parse(summary.Json());
  EXPECT_FALSE(json["agrees"].get<bool>());
  EXPECT_EQ(json["records"], 1);
  EXPECT_EQ(json["rows"], 1);
  EXPECT_EQ(json["A"]["agree"], 0);
  ASSERT_EQ(json["left_over"].size(), 2u);
  EXPECT_EQ(json["left_over"][0]["what"], "b[0] (straight_curved)");
  EXPECT_TRUE(json["left_over"][1]["what"].get<std::string>().starts_with("A[0][0]"));
  EXPECT_NE(summary.Table().find("left over: 2"), std::string::npos);
}

TEST(Replay, HandMadeRecordOfADiscOnTheFloor) {
  const ReplayRecord record = ParseReplayRecord(HandMade().dump(), "file:1");
  EXPECT_EQ(record.id, "disc-on-floor");
  const ReplayResult result = Replay(record);
  ASSERT_EQ(result.rows.size(), 1u);
  EXPECT_EQ(result.rows[0].kind, "straight_curved");
  EXPECT_DOUBLE_EQ(result.rows[0].recorded, -10);
  EXPECT_DOUBLE_EQ(result.rows[0].ours, -10);
  EXPECT_DOUBLE_EQ(result.A(0, 0), 0.5);
  const RebuiltContact rebuilt = Rebuild(record.contacts[0], record.bodies);
  EXPECT_EQ(std::get<ArcEdge>(rebuilt.constraint.feature1).radius, 1);
}

TEST(Replay, MalformedRecordsAreRefusedNamingFileLineAndField) {
  const auto expect_refused = [](const nlohmann::json& record, const std::string& mentions) {
    ExpectRefused([&] { ParseReplayRecord(record.dump(), "file:7"); }, mentions, "file:7: ");
  };
  expect_refused(nlohmann::json::array(), "expected an object");
  for (const char* key : {"id", "n", "bodies", "contacts", "A", "b"}) {
    nlohmann::json record = HandMade();
    record.erase(key);
    expect_refused(record, std::string("/") + key + ": missing");
  }
  for (const auto& refused : RefusalCases("replay")) {
    nlohmann::json record = HandMade();
    record[nlohmann::json::json_pointer(refused[0])] = nlohmann::json::parse(refused[1]);
    expect_refused(record, refused[0]);
  }
  EXPECT_THROW(ParseReplayRecord("{\"id\":", "file:7"), InputError);
  EXPECT_THROW(ParseReplayRecord("{\"id\": 1e999}", "file:7"), InputError);
}

TEST(Replay, ImpossibleGeometryIsRefusedByTheAssembly) {
  nlohmann::json json = HandMade();
  json["contacts"][0]["radius1"] = 0.25;  // all of it gap: a disc of radius 0
  EXPECT_THROW(Replay(ParseReplayRecord(json.dump(), "file:1")), InputError);
}

}  // namespace
}  // namespace lcpbench::testing
