#include "model/scenes/scene_builder.h"

#include <cmath>
#include <utility>

namespace lcpbench {

World WorldUnderGravity(ContactSystem system, Vec2 gravity) {
  ClearLoads(system.bodies);
  World world = WorldOf(system);
  world.loads.gravity = gravity;
  return world;
}

void Stir(World* world, double speed, std::uint64_t seed) {
  constexpr std::uint64_t kOther = 0x5EED;  // other numbers than those that the geometry was drawn from
  Random random(seed ^ kOther);
  for (Body& body : world->bodies) {
    if (body.fixed) continue;
    const Vec2 v = random.InUnitDisc();
    const double spin = random.Uniform(-1, 1);
    body.v = body.v + speed * v;
    body.omega += speed * spin / std::sqrt(body.inertia / body.mass);
  }
}

void SceneBuilder::Apply(const LoadLevel& level) {
  for (Body& body : system_.bodies) {
    if (body.fixed) continue;
    const Vec2 gust = random_.InUnitDisc();
    const double twist = random_.Uniform(-1, 1);
    body.force = body.mass * (level.gust * gust + Vec2{0, -level.weight});
    body.torque = body.mass * level.gust * std::sqrt(body.inertia / body.mass) * twist;
  }
}

ContactSystem SceneFamily::generate(int rows, std::uint64_t seed) const {
  const std::unique_ptr<SceneBuilder> scene = make(key, rows, seed);
  scene->Build();
  scene->Load();
  return std::move(scene->system());
}

World SceneFamily::start(int rows, std::uint64_t seed) const {
  const std::unique_ptr<SceneBuilder> scene = make(key, rows, seed);
  scene->BuildMoving();
  World world = WorldUnderGravity(std::move(scene->system()), {0, -kGravity});
  scene->Launch(&world);
  return world;
}

}  // namespace lcpbench
