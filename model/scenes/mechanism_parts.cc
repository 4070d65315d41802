#include "model/scenes/mechanism_parts.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/closest_points.h"
#include "model/contact/contact_row.h"
#include "model/geometry/trig.h"
#include "model/scenes/parts.h"

namespace lcpbench {
namespace {

const Body& BodyOf(const ContactSystem& system, int i) { return system.bodies[static_cast<std::size_t>(i)]; }

Constraint Between(ConstraintType type, int body1, const Feature& feature1, int body2, const Feature& feature2) {
  Constraint constraint;
  constraint.type = type;
  constraint.body1 = body1;
  constraint.body2 = body2;
  constraint.feature1 = feature1;
  constraint.feature2 = feature2;
  return constraint;
}

void AddConnector(ConstraintType type, ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2) {
  Constraint connector = Between(type, body1, Vertex{p1}, body2, Vertex{p2});
  connector.length = Norm(WorldPoint(BodyOf(*system, body1), p1) - WorldPoint(BodyOf(*system, body2), p2));
  system->constraints.push_back(connector);
}

/// The row of a contact, path joint, rod or rope.
ContactRow RowOf(const ContactSystem& system, const Constraint& constraint) {
  const Body& body1 = BodyOf(system, constraint.body1);
  const Body& body2 = BodyOf(system, constraint.body2);
  const Rotation turn1 = SinCos(body1.theta);
  const Rotation turn2 = SinCos(body2.theta);
  if (constraint.type == ConstraintType::kRod || constraint.type == ConstraintType::kRope) {
    return ComputeConnectorRow(std::get<Vertex>(constraint.feature1).p, turn1, body1,
                               std::get<Vertex>(constraint.feature2).p, turn2, body2, constraint.length)
        .row;
  }
  const Regularity required =
      constraint.type == ConstraintType::kContact ? Regularity::kLocalMinimum : Regularity::kNonzeroD;
  const ClosestPoints closest = FindClosestPoints({constraint.feature1, body1.x, turn1, body1.theta},
                                                  {constraint.feature2, body2.x, turn2, body2.theta},
                                                  {constraint.s1, constraint.s2, constraint.nominal_gap}, required);
  return ComputeContactRow(closest, body1, body2);
}

bool IsUnilateral(const Constraint& constraint) {
  return constraint.type == ConstraintType::kContact || constraint.type == ConstraintType::kRope;
}

/// Opposite forces on the constraint's two sides: alone they would accelerate its gap by that much.
void PushApart(ContactSystem* system, const Constraint& constraint, double acceleration) {
  const ContactRow row = RowOf(*system, constraint);
  // A rope's row is that of a rod negated: its gap opens as the two points approach.
  const double sign = constraint.type == ConstraintType::kRope ? -1 : 1;
  double diagonal = 0;
  const auto body_of = [&](std::size_t side) -> Body& {
    return system->bodies[static_cast<std::size_t>(side == 0 ? constraint.body1 : constraint.body2)];
  };
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const Body& body = body_of(side);
    const double* J = &row.J[3 * side];
    if (!body.fixed) diagonal += (J[0] * J[0] + J[1] * J[1]) / body.mass + J[2] * J[2] / body.inertia;
  }
  const double force = sign * acceleration / diagonal;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    Body& body = body_of(side);
    const double* J = &row.J[3 * side];
    if (body.fixed) continue;
    body.force = body.force + force * Vec2{J[0], J[1]};
    body.torque += force * J[2];
  }
}

}  // namespace

void AddPin(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2) {
  system->constraints.push_back(Between(ConstraintType::kPin, body1, Vertex{p1}, body2, Vertex{p2}));
}

void AddRod(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2) {
  AddConnector(ConstraintType::kRod, system, body1, p1, body2, p2);
}

void AddRope(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2) {
  AddConnector(ConstraintType::kRope, system, body1, p1, body2, p2);
}

void AddPathJoint(ContactSystem* system, int body1, Vec2 p1, int body2, const Feature& edge2,
                  std::optional<double> s2) {
  Constraint joint = Between(ConstraintType::kPathJoint, body1, Vertex{p1}, body2, edge2);
  joint.s2 = s2;
  system->constraints.push_back(joint);
}

Vec2 WorldPoint(const Body& body, Vec2 p) { return body.x + Rotate(SinCos(body.theta), p); }

Vec2 BodyPoint(const Body& body, Vec2 p) {
  const Rotation turn = SinCos(body.theta);
  return Rotate({turn.cos, -turn.sin}, p - body.x);
}

Vec2 VelocityAt(const Body& body, Vec2 p) { return body.v + body.omega * Perp(p - body.x); }

void TurnAboutOrigin(Body* body, double omega) {
  body->omega = omega;
  body->v = omega * Perp(body->x);
}

ContactRow LastRow(const ContactSystem& system) { return RowOf(system, system.constraints.back()); }

void LoadEnds(ContactSystem* system, const EndLoads& loads) {
  const std::vector<Constraint>& constraints = system->constraints;
  const auto first = std::find_if(constraints.begin(), constraints.end(), IsUnilateral);
  const auto last = std::find_if(constraints.rbegin(), constraints.rend(), IsUnilateral);
  if (first == constraints.end() || &*first == &*last) return;
  PushApart(system, *first, -loads.squeeze);
  PushApart(system, *last, loads.burst);
}

Body MakeKinematic(std::string name, const Outline& outline) {
  Body body = MakeFixed(std::move(name));
  body.outline = AllPieces(outline);
  return body;
}

}  // namespace lcpbench
