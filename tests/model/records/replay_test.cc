#include "model/records/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "model/records/replay_record.h"
#include "support/input_error.h"
#include "tests/model/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr double kRounding = 1e-11;

constexpr RecordedKind kAllKinds[] = {
    RecordedKind::kVertexStraight, RecordedKind::kVertexCurved, RecordedKind::kStraightCurved,
    RecordedKind::kCurvedCurved,   RecordedKind::kVertexVertex, RecordedKind::kJoint,
    RecordedKind::kPathJoint,      RecordedKind::kRod,          RecordedKind::kRope};

// The recorded software, by the formulas its data come with.
class Software {
 public:
  explicit Software(const ReplayRecord& record) : record_(record) {}

  double B(size_t i) const {
    const RecordedContact& c = record_.contacts[i];
    const Body& body1 = BodyOf(c.body1);
    const Body& body2 = BodyOf(c.body2);
    const Vec2 dv = DeltaV(c);
    const double linear = Dot(c.n, Acceleration(body1, c.U1) - Acceleration(body2, c.U2));
    return linear + Quadratic(c, dv, body2.omega) + c.extra;
  }

  double A(size_t i, size_t j) const {
    double sum = 0;
    for (const Side& s : Sides(i)) {
      for (const Side& t : Sides(j)) {
        if (s.body != t.body || BodyOf(s.body).fixed) continue;
        sum += s.sign * t.sign *
               (Dot(s.n, t.n) / BodyOf(s.body).mass + Cross(s.U, s.n) * Cross(t.U, t.n) / BodyOf(s.body).inertia);
      }
    }
    return sum;
  }

  Vec2 DeltaV(const RecordedContact& c) const {
    return Velocity(BodyOf(c.body1), c.U1) - Velocity(BodyOf(c.body2), c.U2);
  }

 private:
  struct Side {
    int body;
    double sign;
    Vec2 n;
    Vec2 U;
  };

  std::vector<Side> Sides(size_t i) const {
    const RecordedContact& c = record_.contacts[i];
    return {{c.body1, 1, c.n, c.U1}, {c.body2, -1, c.n, c.U2}};
  }
  const Body& BodyOf(int i) const { return record_.bodies[static_cast<size_t>(i)]; }

  static double Quadratic(const RecordedContact& c, Vec2 dv, double w2) {
    switch (c.kind) {
      case RecordedKind::kVertexStraight:
        return 2 * w2 * Dot(Perp(c.n), dv);
      case RecordedKind::kJoint:
        return c.fixed_normal ? 0 : 2 * w2 * Dot(Perp(c.n), dv);
      case RecordedKind::kStraightCurved:
        return 2 * w2 * Dot(Perp(c.n), dv) - c.radius1 * w2 * w2;
      case RecordedKind::kVertexCurved:
      case RecordedKind::kVertexVertex:
        return Dot(dv, dv) / c.radius2;
      case RecordedKind::kCurvedCurved:
      case RecordedKind::kRod:
      case RecordedKind::kRope:
        return Dot(dv, dv) / (c.radius1 + c.radius2);
      case RecordedKind::kPathJoint:
        return Dot(c.normal_dt, dv);
    }
    return 0;
  }
  static Vec2 Velocity(const Body& body, Vec2 U) { return body.v + body.omega * Perp(U); }
  static Vec2 Acceleration(const Body& body, Vec2 U) {
    if (body.fixed) return {};
    return Vec2{body.force.x / body.mass, body.force.y / body.mass} + (body.torque / body.inertia) * Perp(U) -
           body.omega * body.omega * U;
  }

  const ReplayRecord& record_;
};

