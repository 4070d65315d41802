#include "benchmarks/motions/scene_source.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "benchmarks/drawing/drawn_scene.h"
#include "model/contact/contact_row.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/scene.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

bool IsPath(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".json"); }

// Hands steps in which no contact has friction to `auto`.
class FrictionDriver : public LcpSolver {
 public:
  explicit FrictionDriver(std::unique_ptr<LcpSolver> solver) : solver_(std::move(solver)) {}
  std::string WhyUnsupported(const LcpProblem& problem) const override { return Of(problem).WhyRefused(problem); }
  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem& problem) override { Of(problem).Prepare(problem); }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    Of(problem).Solve(problem, options, result);
  }

 private:
  LcpSolver& Of(const LcpProblem& problem) const { return problem.is_plain() ? *plain_ : *solver_; }

  const std::unique_ptr<LcpSolver> solver_, plain_ = MakeSolver(kDrivingSolver);
};

}  // namespace

MovingScene LoadScene(const std::string& name_or_file, int size, std::uint64_t seed) {
  if (!IsPath(name_or_file)) {
    const SceneFamily& family = FindScene(name_or_file);
    return {name_or_file, StartScene(name_or_file, size, seed), family.level, family.step, family.restitution};
  }
  return ToMovingScene(ReadSceneFile(name_or_file));
}

MovingScene ToMovingScene(SceneFile file) {
  MovingScene scene;
  scene.name = file.world.name;
  scene.world = std::move(file.world);
  scene.level = file.level.value_or(scene.level);
  scene.step = file.step.value_or(scene.step);
  scene.restitution = file.restitution.value_or(scene.restitution);
  scene.impact_law = file.impact_law;
  scene.resting_speed = file.resting_speed;
  return scene;
}

void SetFriction(double mu, MovingScene* scene) {
  for (Body& body : scene->world.bodies) body.friction = mu;
  scene->world.friction.clear();
}

void SetFriction(double mu, ContactSystem* system) {
  for (Constraint& constraint : system->constraints) constraint.friction = mu;
}

ContactSystem LoadInstant(const std::string& name_or_file, int size, std::uint64_t seed,
                          std::optional<MotionLevel> level) {
  if (!IsPath(name_or_file)) return GenerateScene(name_or_file, size, seed);
  const MovingScene scene = LoadScene(name_or_file, size, seed);
  return InstantWithContacts(scene.world, level.value_or(scene.level), kFoundGap);
}

ContactSystem InstantWithContacts(const World& world, MotionLevel level, double found_gap) {
  const double median = MedianExtent(world.bodies, BoundsOf(world.bodies));
  const double size = median > 0 ? median : 1;
  const ContactFinder finder(world);
  const double width = finder.least_width() > 0 ? finder.least_width() : 1;
  const double treated = TreatedDepth(level, width);
  finder.RequireShallow(world, ToString(level), treated);
  ContactSystem instant = InstantOf(world, finder.Find(world.bodies, found_gap * size, treated));
  const AssembledLcp lcp = AssembleContactLcp(instant);
  instant = InstantOf(world, WithoutGhosts(instant, lcp.rows, VelocityOptions().doubtful_depth * width));
  std::erase_if(instant.constraints, [&](const Constraint& joint) {
    return joint.type == ConstraintType::kRope && joint.length - DistanceOfEnds(joint, world.bodies) > found_gap * size;
  });
  return instant;
}

std::unique_ptr<LcpSolver> MakeMotionSolver(const MovingScene& scene, const std::string& key,
                                            const Settings& settings) {
  if (FindSolver(key).takes_plain) return MakeSolver(key, settings);
  if (!HasFriction(scene.world)) {
    throw InputError("solver '" + key + "' is made for friction: scene '" + scene.name + "' has none");
  }
  return std::make_unique<FrictionDriver>(MakeSolver(key, settings));
}

std::unique_ptr<Motion> StartMotion(const MovingScene& scene, const LcpOptions& lcp, LcpSolver& solver,
                                    bool warm_start) {
  MotionOptions options;
  options.velocity.warm_start = warm_start;
  options.velocity.step = scene.step;
  options.velocity.lcp = lcp;
  ImpactOptions& impact = options.acceleration.impact;
  options.velocity.restitution = impact.restitution = scene.restitution;
  options.velocity.impact_law = impact.law = scene.impact_law.value_or(ImpactLaw::kNewton);
  if (scene.resting_speed) options.velocity.resting_speed = impact.resting_speed = *scene.resting_speed;
  // Where nothing bounces, a body that is stopped by one contact leaves others slowly and falls back onto them a few
  // microseconds later, which leaves others again: one collision of a chain becomes a cascade of tiny impacts. Contacts
  // that are slower than what counts as rest anyway need no impact.
  double& at_rest = impact.velocity_tolerance;
  if (scene.restitution == 0) {
    at_rest = ImpactOptions().resting_speed;
  } else if (impact.resting_speed > 0) {
    at_rest = std::min(at_rest, impact.resting_speed);
  }
  options.acceleration.lcp = lcp;
  return MakeMotion(scene.level, scene.world, options, solver);
}

std::string FormatMovingScene(const MovingScene& scene) {
  return FormatScene({scene.world, scene.level, scene.step, scene.restitution, scene.impact_law, scene.resting_speed});
}

}  // namespace lcpbench
