#pragma once

#include "model/contact/body.h"
#include "model/contact/loads.h"
#include "tests/support/test.h"

namespace lcpbench {

/// Sum of m v over movable bodies [kg m/s].
inline Vec2 Momentum(std::span<const Body> bodies) {
  Vec2 momentum;
  for (const Body& body : bodies) momentum = momentum + (body.fixed ? 0 : body.mass) * body.v;
  return momentum;
}

/// Sum of m x cross v + I omega over movable bodies, about the origin [kg m^2/s].
inline double AngularMomentum(std::span<const Body> bodies) {
  double momentum = 0;
  for (const Body& body : bodies) {
    if (!body.fixed) momentum += body.mass * Cross(body.x, body.v) + body.inertia * body.omega;
  }
  return momentum;
}

/// The work per time that all dampers do [W], <= 0.
inline double DampingPower(const Loads& loads, std::span<const Body> bodies) {
  double power = 0;
  for (const Damper& damper : loads.dampers) {
    Vec2 between;
    Vec2 approach;
    for (const auto& [end, sign] : {std::pair(damper.end1, -1.0), std::pair(damper.end2, 1.0)}) {
      const Body& body = bodies[static_cast<std::size_t>(end.body)];
      const Vec2 arm = Rotate(SinCos(body.theta), end.point);
      between = between + sign * (body.x + arm);
      approach = approach + sign * (body.v + body.omega * Perp(arm));
    }
    const double rate = Dot(approach, between) / Norm(between);
    power -= damper.coefficient * rate * rate;
  }
  return power;
}

}  // namespace lcpbench
