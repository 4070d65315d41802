#include "model/records/records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/contact_row.h"
#include "model/geometry/feature.h"
#include "tests/support/refusal.h"

namespace lcpbench::testing {
namespace {

using Json = nlohmann::json;

// docs/model.md section 10 asks for 1e-11; the search and the rows are worth 1e-14.
constexpr double kOracleTolerance = 1e-13;

// Calls check(record, answer) for every record of a reference file: how many there are.
template <class Check>
int ForEachRecord(const std::string& file, const Check& check) {
  std::ifstream in(LCPBENCH_SOURCE_DIR "/tests/data/oracle/" + file);
  int count = 0;
  for (std::string line; std::getline(in, line); ++count) {
    const Json record = Json::parse(line);
    SCOPED_TRACE(record["id"]);
    const Json answer = Json::parse(AssembleRecord(line, file));
    EXPECT_EQ(answer["id"], record["id"]);
    check(record, answer);
  }
  return count;
}

// Compares every number of a reference value, of whatever shape, by |x - x_ref| <= tolerance (1 + |x_ref|).
void ExpectMatches(const Json& found, const Json& expected, const std::string& what) {
  if (expected.is_array()) {
    ASSERT_TRUE(found.is_array()) << what;
    ASSERT_EQ(found.size(), expected.size()) << what;
    for (size_t i = 0; i < expected.size(); ++i) ExpectMatches(found[i], expected[i], what + "/" + std::to_string(i));
    return;
  }
  ASSERT_TRUE(found.is_number()) << what << " is " << found;
  const auto x = found.get<double>();
  const auto reference = expected.get<double>();
  EXPECT_LE(std::abs(x - reference), kOracleTolerance * (1 + std::abs(reference))) << what;
}

void ExpectFieldsMatch(const Json& found, const Json& expect, const std::vector<std::string>& fields) {
  for (const std::string& field : fields) {
    ASSERT_TRUE(found.contains(field)) << field << " is missing in " << found;
    ExpectMatches(found[field], expect[field], field);
  }
}

TEST(OracleRecords, ContactsAreReproduced) {
  const int count = ForEachRecord("contacts.jsonl", [](const Json& record, const Json& answer) {
    ASSERT_TRUE(answer.contains("rows")) << answer;
    ASSERT_EQ(answer["rows"].size(), 1U);
    ExpectFieldsMatch(answer["rows"][0], record["expect"], {"n", "d", "d_dot", "J", "gamma", "A", "b"});
  });
  EXPECT_EQ(count, 248);
}

TEST(OracleRecords, JointsAreReproduced) {
  int pins = 0;
  const int count = ForEachRecord("joints.jsonl", [&pins](const Json& record, const Json& answer) {
    ASSERT_TRUE(answer.contains("rows")) << answer;
    const Json& expect = record["expect"];
    if (record["kind"] == "path") {
      ExpectFieldsMatch(answer["rows"][0], expect, {"n", "d", "d_dot", "J", "gamma", "A", "b"});
      return;
    }
    ++pins;
    const std::vector<std::string> fields = {"g", "g_dot", "J", "gamma", "A", "b"};
    ExpectFieldsMatch(answer, expect, fields);
    ASSERT_EQ(answer["rows"].size(), 2U);
    for (size_t axis = 0; axis < 2; ++axis) {
      for (const std::string& field : fields) ExpectMatches(answer["rows"][axis][field], expect[field][axis], field);
    }
  });
  EXPECT_GT(pins, 0);
  EXPECT_EQ(count, 30);
}

TEST(OracleRecords, SystemsAreReproduced) {
  const int count = ForEachRecord("systems.jsonl", [](const Json& record, const Json& answer) {
    const Json& expect = record["expect"];
    ExpectFieldsMatch(answer, expect, {"J", "gamma", "A", "b", "d", "d_dot"});
    ASSERT_EQ(answer["rows"].size(), expect["rows"].size());
    for (size_t i = 0; i < answer["rows"].size(); ++i) {
      for (const auto& [key, value] : expect["rows"][i].items()) EXPECT_EQ(answer["rows"][i][key], value) << key;
    }
  });
  EXPECT_EQ(count, 26);
}

TEST(OracleRecords, SingularOnesAreRefusedWithAReason) {
  const int count = ForEachRecord("singular.jsonl", [](const Json&, const Json& answer) {
    ASSERT_TRUE(answer.contains("error")) << answer;
    EXPECT_FALSE(answer.contains("rows"));
    const std::string error = answer["error"];
    EXPECT_NE(error.find("feature 1: "), std::string::npos) << error;
    EXPECT_NE(error.find("feature 2: "), std::string::npos) << error;
  });
  EXPECT_EQ(count, 18);
}

// Every start value removed: the search must find the meant minimum by nominal_gap (0 where a record has none).
Json WithoutStarts(Json record) {
  record.erase("s1");
  record.erase("s2");
  if (record.contains("contacts")) {
    for (Json& contact : record["contacts"]) {
      contact.erase("s1");
      contact.erase("s2");
    }
  }
  return record;
}

TEST(OracleRecords, AreReproducedWithoutStartValuesToo) {
  for (const char* file : {"contacts.jsonl", "joints.jsonl", "systems.jsonl"}) {
    const int count = ForEachRecord(file, [&](const Json& record, const Json&) {
      if (record.contains("kind") && record["kind"] == "pin") return;
      const Json answer = Json::parse(AssembleRecord(WithoutStarts(record).dump(), file));
      ASSERT_TRUE(answer.contains("rows")) << answer;
      const Json& row = record.contains("contacts") ? answer : answer["rows"][0];
      ExpectFieldsMatch(row, record["expect"], {"d", "d_dot", "J", "gamma", "A", "b"});
    });
    EXPECT_GT(count, 0) << file;
  }
}

Json SomeBody() {
  return {{"mass", 2.0},     {"inertia", 1.0}, {"fixed", false},        {"x", {0.1, 1.0}}, {"theta", 0.3},
          {"v", {1.0, 2.0}}, {"omega", -0.7},  {"force", {3.0, -10.0}}, {"torque", 8.0}};
}

// A vertex on a disc.
Json SomeContact() {
  Json disc = SomeBody();
  disc["x"] = {0.2, -0.4};
  return {{"id", "k1"},
          {"kind", "vertex/circular"},
          {"body1", SomeBody()},
          {"body2", std::move(disc)},
          {"feature1", {{"type", "vertex"}, {"p", {0.1, 0.2}}}},
          {"feature2", {{"type", "arc"}, {"center", {0.0, 0.1}}, {"radius", 1.5}, {"side", "convex"}}}};
}

Json SomeSystem() {
  const Json contact = SomeContact();
  return {{"id", "m1"},
          {"bodies", {contact["body1"], contact["body2"]}},
          {"contacts",
           {{{"type", "unilateral"},
             {"body1", 0},
             {"body2", 1},
             {"feature1", contact["feature1"]},
             {"feature2", contact["feature2"]},
             {"s1", nullptr},
             {"s2", 0.5}}}}};
}

// A rod or rope between the points p of two bodies, 0.7 m long; the points are about 1.6 m apart.
Json SomeConnector(const char* kind) {
  Json record = SomeContact();
  record["kind"] = kind;
  record["feature2"] = {{"type", "vertex"}, {"p", {-0.3, 0.1}}};
  record["length"] = 0.7;
  return record;
}

TEST(Records, NumbersReadBackExactly) {
  const AssembledLcp lcp = AssembleContactLcp(ParseSystemRecord(SomeContact().dump(), ""));
  const std::string line = AssembleRecord(SomeContact().dump(), "");
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const Json row = Json::parse(line)["rows"][0];
  EXPECT_EQ(row["b"].get<double>(), lcp.problem.b()[0]);
  EXPECT_EQ(row["A"].get<double>(), lcp.problem.DenseA()(0, 0));
  EXPECT_EQ(row["gamma"].get<double>(), lcp.rows[0].gamma);
  EXPECT_EQ(row["n"][0].get<double>(), lcp.rows[0].n.x);
  for (Index k = 0; k < 6; ++k) {
    EXPECT_EQ(row["J"][static_cast<size_t>(k)].get<double>(), lcp.problem.J().coeff(0, k));
  }
}

TEST(Records, ExpectedValuesAreNeverRead) {
  for (Json record : {SomeContact(), SomeSystem()}) {
    const std::string without = AssembleRecord(record.dump(), "");
    record["expect"] = {{"s1", "nonsense"}, {"n", {7, 7}}, {"J", nullptr}};
    EXPECT_EQ(AssembleRecord(record.dump(), ""), without);
  }
}

TEST(Records, RodsAndRopesAreTheRowsOfTheDistanceBetweenTheirPoints) {
  for (const auto& [kind, sign] : {std::pair("rod", 1.0), std::pair("rope", -1.0)}) {
    SCOPED_TRACE(kind);
    const Json record = SomeConnector(kind);
    const Json row = Json::parse(AssembleRecord(record.dump(), ""))["rows"][0];
    const ContactSystem system = ParseSystemRecord(record.dump(), "");
    const Body& body1 = system.bodies[0];
    const Body& body2 = system.bodies[1];
    const ConnectorRow expected =
        ComputeConnectorRow({0.1, 0.2}, SinCos(body1.theta), body1, {-0.3, 0.1}, SinCos(body2.theta), body2, 0.7);
    EXPECT_EQ(row["d"].get<double>(), sign * (expected.points.d - 0.7));
    EXPECT_EQ(row["d_dot"].get<double>(), sign * expected.row.d_dot);
    EXPECT_EQ(row["gamma"].get<double>(), sign * expected.row.gamma);
    EXPECT_EQ(row["n"], Json({sign * expected.points.n.x, sign * expected.points.n.y}));
    for (size_t k = 0; k < 6; ++k) EXPECT_EQ(row["J"][k].get<double>(), sign * expected.row.J[k]);
  }
}

TEST(Records, ConnectorsOfASystemAreThoseOfSingleRecords) {
  Json system = SomeSystem();
  Json answers;
  for (const char* kind : {"rod", "rope"}) {
    Json connector = SomeConnector(kind);
    answers.push_back(Json::parse(AssembleRecord(connector.dump(), ""))["rows"][0]);
    connector["type"] = kind;
    connector["body1"] = 0;
    connector["body2"] = 1;
    system["contacts"].push_back(std::move(connector));
  }
  const Json answer = Json::parse(AssembleRecord(system.dump(), ""));
  ASSERT_EQ(answer["rows"].size(), 3U);
  EXPECT_FALSE(answer["rows"][0]["bilateral"].get<bool>());
  EXPECT_TRUE(answer["rows"][1]["bilateral"].get<bool>()) << "a rod";
  EXPECT_FALSE(answer["rows"][2]["bilateral"].get<bool>()) << "a rope";
  for (const size_t i : {1U, 2U}) {
    const Json& single = answers[i - 1];
    EXPECT_EQ(answer["J"][i], single["J"]);
    EXPECT_EQ(answer["A"][i][i], single["A"]);
    for (const char* field : {"gamma", "b", "d", "d_dot"}) EXPECT_EQ(answer[field][i], single[field]) << field;
    EXPECT_EQ(answer["rows"][i]["n"], single["n"]);
  }
}

TEST(Records, LengthsAreReadForRodsAndRopesOnly) {
  EXPECT_EQ(ParseSystemRecord(SomeConnector("rod").dump(), "").constraints[0].length, 0.7);
  EXPECT_EQ(ParseSystemRecord(SomeConnector("rope").dump(), "").constraints[0].length, 0.7);
  Json pin = SomeConnector("pin");
  pin["length"] = "long";
  EXPECT_TRUE(Json::parse(AssembleRecord(pin.dump(), "")).contains("rows"));
}

TEST(Records, CurvesAreReadWithAllTheirFields) {
  Json record = SomeContact();
  record["feature1"] = {{"type", "ellipse"}, {"center", {1, 2}}, {"a", 3}, {"b", 4}, {"phi", 5}, {"side", "concave"}};
  record["feature2"] = {{"type", "superellipse"}, {"center", {1, 2}}, {"a", 3}, {"b", 4}, {"m", 6}, {"phi", 5},
                        {"side", "convex"}};
  ContactSystem system = ParseSystemRecord(record.dump(), "");
  const auto ellipse = std::get<EllipseEdge>(system.constraints[0].feature1);
  EXPECT_EQ(Describe(ellipse), "concave ellipse with center (1, 2), a 3, b 4, phi 5");
  const auto oval = std::get<SuperellipseEdge>(system.constraints[0].feature2);
  EXPECT_EQ(Describe(oval), "convex superellipse with center (1, 2), a 3, b 4, phi 5, m 6");
  record["feature1"] = {{"type", "bezier"}, {"P", {{0, 1}, {2, 3}, {4, 5}, {6, 7}}}};
  system = ParseSystemRecord(record.dump(), "");
  EXPECT_EQ(Describe(std::get<BezierEdge>(system.constraints[0].feature1)),
            "bezier edge with P (0, 1), (2, 3), (4, 5), (6, 7)");
}

TEST(Records, WhatIsWrongIsNamedWithItsPlaceOrTheRecordsId) {
  std::map<std::string, Json> bases = {{"contact", SomeContact()},    {"system", SomeSystem()},
                                       {"rod", SomeConnector("rod")}, {"rope", SomeConnector("rope")},
                                       {"oval", SomeContact()},       {"bezier", SomeContact()}};
  bases["oval"]["feature2"] = {{"type", "superellipse"}, {"center", {0, 0}}, {"a", 1}, {"b", 2}, {"m", 4}, {"phi", 0},
                               {"side", "convex"}};
  bases["bezier"]["feature2"] = {{"type", "bezier"}, {"P", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}}};
  for (const auto& refused : RefusalCases("records")) {
    const std::string place = refused[0].substr(refused[0].find('/'));
    const std::string& words = refused[2];
    Json record = bases.at(refused[0].substr(0, refused[0].find('/')));
    if (refused[1].empty()) {
      record = record.patch({{{"op", "remove"}, {"path", place}}});
    } else {
      record[Json::json_pointer(place)] = Json::parse(refused[1]);
    }
    SCOPED_TRACE(refused[0] + " => " + refused[1]);
    if (words.starts_with("/")) {
      ExpectRefused([&] { AssembleRecord(record.dump(), "file.jsonl:7"); }, "", "file.jsonl:7: " + words);
      continue;
    }
    const Json answer = Json::parse(AssembleRecord(record.dump(), "file.jsonl:7"));
    EXPECT_EQ(answer["id"], record["id"]);
    ASSERT_TRUE(answer.contains("error"));
    EXPECT_NE(answer["error"].get<std::string>().find(words), std::string::npos) << answer["error"];
    EXPECT_EQ(answer.size(), 2U) << "nothing but the id and the error";
  }
}

TEST(Records, LinesThatAreNoRecordAreRefusedNamingPlaceExpectedAndFound) {
  const auto error_of = [](const std::string& line) {
    return RefusalOf([&] { AssembleRecord(line, "file.jsonl:7"); });
  };
  EXPECT_EQ(error_of("{\"id\": 1,"), "file.jsonl:7: not valid JSON, at byte 10");
  EXPECT_EQ(error_of("[1, 2]"), "file.jsonl:7: expected an object, found array");
  EXPECT_EQ(error_of("{}"), "file.jsonl:7: /id: missing field, expected a string");
  EXPECT_EQ(error_of("{\"id\": 1e999}"), "file.jsonl:7: /id: a number beyond the range of double");
}

}  // namespace
}  // namespace lcpbench::testing
