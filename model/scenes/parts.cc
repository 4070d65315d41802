#include "model/scenes/parts.h"

#include <cmath>
#include <utility>

#include "model/geometry/trig.h"

namespace lcpbench {

ContactSystem EmptyScene(std::string_view family, int rows, std::uint64_t seed) {
  ContactSystem system;
  system.name = std::string(family) + "-" + std::to_string(rows) + "-s" + std::to_string(seed);
  return system;
}

Body MakeDisc(Vec2 x, double radius, double density) {
  Body body;
  body.x = x;
  body.mass = kPi * radius * radius * density;
  body.inertia = body.mass * radius * radius / 2;
  body.outline = {FullCircle({}, radius, Side::kConvex)};
  return body;
}

Body MakeBox(Vec2 x, double width, double height, double density) {
  Body body;
  body.x = x;
  body.mass = width * height * density;
  body.inertia = body.mass * (width * width + height * height) / 12;
  for (int edge = 0; edge < 4; ++edge) {
    const StraightEdge side = BoxEdge(width, height, edge);
    body.outline.push_back(WholeEdge(side.a, side.b));
  }
  return body;
}

Body MakeFixed(std::string name) {
  Body body;
  body.name = std::move(name);
  body.fixed = true;
  return body;
}

ArcEdge Circle(double radius) { return {{}, radius, Side::kConvex}; }

OutlineEdge FullCircle(Vec2 center, double radius, Side side) {
  const bool convex = side == Side::kConvex;
  return {ArcEdge{center, radius, side}, convex ? 0 : 2 * kPi, convex ? 2 * kPi : 0};
}

OutlineEdge WholeEdge(Vec2 a, Vec2 b) { return {StraightEdge{a, b}, 0, 1}; }

Vec2 BoxCorner(double width, double height, int corner) {
  const double x = corner == 0 || corner == 3 ? -width / 2 : width / 2;
  const double y = corner < 2 ? -height / 2 : height / 2;
  return {x, y};
}

StraightEdge BoxEdge(double width, double height, int edge) {
  return {BoxCorner(width, height, edge), BoxCorner(width, height, (edge + 1) % 4)};
}

EllipseEdge Oval(double a, double b) { return {{}, a, b, 0, Side::kConvex}; }

Body MakeOval(Vec2 x, double theta, double a, double b, double density) {
  Body body;
  body.x = x;
  body.theta = theta;
  body.mass = kPi * a * b * density;
  body.inertia = body.mass * (a * a + b * b) / 4;
  body.outline = {OutlineEdge{Oval(a, b), 0, 2 * kPi}};
  return body;
}

Body MakeRing(Vec2 x, double outer_radius, double inner_radius, double density) {
  const double squares = outer_radius * outer_radius + inner_radius * inner_radius;
  Body body;
  body.x = x;
  body.mass = kPi * (outer_radius - inner_radius) * (outer_radius + inner_radius) * density;
  body.inertia = body.mass * squares / 2;
  body.outline = {FullCircle({}, outer_radius, Side::kConvex), FullCircle({}, inner_radius, Side::kConcave)};
  return body;
}

ArcEdge RoundedBoxShape::Corner(int corner_index) const {
  return {BoxCorner(width - 2 * corner, height - 2 * corner, corner_index), corner, Side::kConvex};
}

StraightEdge RoundedBoxShape::Edge(int edge) const {
  // The edge of the whole box, shortened by a corner at both ends.
  return edge % 2 == 0 ? BoxEdge(width - 2 * corner, height, edge) : BoxEdge(width, height - 2 * corner, edge);
}

Body MakeRoundedBox(Vec2 x, const RoundedBoxShape& shape, double density) {
  const double w = shape.width;
  const double h = shape.height;
  const double r = shape.corner;
  // The box, less a square at each corner, and a quarter disc about each corner's centre c instead. Moments per
  // density about the middle; a quarter disc's centroid is 4 r / (3 pi) from c along both axes.
  const Vec2 c{w / 2 - r, h / 2 - r};
  const Vec2 square{(w - r) / 2, (h - r) / 2};
  const double quarter = kPi * r * r / 4;
  const double centroid = 4 * r / (3 * kPi);
  const double square_inertia = r * r * (r * r / 6 + Dot(square, square));
  const double quarter_inertia = kPi * r * r * r * r / 8 + quarter * (Dot(c, c) + 2 * centroid * (c.x + c.y));
  Body body;
  body.x = x;
  body.mass = density * (w * h - 4 * (r * r - quarter));
  body.inertia = density * (w * h * (w * w + h * h) / 12 - 4 * (square_inertia - quarter_inertia));
  for (int k = 0; k < 4; ++k) {
    const StraightEdge edge = shape.Edge(k);
    body.outline.push_back(WholeEdge(edge.a, edge.b));
    // After the bottom comes the lower right corner, whose normals turn from down to right.
    body.outline.push_back({shape.Corner((k + 1) % 4), (k - 1) * kPi / 2, k * kPi / 2});
  }
  return body;
}

Vec2 NextAlongArc(Vec2 direction, double r1, double r2, double arc) {
  const double sin_half = std::sqrt(r1 * r2 / ((arc - r1) * (arc - r2)));
  const double cos_half = std::sqrt(1 - sin_half * sin_half);
  const Rotation step{1 - 2 * sin_half * sin_half, 2 * sin_half * cos_half};
  const Vec2 next = Rotate(step, direction);
  return (1 / Norm(next)) * next;
}

Vec2 NotchPoint(Vec2 center1, double reach1, Vec2 center2, double reach2) {
  const Vec2 between = center2 - center1;
  const double distance = Norm(between);
  const Vec2 unit = (1 / distance) * between;
  const double along = (reach1 * reach1 - reach2 * reach2 + distance * distance) / (2 * distance);
  return center1 + along * unit + std::sqrt(reach1 * reach1 - along * along) * Perp(unit);
}

int AddBody(ContactSystem* system, std::string_view kind, Body body) {
  const int index = static_cast<int>(system->bodies.size());
  if (body.name.empty()) body.name = std::string(kind) + " " + std::to_string(index);
  system->bodies.push_back(std::move(body));
  return index;
}

void AddContact(ContactSystem* system, int body1, const Feature& feature1, int body2, const Feature& feature2) {
  Constraint contact;
  contact.type = ConstraintType::kContact;
  contact.body1 = body1;
  contact.body2 = body2;
  contact.feature1 = feature1;
  contact.feature2 = feature2;
  system->constraints.push_back(contact);
}

void ApplyLoads(ContactSystem* system, const LoadLevel& level, Random* random) {
  for (Body& body : system->bodies) {
    if (body.fixed) continue;
    const Vec2 gust = random->InUnitDisc();
    const double twist = random->Uniform(-1, 1);
    body.force = body.mass * (level.gust * gust + Vec2{0, -level.weight});
    body.torque = body.mass * level.gust * level.lever_per_gyradius * std::sqrt(body.inertia / body.mass) * twist;
  }
}

}  // namespace lcpbench
