#include "model/records/replay.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "model/contact/assembly.h"
#include "model/geometry/trig.h"
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

// Relative velocity at the ends of the centre arms, as the software takes it.
Vec2 RelativeVelocity(const RecordedContact& contact, const std::vector<Body>& bodies) {
  const Body& body1 = bodies[static_cast<size_t>(contact.body1)];
  const Body& body2 = bodies[static_cast<size_t>(contact.body2)];
  return (body1.v + body1.omega * Perp(contact.U1)) - (body2.v + body2.omega * Perp(contact.U2));
}

// The software gives n' of a path, not its curvature: on a fixed body n' = kappa u t. At u = 0 any curvature will do.
double PathCurvature(const RecordedContact& contact, Vec2 dv) {
  const Vec2 t = Perp(contact.n);
  const double u = Dot(t, dv);
  return u == 0 ? 0 : Dot(t, contact.normal_dt) / u;
}

double AttachmentDistance(const RecordedContact& contact, const std::vector<Body>& bodies) {
  const Vec2 dx = bodies[static_cast<size_t>(contact.body1)].x - bodies[static_cast<size_t>(contact.body2)].x;
  return Norm(dx + (contact.R1 - contact.R2));
}

std::string KindText(const RecordedContact& contact) {
  switch (contact.kind) {
    case RecordedKind::kVertexStraight:
      return "vertex_straight";
    case RecordedKind::kVertexCurved:
      return contact.radius2 < 0 ? "vertex_curved_concave" : "vertex_curved";
    case RecordedKind::kStraightCurved:
      return "straight_curved";
    case RecordedKind::kCurvedCurved:
      return contact.radius1 < 0 || contact.radius2 < 0 ? "curved_curved_concave" : "curved_curved";
    case RecordedKind::kVertexVertex:
      return "vertex_vertex";
    case RecordedKind::kJoint:
      return contact.fixed_normal ? "joint_world" : "joint";
    case RecordedKind::kPathJoint:
      return "path_joint";
    case RecordedKind::kRod:
      return "rod";
    case RecordedKind::kRope:
      return "rope";
  }
  return "unknown";
}

std::array<double, kCorrectionCount> Corrections(const RecordedContact& contact, const std::vector<Body>& bodies) {
  std::array<double, kCorrectionCount> added{};
  const auto add = [&](Correction correction, double value) { added[static_cast<size_t>(correction)] = value; };
  const Vec2 dv = RelativeVelocity(contact, bodies);
  const double vn = Dot(contact.n, dv);
  const double u = Dot(Perp(contact.n), dv);
  const double omega1 = bodies[static_cast<size_t>(contact.body1)].omega;
  const double omega2 = bodies[static_cast<size_t>(contact.body2)].omega;
  const auto add_normal_derivative = [&](double rho) { add(Correction::kNormalDerivative, -vn * vn / rho); };
  switch (contact.kind) {
    case RecordedKind::kStraightCurved:
      // Exact at any gap: radius1 contains it.
      break;
    case RecordedKind::kVertexStraight:
      add(Correction::kVertexAboveEdge, -contact.distance * (omega1 - omega2) * (omega1 - omega2));
      break;
    case RecordedKind::kVertexCurved:
    case RecordedKind::kRope:
      add_normal_derivative(contact.radius2);
      break;
    case RecordedKind::kCurvedCurved:
      add_normal_derivative(contact.radius1 + contact.radius2);
      break;
    case RecordedKind::kVertexVertex:
      add_normal_derivative(contact.radius2);
      add(Correction::kVertexAboveVertex, 2 * omega1 * u);
      break;
    case RecordedKind::kJoint:
      if (!contact.fixed_normal) add(Correction::kJointAxis, -2 * omega2 * u);
      break;
    case RecordedKind::kPathJoint: {
      const double kappa = PathCurvature(contact, dv);
      add(Correction::kPathGap, kappa * u * u / (1 + kappa * contact.distance) - Dot(contact.normal_dt, dv));
      break;
    }
    case RecordedKind::kRod:
      add_normal_derivative(contact.radius2);
      add(Correction::kRodLength, u * u * (1 / -contact.radius2 - 1 / AttachmentDistance(contact, bodies)));
      break;
  }
  return added;
}

// The rows of the assembled system that make up one recorded row.
struct RowSum {
  std::array<Index, 2> row{};
  std::array<double, 2> weight{};

  template <class Value>
  double Over(const Value& value) const {
    // A single row keeps its bits.
    return weight[1] == 0 ? weight[0] * value(row[0]) : weight[0] * value(row[0]) + weight[1] * value(row[1]);
  }
};

}  // namespace

CorrectionText Text(Correction correction) {
  switch (correction) {
    case Correction::kNormalDerivative:
      return {"normal-derivative", "-vn^2/rho"};
    case Correction::kVertexAboveEdge:
      return {"vertex-above-edge", "-d (omega1 - omega2)^2"};
    case Correction::kVertexAboveVertex:
      return {"vertex-above-vertex", "2 omega1 u"};
    case Correction::kJointAxis:
      return {"joint-axis", "-2 omega2 u"};
    case Correction::kRodLength:
      return {"rod-length", "u^2 (1/L - 1/l)"};
    case Correction::kPathGap:
      return {"path-gap", "kappa u^2/(1 + kappa d) - n'.dv"};
  }
  return {"unknown", ""};
}

