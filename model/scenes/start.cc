#include "model/scenes/start.h"

#include <cmath>
#include <utility>

#include "model/scenes/random.h"

namespace lcpbench {

World SetInMotion(ContactSystem system, Loads loads) {
  for (Body& body : system.bodies) {
    body.force = {};
    body.torque = 0;
  }
  World world = WorldOf(system);
  world.loads = std::move(loads);
  return world;
}

World WorldUnderGravity(ContactSystem system, Vec2 gravity) {
  Loads loads;
  loads.gravity = gravity;
  return SetInMotion(std::move(system), std::move(loads));
}

void Stir(World* world, double speed, std::uint64_t seed) {
  // Other numbers than those that the geometry was drawn from.
  constexpr std::uint64_t kOther = 0x5EED;
  Random random(seed ^ kOther);
  for (Body& body : world->bodies) {
    if (body.fixed) continue;
    const Vec2 v = random.InUnitDisc();
    const double spin = random.Uniform(-1, 1);
    body.v = body.v + speed * v;
    body.omega += speed * spin / std::sqrt(body.inertia / body.mass);
  }
}

}  // namespace lcpbench
