#include "benchmarks/moving_scene.h"

#include <utility>

#include "model/scene_file/scene_file.h"
#include "model/scenes/scene.h"

namespace lcpbench {

MovingScene StartMovingScene(const std::string& name, int size, std::uint64_t seed) {
  if (name.ends_with(".json") || name.find('/') != std::string::npos) {
    SceneFile file = ReadSceneFile(name);
    MovingScene scene;
    scene.name = file.world.name;
    scene.world = std::move(file.world);
    scene.level = file.level.value_or(scene.level);
    scene.step = file.step.value_or(scene.step);
    scene.restitution = file.restitution.value_or(0);
    return scene;
  }
  const SceneFamily& family = FindScene(name);
  return {name, StartScene(name, size, seed), family.level, family.step, 0};
}

std::unique_ptr<Motion> MakeMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver) {
  MotionOptions options;
  options.velocity.step = scene.step;
  options.velocity.lcp = lcp;
  options.velocity.restitution = scene.restitution;
  options.acceleration.lcp_tolerance = lcp.tolerance;
  options.acceleration.impact.restitution = scene.restitution;
  return MakeMotion(scene.level, scene.world, options, solver);
}

}  // namespace lcpbench
