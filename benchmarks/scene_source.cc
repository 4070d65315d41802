#include "benchmarks/scene_source.h"

#include <algorithm>
#include <filesystem>

#include "model/motion/contact_finder.h"
#include "model/scenes/picture_layout.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

bool IsPath(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".json"); }

SceneSource LoadSceneFile(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw InputError(path + ": no such file");
  throw InputError(path + ": this build reads no scene files");
}

}  // namespace

SceneSource LoadScene(const std::string& name_or_file, int size, std::uint64_t seed) {
  if (IsPath(name_or_file)) return LoadSceneFile(name_or_file);
  const SceneFamily& family = FindScene(name_or_file);
  return {StartScene(name_or_file, size, seed), GenerateScene(name_or_file, size, seed), family.level, family.step};
}

ContactSystem InstantWithContacts(const World& world) {
  std::vector<Bounds> bounds;
  bounds.reserve(world.bodies.size());
  for (const Body& body : world.bodies) bounds.push_back(BoundsOf(body));
  const double median = MedianExtent(world.bodies, bounds);
  const double size = median > 0 ? median : 1;
  return InstantOf(world, ContactFinder(world).Find(world.bodies, kFoundGap * size, kFoundDepth * size));
}

}  // namespace lcpbench
