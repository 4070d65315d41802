#include <cmath>
#include <iostream>
#include <optional>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/drawing/animation.h"
#include "benchmarks/drawing/picture.h"
#include "benchmarks/drawing/svg.h"
#include "benchmarks/measure/budget_clock.h"
#include "benchmarks/measure/progress.h"
#include "model/contact/assembly.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/printable.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

struct SceneCommand {
  SceneOptions start{.size = 24};
  std::string solver;
  double time = 0;
  std::string output = "-";
  std::string animate;
  AnimationOptions animation;

  void Declare(CLI::App& app) {
    app.add_option("SCENE", start.scene, "Scene key (lcpbench list scenes) or scene file")->required();
    start.AddSizeAndSeed(app);
    start.AddStep(app);
    start.AddFriction(app);
    app.add_option("--solver", solver, "Solver key; default: the first whose answer is verified");
    start.AddLevel(app);
    start.AddBudget(app);
    app.add_option("--time", time, "Draw or write the scene after this time in motion [s]")
        ->check(Expect("seconds >= 0", [](double value) { return value >= 0 && std::isfinite(value); }));
    app.add_option("-o,--output", output, "SVG picture (- for standard output), or scene file (.json) of what moves");
    CLI::Option* page = app.add_option("--animate", animate, "HTML page of the motion, instead of a picture");
    app.add_option("--duration", animation.duration, "Of the motion [s]")->needs(page);
    app.add_option("--fps", animation.fps, "Frames per second of its time")->needs(page);
  }

  int Run() {
    if (!animate.empty()) return Animate();
    if (!output.ends_with(".json")) return Draw();
    WriteTextFile(output, FormatMovingScene(LoadAndMove()));
    return 0;
  }

 private:
  // What moves the scene, as it moves sequences.
  std::string MovingSolver() const { return solver.empty() ? "auto" : solver; }

  LcpOptions SolverLimits() const {
    LcpOptions options;
    options.time_limit_s = start.budget_s;
    return options;
  }

  // The scene after --time.
  MovingScene LoadAndMove() const {
    MovingScene scene = start.Load();
    if (time == 0) return scene;
    const auto moving = MakeMotionSolver(scene, MovingSolver());
    const auto motion = StartMotion(scene, SolverLimits(), *moving);
    const BudgetClock budget(start.budget_s);
    motion->set_check([&budget] { budget.Check(); });
    try {
      motion->Advance(time);
    } catch (const BudgetSpent&) {
      throw InputError("scene '" + scene.world.name + "': " + budget.Reason());
    }
    if (motion->status() != MotionStatus::kMoving) {
      throw InputError("scene '" + scene.world.name + "' stopped at " + Short(motion->time()) +
                       " s: " + motion->detail());
    }
    scene.world = motion->world();
    return scene;
  }

  static std::pair<ContactSystem, AssembledLcp> ProblemOf(ContactSystem system, double step) {
    AssembledLcp lcp = AssembleInstant(system, step);
    return {std::move(system), std::move(lcp)};
  }

  int Draw() const {
    if (output != "-" && !output.ends_with(".svg")) {
      throw InputError("--output: expected a file that ends in .svg or .json, found '" + output + "'");
    }
    const MovingScene scene = LoadAndMove();
    // Time steps leave gaps that nobody sees.
    const double touching = scene.level == MotionLevel::kVelocity ? 1e-3 : kFoundGap;
    const auto [system, lcp] =
        time > 0 ? ProblemOf(InstantWithContacts(scene.world, scene.level, touching), scene.step) : start.LoadProblem();
    std::optional<PictureSolution> solution = SolveForPicture(lcp.problem, solver, start.budget_s);
    if (solution && !lcp.problem.is_plain()) {
      // Impulses and velocities of a time step, as forces and accelerations.
      solution->f /= scene.step;
      solution->w /= scene.step;
    }
    PictureExtras extras;
    extras.loads = &scene.world.loads;
    if (solution) extras.caption = solution->caption;
    if (time > 0) extras.caption = "t = " + Short(time) + " s" + (solution ? ", " : "") + extras.caption;
    WriteTextFile(output,
                  RenderSvg(system, lcp, solution ? &solution->f : nullptr, solution ? &solution->w : nullptr, extras));
    return 0;
  }

  // Exit status 1 where the motion stopped before its time; the page shows it up to there.
  int Animate() {
    if (!animate.ends_with(".html")) {
      throw InputError("--animate: expected a file that ends in .html, found '" + animate + "'");
    }
    RequireValid(animation);
    animation.budget_s = start.budget_s;
    const MovingScene scene = start.Load();
    const std::string key = MovingSolver();
    const auto moving = MakeMotionSolver(scene, key);
    const auto motion = StartMotion(scene, SolverLimits(), *moving);
    Animation recorded;
    {
      ProgressBar progress("animate", 1);
      double done = 0;
      recorded = RecordAnimation(motion.get(), animation, [&](double share) {
        progress.Advance(share - done, Short(motion->time()) + " s");
        done = share;
      });
    }
    recorded.caption = key + ", " + std::string(ToString(scene.level)) + " level";
    WriteTextFile(animate, RenderAnimationPage(recorded));
    if (recorded.stopped.empty()) return 0;
    std::cerr << "lcpbench: the motion stopped at " << Short(motion->time()) << " s: " << Printable(recorded.stopped)
              << std::endl;
    return 1;
  }
};

}  // namespace

void AddSceneCommand(CLI::App& app, CommandRun& run) {
  AddCommand<SceneCommand>(app, run, "scene", "Draws a scene, its contacts and their forces, or its motion");
}

}  // namespace lcpbench
