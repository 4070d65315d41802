#include "benchmarks/drawing/drawn_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "benchmarks/drawing/svg.h"
#include "model/detection/detection.h"

namespace lcpbench {
namespace {

EdgeKind KindOf(const OutlineCurve& curve) {
  const auto* arc = std::get_if<ArcEdge>(&curve);
  const bool concave = arc != nullptr && arc->side == Side::kConcave;
  constexpr std::array kByCurve{EdgeKind::kStraight, EdgeKind::kConvexArc, EdgeKind::kEllipse, EdgeKind::kSuperellipse,
                                EdgeKind::kBezier};
  static_assert(kByCurve.size() == std::variant_size_v<OutlineCurve>);
  return concave ? EdgeKind::kConcaveArc : kByCurve[curve.index()];
}

bool SameEnds(const Connector& a, const Connector& b) {
  const auto same = [](const Attachment& p, const Attachment& q) { return p.body == q.body && p.point == q.point; };
  return (same(a.end1, b.end1) && same(a.end2, b.end2)) || (same(a.end1, b.end2) && same(a.end2, b.end1));
}

double StrokeOf(double half) { return std::clamp(0.3 * half, 0.5, 1.5); }

bool OnBody2(const ContactSystem& system, const Constraint& constraint) {
  return system.bodies[static_cast<std::size_t>(constraint.body1)].fixed;
}

}  // namespace

bool IsDriven(const Body& body) {
  return body.fixed && (Norm(body.v) > 0 || body.omega != 0 || Norm(body.acceleration) > 0 || body.alpha != 0 ||
                        body.surface_speed != 0);
}

BodyPaths PathsOf(const Body& body, double unit, double band) {
  BodyPaths paths;
  const Outline outline = OutlineOf(body);
  const bool filled = !body.fixed || IsBounded(outline);
  if (filled) paths.fill = OutlinePath(outline, unit);
  for (const OutlineEdge& piece : body.outline) {
    if (!filled) paths.fill += BandPath(piece, unit, band);
    paths.edges[static_cast<std::size_t>(KindOf(piece.edge))] += PiecePath(piece, unit, "M");
  }
  return paths;
}

std::vector<Connector> ConnectorsOf(const std::vector<Constraint>& joints, const Loads* loads) {
  std::vector<Connector> connectors;
  for (const Constraint& joint : joints) {
    const auto* vertex1 = std::get_if<Vertex>(&joint.feature1);
    const auto* vertex2 = std::get_if<Vertex>(&joint.feature2);
    const Attachment end1{joint.body1, vertex1 != nullptr ? vertex1->p : Vec2{}};
    const Attachment end2{joint.body2, vertex2 != nullptr ? vertex2->p : Vec2{}};
    if (joint.type == ConstraintType::kPathJoint && (vertex1 != nullptr || vertex2 != nullptr)) {
      const bool first = vertex1 != nullptr;
      std::vector<OutlineEdge> path = joint.path;
      if (path.empty()) path = WholeCurve(first ? joint.feature2 : joint.feature1);
      connectors.push_back({"path joint", first ? end1 : end2, first ? end2 : end1, 0, 0, std::move(path)});
    }
    if (vertex1 == nullptr || vertex2 == nullptr) continue;
    if (joint.type == ConstraintType::kPin) connectors.push_back({"pin", end1, end2});
    if (joint.type == ConstraintType::kRod) connectors.push_back({"rod", end1, end2});
    if (joint.type == ConstraintType::kRope) connectors.push_back({"rope", end1, end2, joint.length, 0, {}});
  }
  if (loads == nullptr) return connectors;
  std::vector<Connector> springs;
  for (const Spring& spring : loads->springs) springs.push_back({"spring", spring.end1, spring.end2});
  std::vector<Connector> dampers;
  for (const Damper& damper : loads->dampers) {
    dampers.push_back({"damper", damper.end1, damper.end2});
    for (Connector& spring : springs) {
      if (!SameEnds(spring, dampers.back())) continue;
      spring.side = 1;
      // The same side for a damper whose ends are named the other way round.
      dampers.back().side = spring.end1.body == damper.end1.body ? -1 : 1;
    }
  }
  connectors.insert(connectors.end(), springs.begin(), springs.end());
  connectors.insert(connectors.end(), dampers.begin(), dampers.end());
  return connectors;
}

std::vector<SymbolPoint> SymbolOf(std::string_view type) {
  if (type == "damper") {
    return {{0, 0, false}, {0.35, 0},          {0.65, 1, false}, {0.35, 1},        {0.35, -1},
            {0.65, -1},    {0.52, 0.7, false}, {0.52, -0.7},     {0.52, 0, false}, {1, 0}};
  }
  std::vector<SymbolPoint> points = {{0, 0, false}};
  if (type == "spring") {
    // A sixth of the length on either side stays straight.
    constexpr int kHalfCoils = 12;
    for (int k = 0; k <= kHalfCoils; ++k) {
      points.push_back({1.0 / 6 + k * (2.0 / 3) / kHalfCoils, k % kHalfCoils == 0 ? 0.0 : k % 2 == 0 ? -1.0 : 1.0});
    }
  }
  if (type == "rope") {
    constexpr int kParts = 24;
    for (int k = 1; k < kParts; ++k) points.push_back({k / double{kParts}, 4.0 * k * (kParts - k) / (kParts * kParts)});
  }
  points.push_back({1, 0});
  return points;
}

std::string ConnectorShape(const Connector& connector, Vec2 from, Vec2 to, double half, double length) {
  const double span = Norm(to - from);
  Vec2 across = span > 0 ? (half / span) * Perp(to - from) : Vec2{};
  from = from + (1.3 * connector.side) * across;
  to = to + (1.3 * connector.side) * across;
  if (connector.type == "rope") {
    // The sag of a shallow parabola of that length; slack on the screen only where it can be seen.
    const double slack = std::min(length - span, span);
    across = {0, slack > 1e-3 * span ? std::sqrt(0.375 * span * slack) : 0};
  }
  std::string path;
  for (const SymbolPoint& point : SymbolOf(connector.type)) {
    path += (point.down ? "L" : "M") + Px(from + point.along * (to - from) + point.across * across);
  }
  if (connector.type == "rod") {
    const double width = 1.2 * half;
    return SvgPath(path, {kInkColor, width}) + SvgPath(path, {kWhite, width - std::min(1.6, width / 2)}) +
           PinShape(from, width / 2) + PinShape(to, width / 2);
  }
  std::string line = SvgPath(path, {kInkColor, StrokeOf(half)});
  if (connector.type != "rope") return line;
  const double dot = std::max(0.8, 0.35 * half);
  return line + SvgCircle(from, dot, {.fill = kInkColor}) + SvgCircle(to, dot, {.fill = kInkColor});
}

std::string PinShape(Vec2 at, double radius) { return SvgCircle(at, radius, {kInkColor, StrokeOf(radius), kWhite}); }

std::string SliderShape(Vec2 at, Vec2 normal, double radius) {
  const Vec2 n = (0.8 * radius) * normal;
  const Vec2 t = (1.4 * radius) * Perp(normal);
  return SvgPath("M" + Px(at + n + t) + "L" + Px(at + n - t) + "L" + Px(at - n - t) + "L" + Px(at - n + t) + "Z",
                 {kInkColor, StrokeOf(radius), kWhite});
}

Vec2 PlaceOf(const ContactSystem& system, const RowInfo& row) {
  const Constraint& constraint = system.constraints[static_cast<std::size_t>(row.constraint)];
  const bool distant = constraint.type == ConstraintType::kRod || constraint.type == ConstraintType::kRope;
  return distant ? (OnBody2(system, constraint) ? row.p2 : row.p1) : 0.5 * (row.p1 + row.p2);
}

namespace {

/// The rows of one force: of a pin, or of a contact and its tangent; else the first only.
struct RowsOfForce {
  std::size_t first = 0;
  std::size_t count = 1;
};

std::vector<RowsOfForce> GroupRows(const std::vector<RowInfo>& rows) {
  std::vector<RowsOfForce> groups;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && (rows[i].axis == 'y' || rows[i].axis == 't') && rows[i].constraint == rows[i - 1].constraint) {
      ++groups.back().count;
    } else {
      groups.push_back({i});
    }
  }
  return groups;
}

