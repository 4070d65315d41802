#include "benchmarks/scene_source.h"

#include <algorithm>
#include <utility>

#include "model/motion/contact_finder.h"
#include "model/scene_file/scene_file.h"
#include "model/scenes/picture_layout.h"
#include "model/scenes/scene.h"

namespace lcpbench {
namespace {

bool IsPath(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".json"); }

SceneSource LoadSceneFile(const std::string& path) {
  SceneFile file = ReadSceneFile(path);
  SceneSource source;
  source.world = std::move(file.world);
  source.level = file.level.value_or(source.level);
  source.step = file.step.value_or(source.step);
  source.restitution = file.restitution.value_or(source.restitution);
  return source;
}

}  // namespace

SceneSource LoadScene(const std::string& name_or_file, int size, std::uint64_t seed) {
  if (IsPath(name_or_file)) return LoadSceneFile(name_or_file);
  const SceneFamily& family = FindScene(name_or_file);
  SceneSource source;
  source.world = StartScene(name_or_file, size, seed);
  source.problem = GenerateScene(name_or_file, size, seed);
  source.level = family.level;
  source.step = family.step;
  return source;
}

ContactSystem InstantWithContacts(const World& world) {
  std::vector<Bounds> bounds;
  bounds.reserve(world.bodies.size());
  for (const Body& body : world.bodies) bounds.push_back(BoundsOf(body));
  const double median = MedianExtent(world.bodies, bounds);
  const double size = median > 0 ? median : 1;
  return InstantOf(world, ContactFinder(world).Find(world.bodies, kFoundGap * size, kFoundDepth * size));
}

std::unique_ptr<Motion> StartMotion(const SceneSource& source, LcpSolver& solver) {
  MotionOptions options;
  options.velocity.step = source.step;
  options.velocity.restitution = source.restitution;
  return MakeMotion(source.level, source.world, options, solver);
}

}  // namespace lcpbench