// A contact of the given kind between the two bodies, with arms and radii as the software records them.
RecordedContact RandomRecordedContact(RecordedKind kind, const Body& body1, const Body& body2, Random* random) {
  RecordedContact c;
  c.kind = kind;
  const Rotation direction = SinCos(random->Uniform(-3, 3));
  c.n = {direction.cos, direction.sin};
  const double d = random->Uniform(0.05, 0.2);
  const Vec2 p2 = random->Vector(3);
  const Vec2 p1 = p2 + d * c.n;
  const bool concave = random->Uniform(0, 1) < 0.5;
  const double rho1 = random->Uniform(0.3, 1);
  const double rho2 = concave ? random->Uniform(-4, -2) : random->Uniform(0.3, 1);
  c.distance = d;
  c.extra = random->Uniform(-2, 2);
  c.R1 = p2 - body1.x;
  c.R2 = p2 - body2.x;
  switch (kind) {
    case RecordedKind::kVertexStraight:
      break;
    case RecordedKind::kVertexCurved:
      c.R1 = p1 - body1.x;
      c.R2 = p1 - body2.x;
      c.radius2 = rho2 + d;
      break;
    case RecordedKind::kStraightCurved:
      c.radius1 = rho1 + d;
      break;
    case RecordedKind::kCurvedCurved:
      c.radius1 = rho1 + d / 2;
      c.radius2 = rho2 + d / 2;
      break;
    case RecordedKind::kVertexVertex:
      c.radius2 = d;
      break;
    case RecordedKind::kJoint: {
      c.R1 = p2 + random->Vector(0.3) - body1.x;
      c.fixed_normal = random->Uniform(0, 1) < 0.5;
      c.distance = Dot(c.n, (body1.x + c.R1) - (body2.x + c.R2));
      break;
    }
    case RecordedKind::kPathJoint:
      c.R1 = p1 - body1.x;
      break;
    case RecordedKind::kRod:
    case RecordedKind::kRope: {
      // The normal is the direction of the pull.
      const double length = random->Uniform(0.5, 3);
      c.R1 = p2 - length * c.n - body1.x;
      c.distance = random->Uniform(0, 0.05);
      c.radius2 = kind == RecordedKind::kRope ? -length : -(length + c.distance);
      break;
    }
  }
  c.U1 = c.R1;
  c.U2 = c.R2;
  if (kind == RecordedKind::kStraightCurved || kind == RecordedKind::kCurvedCurved) {
    c.U1 = p1 + rho1 * c.n - body1.x;
  }
  if (kind == RecordedKind::kVertexCurved || kind == RecordedKind::kCurvedCurved) c.U2 = p2 - rho2 * c.n - body2.x;
  return c;
}

// Contacts of every kind between random pairs of a few bodies. Body 0 is fixed.
ReplayRecord RandomRecord(unsigned seed) {
  Random random(seed);
  ReplayRecord record;
  record.id = "random";
  Body fixed;
  fixed.fixed = true;
  fixed.x = random.Vector(2);
  fixed.theta = random.Uniform(-3, 3);
  record.bodies = {fixed, RandomBody(&random), RandomBody(&random), RandomBody(&random)};
  const auto count = static_cast<double>(record.bodies.size());
  for (const RecordedKind kind : kAllKinds) {
    for (int k = 0; k < 3; ++k) {
      // Not both fixed, not the same; a path is on a fixed body.
      const int body1 = static_cast<int>(random.Uniform(1, count));
      int body2 = kind == RecordedKind::kPathJoint ? 0 : static_cast<int>(random.Uniform(0, count));
      if (body2 == body1) body2 = 0;
      RecordedContact c = RandomRecordedContact(kind, record.bodies[static_cast<size_t>(body1)],
                                                record.bodies[static_cast<size_t>(body2)], &random);
      c.body1 = body1;
      c.body2 = body2;
      const Vec2 dv = Software(record).DeltaV(c);
      c.vn = Dot(c.n, dv);
      if (kind == RecordedKind::kPathJoint) {
        c.normal_dt = (random.Uniform(-1, 1) * Dot(Perp(c.n), dv)) * Perp(c.n);
      }
      record.contacts.push_back(c);
    }
  }
  const size_t n = record.contacts.size();
  record.A.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  record.b.resize(static_cast<Eigen::Index>(n));
  const Software software(record);
  for (size_t i = 0; i < n; ++i) {
    record.b[static_cast<Eigen::Index>(i)] = software.B(i);
    for (size_t j = 0; j < n; ++j) {
      record.A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = software.A(i, j);
    }
  }
  return record;
}

