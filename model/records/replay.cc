#include "model/records/replay.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iomanip>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>
#include <utility>

#include "model/contact/assembly.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

struct KindFields {
  RecordedKind kind;
  // Which of the radii the kind has.
  bool radius1;
  bool radius2;
};

// In the order of RecordedKind.
constexpr std::initializer_list<std::pair<const char*, KindFields>> kKinds = {
    {"vertex_straight", {RecordedKind::kVertexStraight, false, false}},
    {"vertex_curved", {RecordedKind::kVertexCurved, false, true}},
    {"straight_curved", {RecordedKind::kStraightCurved, true, false}},
    {"curved_curved", {RecordedKind::kCurvedCurved, true, true}},
    {"vertex_vertex", {RecordedKind::kVertexVertex, false, true}},
    {"joint", {RecordedKind::kJoint, false, false}},
    {"path_joint", {RecordedKind::kPathJoint, false, false}},
    {"rod", {RecordedKind::kRod, false, true}},
    {"rope", {RecordedKind::kRope, false, true}},
};

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
  static_cast<void>(field["kind"].String());  // another value is refused as that
  const KindFields kind = field["kind"].Choice(kKinds);
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

// The world-frame arm `r` in the frame of `body`.
Vec2 ToBody(const Body& body, Vec2 r) { return RotateBack(SinCos(body.theta), r); }

Feature VertexAt(const Body& body, Vec2 arm) { return Vertex{ToBody(body, arm)}; }

Feature ArcAbout(const Body& body, Vec2 center_arm, double signed_radius) {
  return ArcEdge{ToBody(body, center_arm), std::abs(signed_radius), signed_radius > 0 ? Side::kConvex : Side::kConcave};
}

// A piece of the line through `arm` with outward normal n (material on the left). Its length is of no consequence.
Feature LineThrough(const Body& body, Vec2 arm, Vec2 n) {
  const Vec2 along = Perp(n);
  return StraightEdge{ToBody(body, arm - along), ToBody(body, arm + along)};
}

std::string KindText(const RecordedContact& contact) {
  const bool concave = (contact.kind == RecordedKind::kVertexCurved && contact.radius2 < 0) ||
                       (contact.kind == RecordedKind::kCurvedCurved && (contact.radius1 < 0 || contact.radius2 < 0));
  const bool world = contact.kind == RecordedKind::kJoint && contact.fixed_normal;
  return std::string(std::data(kKinds)[static_cast<size_t>(contact.kind)].first) + (concave ? "_concave" : "") +
         (world ? "_world" : "");
}

// For readers, by Correction.
struct CorrectionText {
  const char* key;
  const char* formula;
};
constexpr std::array<CorrectionText, kCorrectionCount> kCorrectionTexts = {
    {{"normal-derivative", "-vn^2/rho"},
     {"vertex-above-edge", "-d (omega1 - omega2)^2"},
     {"vertex-above-vertex", "2 omega1 vt"},
     {"joint-axis", "-2 omega2 vt"},
     {"rod-length", "vt^2 (1/L - 1/l)"},
     {"path-gap", "kappa vt^2/(1 + kappa d) - n'.dv"}}};

double ScaledDeviation(double x, double reference) { return std::abs(x - reference) / (1 + std::abs(reference)); }

bool Agrees(double deviation) { return deviation <= kReplayTolerance; }
// Not a number counts as the largest of all.
bool Exceeds(double value, double largest) { return value > largest || std::isnan(value); }

// Sets the path, and returns what the software leaves out of the row of its joint.
// @param vt, dv  of the arms' ends, as in Rebuild
double RebuildPath(const RecordedContact& contact, const Body& body1, const Body& body2, double vt, Vec2 dv,
                   Feature* path) {
  const double d = contact.distance;
  // The software gives n' of a path, not its curvature: on a fixed body n' = kappa vt t. At vt = 0 any will do.
  const double kappa = vt == 0 ? 0 : Dot(Perp(contact.n), contact.normal_dt) / vt;
  // The point of the path below the vertex by n and d. The recorded one is off it along t, by up to 5e-7 m.
  const Vec2 foot = (body1.x - body2.x) + contact.R1 - d * contact.n;
  *path = kappa == 0 ? LineThrough(body2, foot, contact.n) : ArcAbout(body2, foot - (1 / kappa) * contact.n, 1 / kappa);
  return kappa * vt * vt / (1 + kappa * d) - Dot(contact.normal_dt, dv);
}

}  // namespace

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

