#include "benchmarks/moving_scene.h"

#include "model/scenes/scene.h"

namespace lcpbench {

MovingScene StartMovingScene(const std::string& name, int size, std::uint64_t seed) {
  const SceneFamily& family = FindScene(name);
  return {name, StartScene(name, size, seed), family.level, family.step};
}

std::unique_ptr<Motion> MakeMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver) {
  MotionOptions options;
  options.velocity.step = scene.step;
  options.velocity.lcp = lcp;
  return MakeMotion(scene.level, scene.world, options, solver);
}

}  // namespace lcpbench
