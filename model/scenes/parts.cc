#include "model/scenes/parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/contact/assembly.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

Body Plate(Vec2 x, double mass, double inertia, std::vector<OutlineEdge> outline) {
  Body body;
  body.x = x;
  body.mass = mass;
  body.inertia = inertia;
  body.outline = std::move(outline);
  return body;
}

const Body& BodyOf(const ContactSystem& system, int i) { return system.bodies[static_cast<std::size_t>(i)]; }

/// The constraint and its two bodies, assembled.
AssembledLcp PairOf(const ContactSystem& system, Constraint constraint) {
  ContactSystem pair{"", {BodyOf(system, constraint.body1), BodyOf(system, constraint.body2)}, {}};
  constraint.body1 = 0;
  constraint.body2 = 1;
  pair.constraints = {constraint};
  return AssembleContactLcp(pair);
}

bool IsUnilateral(const Constraint& constraint) {
  return constraint.type == ConstraintType::kContact || constraint.type == ConstraintType::kRope;
}

/// Opposite forces on the constraint's two sides: alone they would accelerate its gap by that much.
void PushApart(ContactSystem* system, const Constraint& constraint, double acceleration) {
  const AssembledLcp pair = PairOf(*system, constraint);
  const auto J = [&pair](Index k) { return pair.problem.J().coeff(0, k); };
  double diagonal = 0;
  for (const auto& [body_index, k] : {std::pair{constraint.body1, Index{0}}, {constraint.body2, Index{3}}}) {
    const Body& body = BodyOf(*system, body_index);
    if (!body.fixed) diagonal += (J(k) * J(k) + J(k + 1) * J(k + 1)) / body.mass + J(k + 2) * J(k + 2) / body.inertia;
  }
  const double force = acceleration / diagonal;
  for (const auto& [body_index, k] : {std::pair{constraint.body1, Index{0}}, {constraint.body2, Index{3}}}) {
    Body& body = system->bodies[static_cast<std::size_t>(body_index)];
    if (body.fixed) continue;
    body.force = body.force + force * Vec2{J(k), J(k + 1)};
    body.torque += force * J(k + 2);
  }
}

}  // namespace

Vec2 Direction(double angle) {
  const Rotation u = SinCos(angle);
  return {u.cos, u.sin};
}

Rotation OfSine(double sine) { return {std::sqrt((1 - sine) * (1 + sine)), sine}; }

Vec2 Turned(Vec2 direction, Rotation turn) { return Normalized(Rotate(turn, direction)); }

ContactSystem EmptyScene(std::string_view family, int rows, std::uint64_t seed) {
  return {std::string(family) + "-" + std::to_string(rows) + "-s" + std::to_string(seed), {}, {}};
}

Body MakeDisc(Vec2 x, double radius, double density) {
  const double mass = kPi * radius * radius * density;
  return Plate(x, mass, mass * radius * radius / 2, {FullCircle({}, radius, Side::kConvex)});
}

Body MakeBox(Vec2 x, double width, double height, double density) {
  const double mass = width * height * density;
  return Plate(x, mass, mass * (width * width + height * height) / 12,
               Sides({-width / 2, -height / 2}, {width / 2, height / 2}));
}

Body MakeOval(Vec2 x, double theta, double a, double b, double density) {
  const double mass = kPi * a * b * density;
  Body body = Plate(x, mass, mass * (a * a + b * b) / 4, {{EllipseEdge{{}, a, b, 0, Side::kConvex}, 0, 2 * kPi}});
  body.theta = theta;
  return body;
}

Body MakeRing(Vec2 x, double outer_radius, double inner_radius, double density) {
  const double squares = outer_radius * outer_radius + inner_radius * inner_radius;
  const double mass = kPi * (outer_radius - inner_radius) * (outer_radius + inner_radius) * density;
  return Plate(x, mass, mass * squares / 2,
               {FullCircle({}, outer_radius, Side::kConvex), FullCircle({}, inner_radius, Side::kConcave)});
}