RebuiltContact Rebuild(const RecordedContact& contact, const std::vector<Body>& bodies) {
  const Body& body1 = bodies[static_cast<size_t>(contact.body1)];
  const Body& body2 = bodies[static_cast<size_t>(contact.body2)];
  const double d = contact.distance;
  RebuiltContact rebuilt;
  Constraint& constraint = rebuilt.constraint;
  constraint.body1 = contact.body1;
  constraint.body2 = contact.body2;
  constraint.nominal_gap = d;
  rebuilt.weight = {1, 0};
  switch (contact.kind) {
    case RecordedKind::kVertexStraight:
      // Both arms lead to the edge; the vertex is d above it.
      constraint.feature1 = VertexAt(body1, contact.R1 + d * contact.n);
      constraint.feature2 = LineThrough(body2, contact.R2, contact.n);
      break;
    case RecordedKind::kVertexCurved:
      constraint.feature1 = VertexAt(body1, contact.R1);
      constraint.feature2 = ArcAbout(body2, contact.U2, contact.radius2 - d);
      break;
    case RecordedKind::kStraightCurved:
      constraint.feature1 = ArcAbout(body1, contact.U1, contact.radius1 - d);
      constraint.feature2 = LineThrough(body2, contact.R2, contact.n);
      break;
    case RecordedKind::kCurvedCurved:
      constraint.feature1 = ArcAbout(body1, contact.U1, contact.radius1 - d / 2);
      constraint.feature2 = ArcAbout(body2, contact.U2, contact.radius2 - d / 2);
      break;
    case RecordedKind::kVertexVertex:
      constraint.type = ConstraintType::kRod;
      // Both arms lead to vertex 2.
      constraint.feature1 = VertexAt(body1, contact.R1 + d * contact.n);
      constraint.feature2 = VertexAt(body2, contact.R2);
      constraint.length = d;
      rebuilt.gap_offset = d;
      break;
    case RecordedKind::kJoint:
      constraint.type = ConstraintType::kPin;
      constraint.feature1 = VertexAt(body1, contact.R1);
      constraint.feature2 = VertexAt(body2, contact.R2);
      rebuilt.weight = {contact.n.x, contact.n.y};
      break;
    case RecordedKind::kPathJoint: {
      constraint.type = ConstraintType::kPathJoint;
      constraint.feature1 = VertexAt(body1, contact.R1);
      const double kappa = PathCurvature(contact, RelativeVelocity(contact, bodies));
      // The point of the path below the vertex by n and d. The recorded one is off it along t, by up to 5e-7 m.
      const Vec2 foot = (body1.x - body2.x) + contact.R1 - d * contact.n;
      constraint.feature2 =
          kappa == 0 ? LineThrough(body2, foot, contact.n) : ArcAbout(body2, foot - (1 / kappa) * contact.n, 1 / kappa);
      break;
    }
    case RecordedKind::kRod:
      constraint.type = ConstraintType::kRod;
      constraint.feature1 = VertexAt(body1, contact.R1);
      constraint.feature2 = VertexAt(body2, contact.R2);
      constraint.length = -contact.radius2;
      rebuilt.weight = {-1, 0};
      break;
    case RecordedKind::kRope:
      constraint.type = ConstraintType::kRope;
      constraint.feature1 = VertexAt(body1, contact.R1);
      constraint.feature2 = VertexAt(body2, contact.R2);
      // radius2 is the current distance; the rope is longer by its slack.
      constraint.length = d - contact.radius2;
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

  std::vector<RowSum> sums(rebuilt.size());
  for (size_t i = 0, row = 0; i < rebuilt.size(); ++i) {
    const bool pin = rebuilt[i].constraint.type == ConstraintType::kPin;
    sums[i].row = {static_cast<Index>(row), static_cast<Index>(pin ? row + 1 : row)};
    sums[i].weight = rebuilt[i].weight;
    row += pin ? 2 : 1;
  }

  ReplayResult result;
  for (size_t i = 0; i < sums.size(); ++i) {
    const RecordedContact& contact = record.contacts[i];
    const auto info = [&](Index row) -> const RowInfo& { return lcp.rows[static_cast<size_t>(row)]; };
    ReplayRow row;
    row.kind = KindText(contact);
    row.recorded = record.b[static_cast<Index>(i)] - contact.extra;
    row.added = Corrections(contact, record.bodies);
    row.ours = sums[i].Over([&](Index k) { return lcp.problem.b()[k]; });
    const Vec2 n = {sums[i].Over([&](Index k) { return info(k).n.x; }),
                    sums[i].Over([&](Index k) { return info(k).n.y; })};
    const double d = sums[i].Over([&](Index k) { return info(k).d; }) + rebuilt[i].gap_offset;
    const double d_dot = sums[i].Over([&](Index k) { return info(k).d_dot; });
    row.geometry_deviation =
        std::max({Norm(n - contact.n), ScaledDeviation(d, contact.distance), ScaledDeviation(d_dot, contact.vn)});
    result.rows.push_back(std::move(row));
  }

  const Eigen::MatrixXd& A = lcp.problem.DenseA();
  const auto n = static_cast<Index>(sums.size());
  result.A.resize(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      result.A(i, j) = sums[static_cast<size_t>(i)].Over(
          [&](Index k) { return sums[static_cast<size_t>(j)].Over([&](Index l) { return A(k, l); }); });
    }
  }
  return result;
}

double ScaledDeviation(double x, double reference) { return std::abs(x - reference) / (1 + std::abs(reference)); }

}  // namespace lcpbench
