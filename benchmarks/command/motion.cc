#include <algorithm>
#include <iostream>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/motions/motion_study.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

struct MotionCommand {
  // One at the acceleration level, where b holds curvature and no error is stabilised away within it, and two piles.
  std::vector<std::string> scenes = {"disc-track", "disc-pile", "boxes-and-discs"};
  SceneOptions start{.size = 20};
  std::vector<std::string> solvers;
  MotionStudy study;
  std::string output = "build/results/motion";

  void Declare(CLI::App& app) {
    study.tolerances = {1e-3, 1e-6, 1e-9};
    study.steps = 200;
    app.add_option("--scenes", scenes,
                   "Scene keys or scene files (.json), each with @acceleration or @velocity or its own level")
        ->delimiter(',');
    app.add_option("--solvers", solvers,
                   "Only these solvers, each with @TOLERANCE, @ITERATIONS at which its solves end, or @cold starts")
        ->delimiter(',');
    app.add_option("--tolerances", study.tolerances,
                   "Direct methods, and what iterations end, run at the least one only")
        ->delimiter(',')
        ->check(Tolerance());
    start.AddSizeAndSeed(app);
    app.add_option("--steps", study.steps, "Steps of --dt each")->check(AtLeast(1));
    start.AddStep(app);
    start.AddFriction(app);
    app.add_option("--budget", study.budget_s, "Seconds per motion; longer ones are stopped")->check(PositiveSeconds());
    app.add_option("-o,--output", output, "Folder of motion.csv and motion.json");
    app.footer(
        "Drift: change of energy over the motion. Energy error and distance: largest deviation from the reference, "
        "the\nsame motion driven by auto at 1e-12. Energies over its largest kinetic energy, or what its loads "
        "give in one step.\nTouching bodies are chaotic: a distance grows with time whatever its cause. With friction: "
        "the gap in which a contact bears "
        "force, how far\ncontacts creep although friction could hold them, the energy that friction creates. "
        "us/step: time inside the\nsolver (set-up too; with peers also the way to their process).");
  }

  int Run() {
    for (const std::string& text : scenes) {
      const std::size_t at = text.rfind('@');
      start.scene = text.substr(0, at);
      start.level = at == std::string::npos ? "" : text.substr(at + 1);
      study.scenes.push_back(start.Load());
    }
    if (solvers.empty()) {
      const bool is_plain =
          std::ranges::none_of(study.scenes, [](const MovingScene& scene) { return HasFriction(scene.world); });
      for (const SolverEntry& entry : AllSolvers()) {
        if (entry.available && (entry.takes_plain || !is_plain)) solvers.push_back(entry.key);
      }
    }
    for (const std::string& driver : solvers) study.drivers.push_back(ParseMotionDriver(driver));
    study.size = start.size;
    study.seed = start.seed;
    const Interruption interruption;
    std::cout << FormatMotionTable(RunMotionStudy(study, output)) << std::flush;
    return Interruption::Requested() ? Interruption::ExitStatus() : 0;
  }
};

}  // namespace

void AddMotionCommand(CLI::App& app, CommandRun& run) {
  AddCommand<MotionCommand>(app, run, "motion",
                            "Lets every solver drive the same scenes: what its error does to motion");
}

}  // namespace lcpbench
