#include "model/records/replay_record.h"

#include <array>
#include <cmath>
#include <utility>

#include "support/json_field.h"

namespace lcpbench {
namespace {

struct KindName {
  const char* name;
  RecordedKind kind;
  // Which of the radii the kind has.
  bool radius1;
  bool radius2;
};

// In the order of RecordedKind.
constexpr std::array kKinds = {
    KindName{"vertex_straight", RecordedKind::kVertexStraight, false, false},
    KindName{"vertex_curved", RecordedKind::kVertexCurved, false, true},
    KindName{"straight_curved", RecordedKind::kStraightCurved, true, false},
    KindName{"curved_curved", RecordedKind::kCurvedCurved, true, true},
    KindName{"vertex_vertex", RecordedKind::kVertexVertex, false, true},
    KindName{"joint", RecordedKind::kJoint, false, false},
    KindName{"path_joint", RecordedKind::kPathJoint, false, false},
    KindName{"rod", RecordedKind::kRod, false, true},
    KindName{"rope", RecordedKind::kRope, false, true},
};

const KindName& ParseKind(const JsonField& field) {
  const std::string name = field.String();
  std::string expected;
  for (const KindName& kind : kKinds) {
    if (name == kind.name) return kind;
    expected += (expected.empty() ? "one of " : ", ") + std::string(kind.name);
  }
  field.Mismatch(expected);
}

Body ParseReplayBody(const JsonField& field) {
  Body body;
  body.name = field["name"].String();
  body.fixed = field["fixed"].Boolean();
  body.x = {field["x"].Number(), field["y"].Number()};
  body.theta = field["angle"].Number();
  if (body.fixed) return body;
  const auto positive = [&](const char* key) {
    const double value = field[key].Number();
    if (!(value > 0)) field[key].Mismatch("a number > 0");
    return value;
  };
  body.mass = positive("m");
  body.inertia = positive("I");
  body.v = {field["vx"].Number(), field["vy"].Number()};
  body.omega = field["omega"].Number();
  body.force = body.mass * Vec2{field["ax"].Number(), field["ay"].Number()};
  body.torque = body.inertia * field["alpha"].Number();
  return body;
}

Vec2 ParseNormal(const JsonField& field) {
  constexpr double kUnitTolerance = 1e-12;
  const Vec2 n = field.Pair<Vec2>();
  if (!(std::abs(Norm(n) - 1) <= kUnitTolerance)) field.Mismatch("a unit vector");
  return n;
}

RecordedContact ParseContact(const JsonField& field, const std::vector<Body>& bodies) {
  const KindName& kind = ParseKind(field["kind"]);
  RecordedContact contact;
  contact.kind = kind.kind;
  contact.body1 = field["p"].IndexBelow(bodies.size());
  contact.body2 = field["q"].IndexBelow(bodies.size());
  if (contact.body1 == contact.body2) field["q"].Mismatch("another body than p");
  contact.n = ParseNormal(field["n"]);
  contact.fixed_normal = field["normalFixed"].Boolean();
  contact.R1 = field["R1"].Pair<Vec2>();
  contact.R2 = field["R2"].Pair<Vec2>();
  contact.U1 = field["U1"].Pair<Vec2>();
  contact.U2 = field["U2"].Pair<Vec2>();
  const auto radius = [&](const char* key) {
    const double value = field[key].Number();
    if (value == 0) field[key].Mismatch("a radius other than 0");
    return value;
  };
  if (kind.radius1) contact.radius1 = radius("radius1");
  if (kind.radius2) contact.radius2 = radius("radius2");
  const bool connector = kind.kind == RecordedKind::kRod || kind.kind == RecordedKind::kRope;
  if (connector && contact.radius2 > 0) field["radius2"].Mismatch("minus the length of the rod or rope");
  contact.distance = field["distance"].Number();
  contact.vn = field["vn"].Number();
  contact.extra = field["extra"].Number();
  if (kind.kind == RecordedKind::kPathJoint) {
    contact.normal_dt = field["normal_dt"].Pair<Vec2>();
    if (!bodies[static_cast<size_t>(contact.body2)].fixed) field["q"].Mismatch("a fixed body, as paths are recorded");
  }
  return contact;
}

}  // namespace

const char* Name(RecordedKind kind) { return kKinds[static_cast<size_t>(kind)].name; }

ReplayRecord ParseReplayRecord(std::string_view line, const std::string& where) {
  const nlohmann::json json = ParseJsonObject(line, where);
  const JsonField field(json, where);
  ReplayRecord record;
  record.id = field["id"].String();
  for (const JsonField& body : field["bodies"].Items()) record.bodies.push_back(ParseReplayBody(body));
  for (const JsonField& contact : field["contacts"].Items()) {
    record.contacts.push_back(ParseContact(contact, record.bodies));
  }
  const size_t n = record.contacts.size();
  if (field["n"].Number() != static_cast<double>(n)) {
    field["n"].Mismatch("the number of contacts, " + std::to_string(n));
  }
  const std::vector<double> b = field["b"].Numbers(n);
  const std::vector<double> A = field["A"].Numbers(n * n);
  const auto size = static_cast<Eigen::Index>(n);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  record.b = Eigen::Map<const Eigen::VectorXd>(b.data(), size);
  record.A = Eigen::Map<const RowMajor>(A.data(), size, size);
  return record;
}

}  // namespace lcpbench