TEST(Replay, CorrectionsTurnTheSoftwaresBIntoOursForEveryKind) {
  std::vector<double> largest_before(std::size(kAllKinds), 0.0);
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const ReplayRecord record = RandomRecord(seed);
    const ReplayResult result = Replay(record);
    ASSERT_EQ(result.rows.size(), record.contacts.size());
    for (size_t i = 0; i < result.rows.size(); ++i) {
      const ReplayRow& row = result.rows[i];
      const RecordedContact& c = record.contacts[i];
      EXPECT_LE(ScaledDeviation(row.ours, row.corrected()), kRounding) << row.kind;
      EXPECT_LE(row.geometry_deviation, kRounding) << row.kind;
      double& before = largest_before[static_cast<size_t>(c.kind)];
      before = std::max(before, ScaledDeviation(row.ours, row.recorded));
      if (c.kind == RecordedKind::kStraightCurved || c.fixed_normal) {
        EXPECT_LE(ScaledDeviation(row.ours, row.recorded), kRounding) << row.kind;
      }
    }
    for (Eigen::Index i = 0; i < record.A.rows(); ++i) {
      for (Eigen::Index j = 0; j < record.A.cols(); ++j) {
        EXPECT_LE(ScaledDeviation(result.A(i, j), record.A(i, j)), kRounding)
            << result.rows[static_cast<size_t>(i)].kind << ", " << result.rows[static_cast<size_t>(j)].kind;
      }
    }
    if (HasFailure()) return;
  }
  for (const RecordedKind kind : kAllKinds) {
    if (kind == RecordedKind::kStraightCurved) continue;
    EXPECT_GT(largest_before[static_cast<size_t>(kind)], 1e-3) << static_cast<int>(kind);
  }
}

TEST(Replay, SummaryCountsAndListsWhatIsLeftOver) {
  ReplayRecord record = RandomRecord(7);
  const auto summarise = [&] {
    ReplaySummary summary;
    summary.Add(record, Replay(record), "file:1");
    return summary;
  };
  EXPECT_TRUE(summarise().AllAgree()) << summarise().Table();
  record.b[2] += 1e-6;
  record.A(3, 4) += 1e-6;
  const ReplaySummary summary = summarise();
  EXPECT_FALSE(summary.AllAgree());
  const nlohmann::json json = nlohmann::json::parse(summary.Json());
  EXPECT_FALSE(json["agrees"].get<bool>());
  EXPECT_EQ(json["records"], 1);
  EXPECT_EQ(json["rows"], record.contacts.size());
  EXPECT_EQ(json["A"]["agree"], 0);
  ASSERT_EQ(json["left_over"].size(), 2u);
  EXPECT_EQ(json["left_over"][0]["what"], "b[2] (vertex_straight)");
  EXPECT_TRUE(json["left_over"][1]["what"].get<std::string>().starts_with("A[3][4]"));
  EXPECT_NE(summary.Table().find("left over: 2"), std::string::npos);
}

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
  const auto expect_refused_at = [&](const std::string& pointer, const nlohmann::json& value) {
    nlohmann::json record = HandMade();
    record[nlohmann::json::json_pointer(pointer)] = value;
    expect_refused(record, pointer);
  };
  expect_refused(nlohmann::json::array(), "expected an object");
  for (const char* key : {"id", "n", "bodies", "contacts", "A", "b"}) {
    nlohmann::json record = HandMade();
    record.erase(key);
    expect_refused(record, std::string("/") + key + ": missing");
  }
  const nlohmann::json good = HandMade();
  for (const auto& [key, value] : good["contacts"][0].items()) {
    if (key == "radius2") continue;
    nlohmann::json record = HandMade();
    record["contacts"][0].erase(key);
    expect_refused(record, "/contacts/0/" + key + ": missing");
    expect_refused_at("/contacts/0/" + key, nullptr);
    expect_refused_at("/contacts/0/" + key, {{"a", 1}});
  }
  for (const auto& [key, value] : good["bodies"][0].items()) expect_refused_at("/bodies/0/" + key, nullptr);
  expect_refused_at("/bodies/0/m", 0);
  expect_refused_at("/bodies/0/I", -1);
  expect_refused_at("/n", 2);
  expect_refused_at("/b", {1, 2});
  expect_refused_at("/A", {{0.5}});
  expect_refused_at("/A/0", "0.5");
  expect_refused_at("/contacts/0/kind", "vertex_oval");
  expect_refused_at("/contacts/0/p", 2);
  expect_refused_at("/contacts/0/p", -1);
  expect_refused_at("/contacts/0/p", 0.5);
  expect_refused_at("/contacts/0/q", 0);
  expect_refused_at("/contacts/0/n", {1, 1});
  expect_refused_at("/contacts/0/n", {1});
  expect_refused_at("/contacts/0/radius1", 0);
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
