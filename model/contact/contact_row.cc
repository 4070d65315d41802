#include "model/contact/contact_row.h"

#include <cmath>

#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {

SearchStart StartOf(const Constraint& constraint) {
  return {constraint.s1, constraint.s2, constraint.nominal_gap, !constraint.path.empty()};
}

ClosestPoints FindClosestPoints(const Constraint& constraint, std::span<const Body> bodies, Regularity required) {
  const Body& body1 = bodies[static_cast<std::size_t>(constraint.body1)];
  const Body& body2 = bodies[static_cast<std::size_t>(constraint.body2)];
  return FindClosestPoints({constraint.feature1, body1.x, SinCos(body1.theta), body1.theta},
                           {constraint.feature2, body2.x, SinCos(body2.theta), body2.theta}, StartOf(constraint),
                           required);
}

double DistanceOfEnds(const Constraint& connector, std::span<const Body> bodies) {
  const Body& body1 = bodies[static_cast<std::size_t>(connector.body1)];
  const Body& body2 = bodies[static_cast<std::size_t>(connector.body2)];
  const Vec2 R1 = Rotate(SinCos(body1.theta), std::get<Vertex>(connector.feature1).p);
  const Vec2 R2 = Rotate(SinCos(body2.theta), std::get<Vertex>(connector.feature2).p);
  return Norm((body1.x - body2.x) + (R1 - R2));
}

bool HasNoDirection(const Constraint& rope, std::span<const Body> bodies) {
  return IsVertex(rope.feature1) && IsVertex(rope.feature2) && rope.length > 0 && std::isfinite(rope.length) &&
         DistanceOfEnds(rope, bodies) <= kSingularD * rope.length;
}

double TurningSlip(const Constraint& pin, std::span<const Body> bodies) {
  return bodies[static_cast<std::size_t>(pin.body1)].omega - bodies[static_cast<std::size_t>(pin.body2)].omega -
         pin.speed;
}

ContactRow ComputeContactRow(const ClosestPoints& closest, const Body& body1, const Body& body2) {
  const Vec2 n = closest.n;
  const Vec2 t = Perp(n);
  const double w1 = body1.omega;
  const double w2 = body2.omega;
  const auto [r1, s1] = closest.curvature1;
  const auto [r2, s2] = closest.curvature2;
  const double d = closest.d;
  const double D = closest.D();
  const double n_R1 = Dot(n, closest.R1);
  const double n_R2 = Dot(n, closest.R2);
  // Differences of velocity first: then a boost of the whole world costs no accuracy.
  const Vec2 dv = body1.v - body2.v;
  const double dw = w1 - w2;

  ContactRow row;
  row.J = {n.x, n.y, closest.moment1, -n.x, -n.y, -closest.moment2};
  row.d_dot = Dot(n, dv) + (w1 * closest.moment1 - w2 * closest.moment2);
  // t.(omega z x R) = omega n.R
  const double u = Dot(t, dv) + (w1 * n_R1 - w2 * n_R2);
  const double turning = r1 * s2 * w1 + s1 * r2 * w2;
  const double turning_squared = r1 * s2 * (w1 * w1) + s1 * r2 * (w2 * w2);
  row.omega_n = (s1 * s2 * u + turning) / D;
  const double curved = s1 * s2 * (u * u) + 2 * u * turning - r1 * r2 * (dw * dw) - d * turning_squared;
  row.gamma = (w2 * w2) * n_R2 - (w1 * w1) * n_R1 + curved / D;
  return row;
}

TangentRow ComputeTangentRow(const ClosestPoints& closest, const Body& body1, const Body& body2,
                             const ContactRow& row) {
  const Vec2 t = Perp(closest.n);
  const double w1 = body1.omega;
  const double w2 = body2.omega;
  // R x t = n.R
  const double arm1 = Dot(closest.n, closest.R1);
  const double arm2 = Dot(closest.n, closest.R2);
  TangentRow tangent;
  tangent.J = {t.x, t.y, arm1, -t.x, -t.y, -arm2};
  tangent.slip = Dot(t, body1.v - body2.v) + (w1 * arm1 - w2 * arm2);
  tangent.gamma = ((w2 * w2) * Dot(t, closest.R2) - (w1 * w1) * Dot(t, closest.R1)) - row.omega_n * row.d_dot;
  return tangent;
}

PinRows ComputePinRows(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                       const Rotation& rotation2, const Body& body2) {
  PinRows pin;
  pin.R1 = Rotate(rotation1, vertex1);
  pin.R2 = Rotate(rotation2, vertex2);
  const double w1 = body1.omega;
  const double w2 = body2.omega;
  const Vec2 g = (body1.x - body2.x) + (pin.R1 - pin.R2);
  const Vec2 g_dot = (body1.v - body2.v) + (w1 * Perp(pin.R1) - w2 * Perp(pin.R2));
  const Vec2 gamma = (w2 * w2) * pin.R2 - (w1 * w1) * pin.R1;
  pin.J[0] = {1, 0, -pin.R1.y, -1, 0, pin.R2.y};
  pin.J[1] = {0, 1, pin.R1.x, 0, -1, -pin.R2.x};
  pin.g = {g.x, g.y};
  pin.g_dot = {g_dot.x, g_dot.y};
  pin.gamma = {gamma.x, gamma.y};
  return pin;
}

ConnectorRow ComputeConnectorRow(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                                 const Rotation& rotation2, const Body& body2, double length) {
  RequireValid(Vertex{vertex1});
  RequireValid(Vertex{vertex2});
  if (!(length > 0 && std::isfinite(length))) {
    throw InputError("the length of a rod or rope must be finite and > 0, found " + NumberText(length));
  }
  ConnectorRow connector;
  ClosestPoints& points = connector.points;
  points.R1 = Rotate(rotation1, vertex1);
  points.R2 = Rotate(rotation2, vertex2);
  const Vec2 between = (body1.x - body2.x) + (points.R1 - points.R2);
  points.d = Norm(between);
  if (!(points.d > kSingularD * length)) {
    throw InputError("zero distance: the two attachment points coincide, a rod or rope has no direction; point 1: " +
                     Describe(Vertex{vertex1}) + "; point 2: " + Describe(Vertex{vertex2}));
  }
  points.n = {between.x / points.d, between.y / points.d};
  points.moment1 = Cross(points.R1, points.n);
  points.moment2 = Cross(points.R2, points.n);
  points.curvature1 = {0, 1};
  points.curvature2 = {0, 1};
  connector.row = ComputeContactRow(points, body1, body2);
  return connector;
}

}  // namespace lcpbench