Body MakeRoundedBox(Vec2 x, double w, double h, double r, double density) {
  // The box, less a square at each corner, and a quarter disc about each corner's centre c instead. Moments per
  // density about the middle; a quarter disc's centroid is 4 r / (3 pi) from c along both axes.
  const Vec2 c{w / 2 - r, h / 2 - r};
  const Vec2 square{(w - r) / 2, (h - r) / 2};
  const double quarter = kPi * r * r / 4;
  const double centroid = 4 * r / (3 * kPi);
  const double square_inertia = r * r * (r * r / 6 + Dot(square, square));
  const double quarter_inertia = kPi * r * r * r * r / 8 + quarter * (Dot(c, c) + 2 * centroid * (c.x + c.y));
  const double mass = density * (w * h - 4 * (r * r - quarter));
  const double inertia = density * (w * h * (w * w + h * h) / 12 - 4 * (square_inertia - quarter_inertia));
  // Sides shortened by a corner at both ends, and the corner after each: after the bottom comes the lower right one,
  // whose normals turn from down to right.
  const Vec2 low{-w / 2, -h / 2};
  const Vec2 inner{-(w - 2 * r) / 2, -(h - 2 * r) / 2};
  const std::vector<OutlineEdge> flat = Sides({inner.x, low.y}, -Vec2{inner.x, low.y});
  const std::vector<OutlineEdge> upright = Sides({low.x, inner.y}, -Vec2{low.x, inner.y});
  const std::vector<OutlineEdge> centers = Sides(inner, -inner);
  std::vector<OutlineEdge> outline;
  for (int k = 0; k < 4; ++k) {
    const auto i = static_cast<std::size_t>(k);
    outline.push_back(k % 2 == 0 ? flat[i] : upright[i]);
    const Vec2 center = std::get<StraightEdge>(centers[i].edge).b;
    outline.push_back({ArcEdge{center, r, Side::kConvex}, (k - 1) * kPi / 2, k * kPi / 2});
  }
  return Plate(x, mass, inertia, std::move(outline));
}

Body MakePlate(Outline outline, double density) {
  outline.name.clear();
  return MakeBody(outline, density);
}

Body MakeFixed(std::string name, std::vector<OutlineEdge> outline) {
  Body body;
  body.name = std::move(name);
  body.fixed = true;
  body.outline = std::move(outline);
  return body;
}

ArcEdge Circle(double radius) { return {{}, radius, Side::kConvex}; }

OutlineEdge FullCircle(Vec2 center, double radius, Side side) {
  const bool convex = side == Side::kConvex;
  return {ArcEdge{center, radius, side}, convex ? 0 : 2 * kPi, convex ? 2 * kPi : 0};
}

OutlineEdge WholeEdge(Vec2 a, Vec2 b) { return {StraightEdge{a, b}, 0, 1}; }

std::vector<OutlineEdge> Polyline(const std::vector<Vec2>& points) {
  std::vector<OutlineEdge> edges;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) edges.push_back(WholeEdge(points[k], points[k + 1]));
  return edges;
}

std::vector<OutlineEdge> Sides(Vec2 low, Vec2 high) {
  return Polyline({low, {high.x, low.y}, high, {low.x, high.y}, low});
}

Vec2 NextAlongArc(Vec2 direction, double r1, double r2, double arc) {
  const double sin_half = std::sqrt(r1 * r2 / ((arc - r1) * (arc - r2)));
  const double cos_half = std::sqrt(1 - sin_half * sin_half);
  return Turned(direction, {1 - 2 * sin_half * sin_half, 2 * sin_half * cos_half});
}

CircleMeeting MeetingOf(Vec2 center1, double reach1, Vec2 center2, double reach2) {
  const Vec2 between = center2 - center1;
  const double distance = Norm(between);
  const Vec2 unit = (1 / distance) * between;
  const double along = (reach1 * reach1 - reach2 * reach2 + distance * distance) / (2 * distance);
  return {center1 + along * unit, unit, reach1 * reach1 - along * along};
}

Vec2 VelocityAt(const Body& body, Vec2 p) { return body.v + body.omega * Perp(p - body.x); }

int AddBody(ContactSystem* system, std::string_view kind, Body body) {
  const int index = static_cast<int>(system->bodies.size());
  if (body.name.empty()) body.name = std::string(kind) + " " + std::to_string(index);
  system->bodies.push_back(std::move(body));
  return index;
}

Constraint& AddConstraint(ContactSystem* system, ConstraintType type, int body1, const Feature& feature1, int body2,
                          const Feature& feature2) {
  Constraint constraint{type, body1, body2, feature1, feature2, {}, {}, 0, 0};
  if (type == ConstraintType::kRod || type == ConstraintType::kRope) {
    constraint.length = Norm(WorldPoint(BodyOf(*system, body1), std::get<Vertex>(feature1).p) -
                             WorldPoint(BodyOf(*system, body2), std::get<Vertex>(feature2).p));
  }
  return system->constraints.emplace_back(constraint);
}

double StillVelocity(const ContactSystem& system, std::size_t component) {
  const AssembledLcp pair = PairOf(system, system.constraints.back());
  return -pair.rows[0].d_dot / pair.problem.J().coeff(0, static_cast<Index>(component));
}

void LoadEnds(ContactSystem* system, const EndLoads& loads) {
  const std::vector<Constraint>& constraints = system->constraints;
  const auto first = std::find_if(constraints.begin(), constraints.end(), IsUnilateral);
  const auto last = std::find_if(constraints.rbegin(), constraints.rend(), IsUnilateral);
  if (first == constraints.end() || &*first == &*last) return;
  PushApart(system, *first, -loads.squeeze);
  PushApart(system, *last, loads.burst);
}

}  // namespace lcpbench
