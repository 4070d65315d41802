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

Vec2 NextAlongArc(Vec2 direction, double r1, double r2, double arc) {
  const double sin_half = std::sqrt(r1 * r2 / ((arc - r1) * (arc - r2)));
  const double cos_half = std::sqrt(1 - sin_half * sin_half);
  const Rotation step{1 - 2 * sin_half * sin_half, 2 * sin_half * cos_half};
  const Vec2 next = Rotate(step, direction);
  return (1 / Norm(next)) * next;
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