const Constraint& ConstraintOf(const ContactSystem& system, const RowInfo& row) {
  return system.constraints[static_cast<std::size_t>(row.constraint)];
}

bool HasTangent(const std::vector<RowInfo>& rows, const RowsOfForce& group) {
  return group.count == 2 && rows[group.first + 1].axis == 't';
}

}  // namespace

std::vector<bool> SlidingRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  constexpr double kSeen = 1e-6;  // of the largest force or motion
  std::vector<bool> slides(static_cast<std::size_t>(problem.size()), false);
  if (problem.size() == 0) return slides;
  // Sides in one unit, sqrt(A_ii) f and w / sqrt(A_ii), so that rows compare.
  const Eigen::ArrayXd D = problem.DiagonalA().array();
  const Eigen::ArrayXd root = (D > 0).select(D.sqrt(), 1);
  const Eigen::ArrayXd force = root * f.array();
  const Eigen::ArrayXd motion = w.array() / root;
  const double seen = kSeen * std::max(force.abs().maxCoeff(), motion.abs().maxCoeff());
  for (const FrictionRow& row : problem.friction_rows()) {
    const double spare = D[row.row] * (row.mu * std::max(f[row.normal], 0.0) - std::abs(f[row.row]));
    const bool bears = force[row.normal] > std::max(motion[row.normal], 0.0);
    if (bears && std::abs(w[row.row]) > spare && std::abs(motion[row.row]) > seen) {
      slides[static_cast<std::size_t>(row.normal)] = true;
    }
  }
  return slides;
}