RebuiltContact Rebuild(const RecordedContact& contact, const std::vector<Body>& bodies) {
  const Body& body1 = bodies[static_cast<size_t>(contact.body1)];
  const Body& body2 = bodies[static_cast<size_t>(contact.body2)];
  const double d = contact.distance;
  const double omega_difference = body1.omega - body2.omega;
  // At the ends of the centre arms, as the software takes it.
  const Vec2 dv = (body1.v + body1.omega * Perp(contact.U1)) - (body2.v + body2.omega * Perp(contact.U2));
  const double vn = Dot(contact.n, dv);
  const double vt = Dot(Perp(contact.n), dv);
  RebuiltContact rebuilt;
  const auto add = [&](Correction correction, double value) { rebuilt.added[static_cast<size_t>(correction)] = value; };
  const auto add_normal_derivative = [&](double rho) { add(Correction::kNormalDerivative, -vn * vn / rho); };
  Constraint& constraint = rebuilt.constraint;
  constraint.body1 = contact.body1;
  constraint.body2 = contact.body2;
  constraint.nominal_gap = d;
  rebuilt.weight = {1, 0};
  // What most kinds join.
  constraint.feature1 = VertexAt(body1, contact.R1);
  constraint.feature2 = VertexAt(body2, contact.R2);
  switch (contact.kind) {
    case RecordedKind::kVertexStraight:
      // Both arms lead to the edge; the vertex is d above it.
      constraint.feature1 = VertexAt(body1, contact.R1 + d * contact.n);
      constraint.feature2 = LineThrough(body2, contact.R2, contact.n);
      add(Correction::kVertexAboveEdge, -d * omega_difference * omega_difference);
      break;
    case RecordedKind::kVertexCurved:
      constraint.feature2 = ArcAbout(body2, contact.U2, contact.radius2 - d);
      add_normal_derivative(contact.radius2);
      break;
    case RecordedKind::kStraightCurved:
      // Its b is exact at any gap: radius1 contains it.
      constraint.feature1 = ArcAbout(body1, contact.U1, contact.radius1 - d);
      constraint.feature2 = LineThrough(body2, contact.R2, contact.n);
      break;
    case RecordedKind::kCurvedCurved:
      constraint.feature1 = ArcAbout(body1, contact.U1, contact.radius1 - d / 2);
      constraint.feature2 = ArcAbout(body2, contact.U2, contact.radius2 - d / 2);
      add_normal_derivative(contact.radius1 + contact.radius2);
      break;
    case RecordedKind::kVertexVertex:
      constraint.type = ConstraintType::kRod;
      // Both arms lead to vertex 2.
      constraint.feature1 = VertexAt(body1, contact.R1 + d * contact.n);
      constraint.length = d;
      rebuilt.gap_offset = d;
      add_normal_derivative(contact.radius2);
      add(Correction::kVertexAboveVertex, 2 * body1.omega * vt);
      break;
    case RecordedKind::kJoint:
      constraint.type = ConstraintType::kPin;
      rebuilt.weight = {contact.n.x, contact.n.y};
      if (!contact.fixed_normal) add(Correction::kJointAxis, -2 * body2.omega * vt);
      break;
    case RecordedKind::kPathJoint:
      constraint.type = ConstraintType::kPathJoint;
      add(Correction::kPathGap, RebuildPath(contact, body1, body2, vt, dv, &constraint.feature2));
      break;
    case RecordedKind::kRod: {
      constraint.type = ConstraintType::kRod;
      constraint.length = -contact.radius2;
      rebuilt.weight = {-1, 0};
      add_normal_derivative(contact.radius2);
      const double distance = Norm((body1.x - body2.x) + (contact.R1 - contact.R2));
      add(Correction::kRodLength, vt * vt * (1 / constraint.length - 1 / distance));
      break;
    }
    case RecordedKind::kRope:
      constraint.type = ConstraintType::kRope;
      // radius2 is the current distance; the rope is longer by its slack.
      constraint.length = d - contact.radius2;
      add_normal_derivative(contact.radius2);
      break;
  }
  return rebuilt;
}

