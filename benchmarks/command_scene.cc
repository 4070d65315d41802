#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "benchmarks/animation_page.h"
#include "benchmarks/commands.h"
#include "benchmarks/picture_solution.h"
#include "benchmarks/progress.h"
#include "benchmarks/scene_source.h"
#include "model/assembly.h"
#include "model/scenes/picture.h"
#include "model/scenes/svg_text.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

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

SceneSource Load(const SceneArguments& arguments) {
  SceneSource source = LoadScene(arguments.scene, arguments.size, arguments.seed);
  if (!arguments.level.empty()) source.level = MotionLevelFromString(arguments.level);
  return source;
}

/// The scene as its family gives it, or after moving on by --time.
ContactSystem SystemAt(const SceneArguments& arguments, const SceneSource& source, World* world) {
  if (!(arguments.time > 0)) return source.problem ? *source.problem : InstantWithContacts(source.world);
  const auto solver = MakeSolver(arguments.solver.empty() ? DefaultSolver() : arguments.solver);
  const auto motion = StartMotion(source, *solver);
  motion->Advance(arguments.time);
  if (motion->status() != MotionStatus::kMoving) {
    throw InputError("scene '" + source.world.name + "' stopped at " + Short(motion->time()) +
                     " s: " + motion->detail());
  }
  *world = motion->world();
  return InstantWithContacts(*world);
}

int DrawScene(const SceneArguments& arguments) {
  if (arguments.output != "-" && !arguments.output.ends_with(".svg")) {
    throw InputError("--output: expected a file that ends in .svg, found '" + arguments.output + "'");
  }
  if (!(arguments.time >= 0 && std::isfinite(arguments.time))) throw InputError("--time: expected seconds >= 0");
  const SceneSource source = Load(arguments);
  World world = source.world;
  const ContactSystem system = SystemAt(arguments, source, &world);
  const AssembledLcp lcp = AssembleContactLcp(system);
  const PictureSolution solution = SolveForPicture(lcp.problem, arguments.solver);

  PictureExtras extras;
  extras.loads = &world.loads;
  extras.caption = solution.caption;
  if (arguments.time > 0) extras.caption = "t = " + Short(arguments.time) + " s, " + extras.caption;
  Write(arguments.output,
        RenderSvg(system, lcp, solution.found ? &solution.f : nullptr, solution.found ? &solution.w : nullptr, extras));
  return 0;
}

/// Exit status 1 where the motion stopped before its time; the page shows it up to there.
int AnimateScene(const SceneArguments& arguments) {
  if (!arguments.animate.ends_with(".html")) {
    throw InputError("--animate: expected a file that ends in .html, found '" + arguments.animate + "'");
  }
  RequireValid(arguments.animation);
  const SceneSource source = Load(arguments);
  const std::string key = arguments.solver.empty() ? DefaultSolver() : arguments.solver;
  const auto solver = MakeSolver(key);
  const auto motion = StartMotion(source, *solver);
  Animation animation;
  {
    ProgressBar progress("animate", 1);
    double done = 0;
    animation = RecordAnimation(motion.get(), arguments.animation, [&](double share) {
      progress.Advance(share - done, Short(motion->time()) + " s");
      done = share;
    });
  }
  animation.caption = key + ", " + std::string(ToString(source.level)) + " level";
  Write(arguments.animate, RenderAnimationPage(animation));
  if (animation.stopped.empty()) return 0;
  std::cerr << "lcpbench: the motion stopped at " << Short(motion->time()) << " s: " << animation.stopped << std::endl;
  return 1;
}

int RunScene(const SceneArguments& arguments) {
  return arguments.animate.empty() ? DrawScene(arguments) : AnimateScene(arguments);
}

}  // namespace

void AddSceneCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<SceneArguments>();
  CLI::App* scene = app.add_subcommand("scene", "Draws a scene, its contacts and their forces, or its motion");
  scene->add_option("SCENE", arguments->scene, "Scene key (lcpbench list scenes) or scene file")->required();
  scene->add_option("--size", arguments->size, "Number of rows n, of a scene family")->capture_default_str();
  scene->add_option("--seed", arguments->seed, "The same seed gives the same scene")->capture_default_str();
  scene->add_option("--solver", arguments->solver, "Solver key; default: the first whose answer is verified");
  scene->add_option("--level", arguments->level, "acceleration or velocity; default: what suits the scene");
  scene->add_option("--time", arguments->time, "Draw the scene after this time in motion [s]")->capture_default_str();
  scene->add_option("-o,--output", arguments->output, "SVG file, or - for standard output")->capture_default_str();
  CLI::Option* animate =
      scene->add_option("--animate", arguments->animate, "HTML page of the motion, instead of a picture");
  scene->add_option("--duration", arguments->animation.duration, "Of the motion [s]")
      ->needs(animate)
      ->capture_default_str();
  scene->add_option("--fps", arguments->animation.fps, "Frames per second of its time")
      ->needs(animate)
      ->capture_default_str();
  scene->callback([arguments, &run] { run = [arguments] { return RunScene(*arguments); }; });
}

}  // namespace lcpbench