std::vector<DrawnForce> ForcesOf(const ContactSystem& system, const std::vector<RowInfo>& rows,
                                 const Eigen::VectorXd& f, const std::vector<bool>& slides) {
  std::vector<DrawnForce> forces;
  for (const RowsOfForce& group : GroupRows(rows)) {
    Vec2 force;
    for (std::size_t i = group.first; i < group.first + group.count; ++i) {
      const double size = f[static_cast<Index>(i)];
      if (std::isfinite(size)) force = force + size * rows[i].n;
    }
    if (force.x == 0 && force.y == 0) continue;
    const bool on_body2 = OnBody2(system, ConstraintOf(system, rows[group.first]));
    forces.push_back(
        {PlaceOf(system, rows[group.first]), on_body2 ? -force : force, !slides.empty() && slides[group.first]});
  }
  return forces;
}

std::vector<DrawnCone> ConesOf(const ContactSystem& system, const std::vector<RowInfo>& rows,
                               const Eigen::VectorXd& f) {
  constexpr double kWidest = 3;  // of mu: wider cones would cover their neighbours
  std::vector<DrawnCone> cones;
  for (const RowsOfForce& group : GroupRows(rows)) {
    const double size = f[static_cast<Index>(group.first)];
    if (!HasTangent(rows, group) || !(size > 0 && std::isfinite(size))) continue;
    const Constraint& constraint = ConstraintOf(system, rows[group.first]);
    const Vec2 n = (OnBody2(system, constraint) ? -size : size) * rows[group.first].n;
    const Vec2 aside = std::min(constraint.friction, kWidest) * Perp(n);
    cones.push_back({PlaceOf(system, rows[group.first]), {n + aside, n - aside}});
  }
  return cones;
}

LegendItem ConeItem() {
  return {24, SvgPath("M24 -9L0 0L24 9Z", {kConeColor, 1, kConeColor, " fill-opacity=\"0.18\""}), "friction cone"};
}

std::string Counted(std::string_view name, std::size_t count) {
  return std::string(name) + " (" + std::to_string(count) + ")";
}

