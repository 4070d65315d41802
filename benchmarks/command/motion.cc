#include <iostream>
#include <memory>

#include "benchmarks/command/commands.h"
#include "benchmarks/measure/interrupt.h"
#include "benchmarks/motions/motion_study.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct MotionArguments {
  // One at the acceleration level, where b holds curvature and no error is stabilised away within it, and two piles.
  std::vector<std::string> scenes = {"disc-track", "disc-pile", "boxes-and-discs"};
  std::vector<std::string> solvers;
  std::vector<double> tolerances = {1e-3, 1e-6, 1e-9};
  int size = 20;
  std::uint64_t seed = 1;
  int steps = 200;
  double dt = 0;  // the scene's own
  double budget_s = 10;
  std::string output = "build/results/motion";
};

// NAME or NAME@LEVEL
MovingScene SceneOf(const std::string& text, const MotionArguments& arguments) {
  const std::size_t at = text.rfind('@');
  MovingScene scene = LoadScene(text.substr(0, at), arguments.size, arguments.seed);
  if (at != std::string::npos) scene.level = MotionLevelFromString(text.substr(at + 1));
  if (arguments.dt > 0) scene.step = arguments.dt;
  return scene;
}

int Run(const MotionArguments& arguments) {
  if (!(arguments.dt >= 0)) throw InputError("--dt: expected seconds > 0");
  MotionStudy study;
  for (const std::string& scene : arguments.scenes) study.scenes.push_back(SceneOf(scene, arguments));
  study.solvers = arguments.solvers;
  if (study.solvers.empty()) {
    for (const SolverEntry& entry : AllSolvers()) {
      if (entry.available) study.solvers.emplace_back(entry.key);
    }
  }
  study.tolerances = arguments.tolerances;
  study.size = arguments.size;
  study.seed = arguments.seed;
  study.steps = arguments.steps;
  study.budget_s = arguments.budget_s;
  const Interruption interruption;
  std::cout << FormatMotionTable(RunMotionStudy(study, arguments.output)) << std::flush;
  return Interruption::Requested() ? Interruption::ExitStatus() : 0;
}

}  // namespace

void AddMotionCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App* motion =
      app.add_subcommand("motion", "Lets every solver drive the same scenes: what its error does to motion");
  motion
      ->add_option("--scenes", arguments->scenes,
                   "Scene keys or scene files (.json), each with @acceleration or @velocity or its own level")
      ->delimiter(',');
  motion->add_option("--solvers", arguments->solvers, "Only these solvers")->delimiter(',');
  motion->add_option("--tolerances", arguments->tolerances, "Direct methods run at the least one only")->delimiter(',');
  motion->add_option("--size", arguments->size, "Number of rows n at the start");
  motion->add_option("--seed", arguments->seed, "Of the scenes");
  motion->add_option("--steps", arguments->steps, "Steps of --dt each");
  motion->add_option("--dt", arguments->dt, "Seconds per step [default: each scene's own]");
  motion->add_option("--budget", arguments->budget_s, "Seconds per motion; longer ones are stopped");
  motion->add_option("-o,--output", arguments->output, "Folder of motion.csv");
  motion->footer(
      "Drift: change of energy over the motion. Energy error and distance: largest deviation from the reference, the\n"
      "same motion driven by dantzig at 1e-12. Energies over its largest kinetic energy. Touching bodies are chaotic:\n"
      "a distance grows with time whatever its cause. us/step: time inside the solver (set-up too; with peers also the "
      "way to their process).");
  motion->callback([arguments, &run] { run = [arguments] { return Run(*arguments); }; });
}

}  // namespace lcpbench
