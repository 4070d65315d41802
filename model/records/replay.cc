#include "model/records/replay.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "model/contact/assembly.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// The world-frame arm `r` in the frame of `body`.
Vec2 ToBody(const Body& body, Vec2 r) {
  const Rotation rotation = SinCos(body.theta);
  return Rotate({rotation.cos, -rotation.sin}, r);
}

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
  return std::string(Name(contact.kind)) + (concave ? "_concave" : "") + (world ? "_world" : "");
}

bool Agrees(double deviation) { return deviation <= kReplayTolerance; }
// Not a number counts as the largest of all.
bool Exceeds(double value, double largest) { return value > largest || std::isnan(value); }

// Two digits: deviations are compared by magnitude only.
std::string Short(double value) {
  std::ostringstream text;
  text << std::setprecision(2) << value;
  return text.str();
}

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

double ScaledDeviation(double x, double reference) { return std::abs(x - reference) / (1 + std::abs(reference)); }

void ReplaySummary::Largest::Take(double value, const std::string& record_id) {
  if (!Exceeds(value, deviation)) return;
  deviation = value;
  id = record_id;
}

void ReplaySummary::Add(const ReplayRecord& record, const ReplayResult& result, const std::string& where) {
  ++records_;
  for (size_t i = 0; i < result.rows.size(); ++i) {
    const ReplayRow& row = result.rows[i];
    const double before = ScaledDeviation(row.ours, row.recorded);
    const double after = ScaledDeviation(row.ours, row.corrected());
    for (Tally* tally : {&kinds_[row.kind], &total_}) {
      ++tally->rows;
      if (Agrees(before)) ++tally->agree_before;
      if (Agrees(after)) ++tally->agree_after;
      tally->before.Take(before, record.id);
      tally->after.Take(after, record.id);
      tally->geometry.Take(row.geometry_deviation, record.id);
    }
    for (size_t k = 0; k < kCorrectionCount; ++k) {
      if (row.added[k] == 0) continue;
      ++corrections_[k].rows;
      corrections_[k].largest.Take(std::abs(row.added[k]), record.id);
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
      A_.Take(deviation, record.id);
      if (!Exceeds(deviation, worst)) continue;
      worst = deviation;
      row = i;
      column = j;
    }
  }
  if (Agrees(worst)) {
    ++records_with_equal_A_;
    return;
  }
  const auto kind = [&result](Index k) { return result.rows[static_cast<size_t>(k)].kind; };
  const std::string what = "A[" + std::to_string(row) + "][" + std::to_string(column) + "]";
  left_over_.push_back({where, record.id, what + " (" + kind(row) + ", " + kind(column) + ")", record.A(row, column),
                        result.A(row, column)});
}

std::string ReplaySummary::Table() const {
  constexpr size_t kMostLeftOver = 20;
  std::ostringstream out;
  const auto line = [&](const std::string& kind, const Tally& tally) {
    out << std::left << std::setw(24) << kind << std::right << std::setw(7) << tally.rows << std::setw(9)
        << tally.agree_before << std::setw(9) << Short(tally.before.deviation) << std::setw(9) << tally.agree_after
        << std::setw(9) << Short(tally.after.deviation) << std::setw(11) << Short(tally.geometry.deviation) << "\n";
  };
  out << records_ << " records, " << total_.rows << " rows; numbers agree within " << kReplayTolerance
      << " (1 + |recorded|)\n\n"
      << "A: " << records_with_equal_A_ << " of " << records_ << " records agree, largest deviation "
      << Short(A_.deviation) << (A_.id.empty() ? "" : " in " + A_.id) << "\n\n"
      << "b without the stabilisation term\n"
      << "                                     as recorded         corrected     n, d, d'\n"
      << "kind                       rows    agree  largest    agree  largest    largest\n";
  for (const auto& [kind, tally] : kinds_) line(kind, tally);
  line("total", total_);
  out << "\ncorrections             rows     largest  in record   added to the recorded b\n";
  for (size_t k = 0; k < kCorrectionCount; ++k) {
    const CorrectionText& text = kCorrectionTexts[k];
    out << std::left << std::setw(20) << text.key << std::right << std::setw(8) << corrections_[k].rows << std::setw(12)
        << Short(corrections_[k].largest.deviation) << "  " << std::left << std::setw(12) << corrections_[k].largest.id
        << text.formula << "\n";
  }
  if (!left_over_.empty()) out << "\nleft over: " << left_over_.size() << "\n" << std::setprecision(17);
  for (size_t i = 0; i < left_over_.size() && i < kMostLeftOver; ++i) {
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
  for (const auto& [kind, tally] : kinds_) {
    kinds.push_back({{"kind", kind},
                     {"rows", tally.rows},
                     {"agree_before", tally.agree_before},
                     {"largest_before", tally.before.deviation},
                     {"agree_after", tally.agree_after},
                     {"largest_after", tally.after.deviation},
                     {"largest_geometry", tally.geometry.deviation}});
  }
  Json corrections = Json::array();
  for (size_t k = 0; k < kCorrectionCount; ++k) {
    const CorrectionText& text = kCorrectionTexts[k];
    corrections.push_back({{"key", text.key},
                           {"formula", text.formula},
                           {"rows", corrections_[k].rows},
                           {"largest", corrections_[k].largest.deviation}});
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
  const Json out = {
      {"records", records_},
      {"rows", total_.rows},
      {"tolerance", kReplayTolerance},
      {"agrees", AllAgree()},
      {"A", {{"records", records_}, {"agree", records_with_equal_A_}, {"largest", A_.deviation}, {"id", A_.id}}},
      {"kinds", std::move(kinds)},
      {"corrections", std::move(corrections)},
      {"left_over", std::move(left_over)}};
  // A name may hold any bytes.
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lcpbench
