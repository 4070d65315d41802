#include "model/contact/loads.h"

#include "model/geometry/trig.h"

namespace lcpbench {

void SetLoads(const Loads& loads, std::span<Body> bodies) {
  ClearLoads(bodies);
  ApplyGravity(loads.gravity, bodies);
  for (const Spring& spring : loads.springs) ApplySpring(spring, bodies);
  for (const Damper& damper : loads.dampers) ApplyDamper(damper, bodies);
  for (const Thruster& thruster : loads.thrusters) ApplyThruster(thruster, bodies);
  for (const Wrench& wrench : loads.wrenches) ApplyWrench(wrench, bodies);
  if (loads.attraction) ApplyMutualAttraction(*loads.attraction, bodies);
}

double PotentialEnergy(const Loads& loads, std::span<const Body> bodies) {
  double energy = GravityEnergy(loads.gravity, bodies);
  for (const Spring& spring : loads.springs) energy += SpringEnergy(spring, bodies);
  for (const Wrench& wrench : loads.wrenches) {
    const Body& body = bodies[static_cast<std::size_t>(wrench.at.body)];
    if (body.fixed) continue;
    const Vec2 p = body.x + Rotate(SinCos(body.theta), wrench.at.point);
    energy -= Dot(wrench.force, p) + wrench.torque * body.theta;
  }
  if (loads.attraction) energy += MutualAttractionEnergy(*loads.attraction, bodies);
  return energy;
}

double DampingPower(const Loads& loads, std::span<const Body> bodies) {
  double power = 0;
  for (const Damper& damper : loads.dampers) power += DamperPower(damper, bodies);
  return power;
}

double KineticEnergy(std::span<const Body> bodies) {
  double twice = 0;
  for (const Body& body : bodies) {
    if (!body.fixed) twice += body.mass * Dot(body.v, body.v) + body.inertia * body.omega * body.omega;
  }
  return twice / 2;
}

Vec2 Momentum(std::span<const Body> bodies) {
  Vec2 momentum;
  for (const Body& body : bodies) {
    if (!body.fixed) momentum = momentum + body.mass * body.v;
  }
  return momentum;
}

double AngularMomentum(std::span<const Body> bodies) {
  double momentum = 0;
  for (const Body& body : bodies) {
    if (!body.fixed) momentum += body.mass * Cross(body.x, body.v) + body.inertia * body.omega;
  }
  return momentum;
}

}  // namespace lcpbench
