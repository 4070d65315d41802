#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "benchmarks/command/commands.h"
#include "benchmarks/drawing/animation.h"
#include "benchmarks/drawing/picture.h"
#include "benchmarks/drawing/svg.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/motions/scene_source.h"
#include "model/contact/assembly.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct SceneArguments {
  std::string scene;
  int size = 24;
  std::uint64_t seed = 1;
  std::string solver;
  std::string level;
  double time = 0;
  std::string output = "-";
  std::string animate;
  AnimationOptions animation;
};

void Write(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::cout << text << std::flush;
    return;
  }
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw InputError(path + ": cannot be written");
}

/// The key of the solver that moves a scene where none is named.
std::string DefaultSolver() {
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available) return std::string(entry.key);
  }
  throw InputError("this build has no solver");
}

MovingScene Load(const SceneArguments& arguments) {
  MovingScene scene = LoadScene(arguments.scene, arguments.size, arguments.seed);
  if (!arguments.level.empty()) scene.level = MotionLevelFromString(arguments.level);
  return scene;
}

std::string SolverKey(const SceneArguments& arguments) {
  return arguments.solver.empty() ? DefaultSolver() : arguments.solver;
}

/// Moves the scene on by --time.
void MoveOn(const SceneArguments& arguments, MovingScene* scene) {
  if (!(arguments.time >= 0 && std::isfinite(arguments.time))) throw InputError("--time: expected seconds >= 0");
  if (arguments.time == 0) return;
  const auto solver = MakeSolver(SolverKey(arguments));
  const auto motion = StartMotion(*scene, {}, *solver);
  motion->Advance(arguments.time);
  if (motion->status() != MotionStatus::kMoving) {
    throw InputError("scene '" + scene->world.name + "' stopped at " + Short(motion->time()) +
                     " s: " + motion->detail());
  }
  scene->world = motion->world();
}

int WriteSceneFile(const SceneArguments& arguments) {
  MovingScene scene = Load(arguments);
  MoveOn(arguments, &scene);
  Write(arguments.output, FormatMovingScene(scene));
  return 0;
}

int DrawScene(const SceneArguments& arguments) {
  if (arguments.output != "-" && !arguments.output.ends_with(".svg")) {
    throw InputError("--output: expected a file that ends in .svg or .json, found '" + arguments.output + "'");
  }
  MovingScene scene = Load(arguments);
  MoveOn(arguments, &scene);
  const ContactSystem system = arguments.time > 0 ? InstantWithContacts(scene.world)
                                                  : LoadInstant(arguments.scene, arguments.size, arguments.seed);
  const AssembledLcp lcp = AssembleContactLcp(system);
  const std::optional<PictureSolution> solution = SolveForPicture(lcp.problem, arguments.solver);

  PictureExtras extras;
  extras.loads = &scene.world.loads;
  if (solution) extras.caption = solution->caption;
  if (arguments.time > 0) extras.caption = "t = " + Short(arguments.time) + " s, " + extras.caption;
  Write(arguments.output,
        RenderSvg(system, lcp, solution ? &solution->f : nullptr, solution ? &solution->w : nullptr, extras));
  return 0;
}

/// Exit status 1 where the motion stopped before its time; the page shows it up to there.
int AnimateScene(const SceneArguments& arguments) {
  if (!arguments.animate.ends_with(".html")) {
    throw InputError("--animate: expected a file that ends in .html, found '" + arguments.animate + "'");
  }
  RequireValid(arguments.animation);
  const MovingScene scene = Load(arguments);
  const std::string key = SolverKey(arguments);
  const auto solver = MakeSolver(key);
  const auto motion = StartMotion(scene, {}, *solver);
  Animation animation;
  {
    ProgressBar progress("animate", 1);
    double done = 0;
    animation = RecordAnimation(motion.get(), arguments.animation, [&](double share) {
      progress.Advance(share - done, Short(motion->time()) + " s");
      done = share;
    });
  }
  animation.caption = key + ", " + std::string(ToString(scene.level)) + " level";
  Write(arguments.animate, RenderAnimationPage(animation));
  if (animation.stopped.empty()) return 0;
  std::cerr << "lcpbench: the motion stopped at " << Short(motion->time()) << " s: " << animation.stopped << std::endl;
  return 1;
}

int RunScene(const SceneArguments& arguments) {
  if (!arguments.animate.empty()) return AnimateScene(arguments);
  return arguments.output.ends_with(".json") ? WriteSceneFile(arguments) : DrawScene(arguments);
}

}  // namespace

void AddSceneCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<SceneArguments>();
  CLI::App* scene = app.add_subcommand("scene", "Draws a scene, its contacts and their forces, or its motion");
  scene->add_option("SCENE", arguments->scene, "Scene key (lcpbench list scenes) or scene file")->required();
  scene->add_option("--size", arguments->size, "Number of rows n, of a scene family");
  scene->add_option("--seed", arguments->seed, "The same seed gives the same scene");
  scene->add_option("--solver", arguments->solver, "Solver key; default: the first whose answer is verified");
  scene->add_option("--level", arguments->level, "acceleration or velocity; default: what suits the scene");
  scene->add_option("--time", arguments->time, "Draw or write the scene after this time in motion [s]");
  scene->add_option("-o,--output", arguments->output,
                    "SVG picture (- for standard output), or scene file (.json) of what moves");
  CLI::Option* animate =
      scene->add_option("--animate", arguments->animate, "HTML page of the motion, instead of a picture");
  scene->add_option("--duration", arguments->animation.duration, "Of the motion [s]")->needs(animate);
  scene->add_option("--fps", arguments->animation.fps, "Frames per second of its time")->needs(animate);
  scene->callback([arguments, &run] { run = [arguments] { return RunScene(*arguments); }; });
}

}  // namespace lcpbench