ReplayResult Replay(const ReplayRecord& record) {
  ContactSystem system{record.id, record.bodies, {}};
  std::vector<RebuiltContact> rebuilt;
  for (const RecordedContact& contact : record.contacts) {
    rebuilt.push_back(Rebuild(contact, record.bodies));
    system.constraints.push_back(rebuilt.back().constraint);
  }
  const AssembledLcp lcp = AssembleContactLcp(system);

  // Recorded rows are W times the assembled ones. Columns of geometry: n.x, n.y, d and d'.
  const auto size = static_cast<Index>(rebuilt.size());
  const auto assembled = static_cast<Index>(lcp.rows.size());
  Eigen::SparseMatrix<double> W(size, assembled);
  Eigen::MatrixXd rows_geometry(assembled, 4);
  for (Index i = 0, row = 0; i < size; ++i) {
    const RebuiltContact& contact = rebuilt[static_cast<size_t>(i)];
    const size_t rows = contact.constraint.type == ConstraintType::kPin ? 2 : 1;
    for (size_t k = 0; k < rows; ++k, ++row) {
      const RowInfo& info = lcp.rows[static_cast<size_t>(row)];
      W.insert(i, row) = contact.weight[k];
      rows_geometry.row(row) << info.n.x, info.n.y, info.d, info.d_dot;
    }
  }
  const Eigen::MatrixXd geometry = W * rows_geometry;
  const Eigen::VectorXd b = W * lcp.problem.b();

  ReplayResult result;
  result.A = W * lcp.problem.DenseA() * W.transpose();
  for (Index i = 0; i < size; ++i) {
    const RecordedContact& contact = record.contacts[static_cast<size_t>(i)];
    ReplayRow row;
    row.kind = KindText(contact);
    row.recorded = record.b[i] - contact.extra;
    row.added = rebuilt[static_cast<size_t>(i)].added;
    row.ours = b[i];
    const double d = geometry(i, 2) + rebuilt[static_cast<size_t>(i)].gap_offset;
    row.geometry_deviation =
        std::max({Norm(Vec2{geometry(i, 0), geometry(i, 1)} - contact.n), ScaledDeviation(d, contact.distance),
                  ScaledDeviation(geometry(i, 3), contact.vn)});
    result.rows.push_back(std::move(row));
  }
  return result;
}

void ReplaySummary::Tally::Take(double value, const std::string& record_id) {
  ++count;
  if (Agrees(value)) ++agree;
  if (!Exceeds(value, largest)) return;
  largest = value;
  id = record_id;
}

void ReplaySummary::Add(const ReplayRecord& record, const ReplayResult& result, const std::string& where) {
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const ReplayRow& row = result.rows[i];
    const double after = ScaledDeviation(row.ours, row.corrected());
    for (KindTally* tally : {&kinds_[row.kind], &total_}) {
      tally->before.Take(ScaledDeviation(row.ours, row.recorded), record.id);
      tally->after.Take(after, record.id);
      tally->geometry.Take(row.geometry_deviation, record.id);
    }
    for (std::size_t k = 0; k < kCorrectionCount; ++k) {
      if (row.added[k] != 0) corrections_[k].Take(std::abs(row.added[k]), record.id);
    }
    if (!Agrees(after)) {
      left_over_.push_back(
          {where, record.id, "b[" + std::to_string(i) + "] (" + row.kind + ")", row.corrected(), row.ours});
    }
  }
  double worst = 0;
  Index row = 0;
  Index column = 0;
  for (Index i = 0; i < result.A.rows(); ++i) {
    for (Index j = 0; j < result.A.cols(); ++j) {
      const double deviation = ScaledDeviation(result.A(i, j), record.A(i, j));
      if (Exceeds(deviation, worst)) std::tie(worst, row, column) = std::tuple(deviation, i, j);
    }
  }
  A_.Take(worst, record.id);
  if (Agrees(worst)) return;
  const auto kind = [&result](Index k) { return result.rows[static_cast<std::size_t>(k)].kind; };
  const std::string what = "A[" + std::to_string(row) + "][" + std::to_string(column) + "]";
  left_over_.push_back({where, record.id, what + " (" + kind(row) + ", " + kind(column) + ")", record.A(row, column),
                        result.A(row, column)});
}