std::vector<LegendItem> LegendOf(const std::vector<Body>& bodies, const std::vector<Connector>& connectors) {
  std::vector<LegendItem> items;
  std::array<bool, kEdgeStyles.size()> edges{};
  std::array<bool, 2> fixed{};  // and driven ones
  for (const Body& body : bodies) {
    for (const OutlineEdge& piece : body.outline) edges[static_cast<std::size_t>(KindOf(piece.edge))] = true;
    if (body.fixed && !body.outline.empty()) fixed[IsDriven(body) ? 1 : 0] = true;
  }
  for (std::size_t kind = 0; kind < edges.size(); ++kind) {
    const auto& [name, color] = kEdgeStyles[kind];
    if (edges[kind]) items.push_back({24, SvgPath("M0 0h24", {color, 2.4}), std::string(name)});
  }
  for (const bool driven : {false, true}) {
    if (!fixed[driven ? 1 : 0]) continue;
    const auto& [ground, stripes] = driven ? kDrivenFill : kFixedFill;
    items.push_back(
        {24,
         SvgPath("M0 -6h24v12h-24Z", {.fill = ground}) + SvgPath(driven ? "M0 -2l8 8M4 -6l12 12M12 -6l12 12M20 -6l4 4"
                                                                        : "M0 2l8 -8M4 6l12 -12M12 6l12 -12M20 6l4 -4",
                                                                 {stripes, 1.6}),
         driven ? "driven" : "fixed"});
  }
  for (const char* type : {"pin", "path joint", "rod", "rope", "spring", "damper"}) {
    const auto is_type = [&](const Connector& connector) { return connector.type == std::string_view(type); };
    const auto count = std::count_if(connectors.begin(), connectors.end(), is_type);
    if (count == 0) continue;
    const std::string text = Counted(type, static_cast<std::size_t>(count));
    const Connector plain{type, {}, {}};
    const double y = plain.type == "rope" ? -3 : 0;
    if (plain.type == "pin") {
      items.push_back({10, PinShape({5, 0}, 4), text});
    } else if (plain.type == "path joint") {
      items.push_back({16, SliderShape({8, 0}, {0, 1}, 5), text});
    } else {
      items.push_back({34, ConnectorShape(plain, {0, y}, {34, y}, 4, 1.08 * 34), text});
    }
  }
  return items;
}

Bounds BoundsOf(const Body& body) {
  constexpr int kSamples = 24;
  Bounds bounds;
  const Rotation rotation = SinCos(body.theta);
  for (const OutlineEdge& piece : body.outline) {
    for (int k = 0; k <= kSamples; ++k) {
      const double s = piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples;
      bounds.extend(PointOf(body.x + Rotate(rotation, CurvePoint(piece.edge, s))));
    }
  }
  if (!body.fixed) bounds.extend(PointOf(body.x));
  return bounds;
}

std::vector<Bounds> BoundsOf(const std::vector<Body>& bodies) {
  std::vector<Bounds> bounds;
  bounds.reserve(bodies.size());
  for (const Body& body : bodies) bounds.push_back(BoundsOf(body));
  return bounds;
}

Bounds ViewOf(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds, const std::vector<Vec2>& points) {
  Bounds view;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed) view.extend(bounds[i]);
  }
  for (const Vec2 p : points) view.extend(PointOf(p));
  constexpr double kMuchLarger = 3;
  const double largest = kMuchLarger * ExtentOf(view);
  Bounds whole = view;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].fixed && (view.isEmpty() || ExtentOf(bounds[i]) <= largest)) whole.extend(bounds[i]);
  }
  if (whole.isEmpty()) whole.extend(Eigen::Vector2d(0, 0));
  return whole;
}

double MedianExtent(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds) {
  std::vector<double> extents;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed && !bodies[i].outline.empty()) extents.push_back(ExtentOf(bounds[i]));
  }
  if (extents.empty()) return 0;
  const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
  std::nth_element(extents.begin(), middle, extents.end());
  return *middle;
}

}  // namespace lcpbench