std::string ReplaySummary::Table() const {
  constexpr std::size_t kMostLeftOver = 20;
  std::ostringstream out;
  out << std::setprecision(2) << records() << " records, " << total_.before.count << " rows; numbers agree within "
      << kReplayTolerance << " (1 + |recorded|)\n\n"
      << "A: " << A_.agree << " of " << records() << " records agree, largest deviation " << A_.largest
      << (A_.id.empty() ? "" : " in " + A_.id) << "\n\n"
      << "b without the stabilisation term\n"
      << "                                     as recorded         corrected     n, d, d'\n"
      << "kind                       rows    agree  largest    agree  largest    largest\n";
  const auto line = [&](const std::string& kind, const KindTally& of) {
    out << std::left << std::setw(24) << kind << std::right << std::setw(7) << of.before.count << std::setw(9)
        << of.before.agree << std::setw(9) << of.before.largest << std::setw(9) << of.after.agree << std::setw(9)
        << of.after.largest << std::setw(11) << of.geometry.largest << "\n";
  };
  for (const auto& [kind, tally] : kinds_) line(kind, tally);
  line("total", total_);
  out << "\ncorrections             rows     largest  in record   added to the recorded b\n";
  for (std::size_t k = 0; k < kCorrectionCount; ++k) {
    out << std::left << std::setw(20) << kCorrectionTexts[k].key << std::right << std::setw(8) << corrections_[k].count
        << std::setw(12) << corrections_[k].largest << "  " << std::left << std::setw(12) << corrections_[k].id
        << kCorrectionTexts[k].formula << "\n";
  }
  if (!left_over_.empty()) out << "\nleft over: " << left_over_.size() << "\n" << std::setprecision(17);
  for (std::size_t i = 0; i < left_over_.size() && i < kMostLeftOver; ++i) {
    const LeftOver& left = left_over_[i];
    out << left.where << ": " << left.id << ": " << left.what << ": corrected " << left.recorded << ", ours "
        << left.ours << "\n";
  }
  if (left_over_.size() > kMostLeftOver) out << "... (--json lists all)\n";
  return out.str();
}

std::string ReplaySummary::Json() const {
  using Json = nlohmann::ordered_json;
  Json kinds = Json::array();
  for (const auto& [kind, of] : kinds_) {
    kinds.push_back({{"kind", kind},
                     {"rows", of.before.count},
                     {"agree_before", of.before.agree},
                     {"largest_before", of.before.largest},
                     {"agree_after", of.after.agree},
                     {"largest_after", of.after.largest},
                     {"largest_geometry", of.geometry.largest}});
  }
  Json corrections = Json::array();
  for (std::size_t k = 0; k < kCorrectionCount; ++k) {
    corrections.push_back({{"key", kCorrectionTexts[k].key},
                           {"formula", kCorrectionTexts[k].formula},
                           {"rows", corrections_[k].count},
                           {"largest", corrections_[k].largest}});
  }
  Json left_over = Json::array();
  for (const LeftOver& left : left_over_) {
    left_over.push_back({{"where", left.where},
                         {"id", left.id},
                         {"what", left.what},
                         {"recorded", left.recorded},
                         {"ours", left.ours},
                         {"deviation", ScaledDeviation(left.ours, left.recorded)}});
  }
  const Json out = {{"records", records()},
                    {"rows", total_.before.count},
                    {"tolerance", kReplayTolerance},
                    {"agrees", AllAgree()},
                    {"A", {{"records", records()}, {"agree", A_.agree}, {"largest", A_.largest}, {"id", A_.id}}},
                    {"kinds", std::move(kinds)},
                    {"corrections", std::move(corrections)},
                    {"left_over", std::move(left_over)}};
  // A name may hold any bytes.
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lcpbench
