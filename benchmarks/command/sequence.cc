#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/solver_options.h"
#include "benchmarks/measure/interrupt.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/motions/scene_source.h"
#include "benchmarks/motions/sequence.h"
#include "model/contact/loads.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct SequenceArguments {
  std::string scene;
  int size = 100;
  std::uint64_t seed = 1;
  int steps = 100;
  double dt = 0;  // the scene's own
  std::string level;
  std::string solver = "dantzig";
  double tolerance = 1e-9;
  double time_limit_s = std::numeric_limits<double>::infinity();
  bool with_matrix = false;
  std::string output = "-";
};

MovingScene ChosenScene(const SequenceArguments& arguments) {
  if (!(arguments.tolerance > 0 && arguments.tolerance < 1)) {
    throw InputError("--tolerance: expected a number in (0, 1)");
  }
  if (!(arguments.time_limit_s > 0)) throw InputError("--time-limit: expected seconds > 0");
  if (arguments.steps < 1) throw InputError("--steps: expected a number >= 1");
  if (!(arguments.dt >= 0)) throw InputError("--dt: expected seconds > 0");
  MovingScene scene = LoadScene(arguments.scene, arguments.size, arguments.seed);
  if (!arguments.level.empty()) scene.level = MotionLevelFromString(arguments.level);
  if (arguments.dt > 0) scene.step = arguments.dt;
  return scene;
}

/// Energy of the conservative loads and of motion, and the largest kinetic energy so far.
struct EnergyRecord {
  explicit EnergyRecord(const World& world) : start(Of(world)), end(start), scale(KineticEnergy(world.bodies)) {}
  static double Of(const World& world) {
    return KineticEnergy(world.bodies) + PotentialEnergy(world.loads, world.bodies);
  }
  void Note(const World& world) {
    end = Of(world);
    scale = std::max(scale, KineticEnergy(world.bodies));
  }
  double start;
  double end;
  double scale;
};

void PrintSummary(const SequenceArguments& arguments, const Motion& motion, SequenceCounts counts,
                  const EnergyRecord& energy) {
  std::ostringstream text;
  text << counts.rows.size() << " problems to t = " << motion.time() << " s";
  if (!counts.rows.empty()) {
    std::sort(counts.rows.begin(), counts.rows.end());
    text << "; rows " << counts.rows.front() << " / " << counts.rows[counts.rows.size() / 2] << " / "
         << counts.rows.back() << " (least, median, most)";
  }
  const MotionStatistics& statistics = motion.statistics();
  text << '\n'
       << arguments.solver << " at " << arguments.tolerance << ": of the written, " << counts.failed
       << " not solved by its own word, " << counts.not_passed << " not verified, " << counts.false_successes
       << " false successes; of all " << statistics.solves << " solves " << statistics.failed_solves << " failed, "
       << statistics.unsolvable << " of them without a solution\n"
       << "worst penetration " << statistics.worst_penetration << " m, worst joint error "
       << statistics.worst_joint_error << " m; energy " << energy.start << " J -> " << energy.end << " J";
  if (energy.scale > 0) {
    text << ", " << (energy.end - energy.start) / energy.scale << " of the largest kinetic energy";
  }
  if (motion.status() != MotionStatus::kMoving) text << "\nstopped: " << motion.detail();
  std::cerr << text.str() << std::endl;
}

int WriteSequence(const SequenceArguments& arguments, const Settings& settings) {
  const MovingScene scene = ChosenScene(arguments);
  const std::unique_ptr<LcpSolver> solver = MakeSolver(arguments.solver, settings);
  LcpOptions lcp;
  lcp.tolerance = arguments.tolerance;
  lcp.time_limit_s = arguments.time_limit_s;
  const std::unique_ptr<Motion> motion = StartMotion(scene, lcp, *solver);

  std::ofstream file;
  const bool to_file = arguments.output != "-";
  if (to_file) file.open(arguments.output);
  if (to_file && !file) throw InputError(arguments.output + ": cannot be opened for writing");
  SequenceWriter writer(to_file ? file : std::cout, to_file ? arguments.output : "standard output", arguments.solver,
                        arguments.tolerance, arguments.with_matrix);
  motion->set_observer([&writer](const MotionProblem& met) {
    // One step of many events can take long.
    Interruption::Check();
    writer.Write(met);
  });

  EnergyRecord energy(motion->world());
  std::optional<InputError> failure;
  const Interruption interruption;
  {
    ProgressBar bar("sequence", arguments.steps);
    for (int k = 0; k < arguments.steps && !Interruption::Requested(); ++k) {
      writer.BeginStep(k);
      try {
        motion->Advance(scene.step);
      } catch (const InputError& error) {
        failure = error;
        break;
      } catch (const Interrupted&) {
        break;
      }
      energy.Note(motion->world());
      bar.Advance(1, std::to_string(writer.counts().rows.size()) + " problems");
      if (motion->status() != MotionStatus::kMoving) break;
    }
  }
  PrintSummary(arguments, *motion, writer.counts(), energy);
  if (failure) throw InputError(*failure);
  if (Interruption::Requested()) return Interruption::ExitStatus();
  return motion->status() == MotionStatus::kMoving ? 0 : 1;
}

}  // namespace

void AddSequenceCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<SequenceArguments>();
  CLI::App* sequence =
      app.add_subcommand("sequence", "Lets a scene move and writes the LCPs that it meets as JSON lines");
  sequence->add_option("SCENE", arguments->scene, "Scene key (lcpbench list scenes), or a scene file (.json)")
      ->required();
  sequence->add_option("--size", arguments->size, "Number of rows n at the start");
  sequence->add_option("--seed", arguments->seed, "The same seed gives the same start, bit for bit");
  sequence->add_option("--steps", arguments->steps, "Steps of --dt each");
  sequence->add_option("--dt", arguments->dt, "Seconds per step [default: the scene's own]");
  sequence->add_option("--level", arguments->level, "acceleration or velocity [default: the scene's own]");
  sequence->add_option("--solver", arguments->solver, "Solver key (lcpbench list solvers)");
  sequence->add_option("--tolerance", arguments->tolerance, "Bound on rho, the scaled natural residual");
  sequence->add_option("--time-limit", arguments->time_limit_s, "Seconds per problem");
  const auto settings = AddSettingsOption(*sequence);
  sequence->add_flag("--with-matrix", arguments->with_matrix, "Also write A = J M^-1 J^T");
  sequence->add_option("-o,--output", arguments->output, "File, or - for standard output");
  sequence->footer("Exit status 1 when the motion came to an end early; what was written until then is kept.");
  sequence->callback([arguments, settings, &run] {
    run = [arguments, settings] { return WriteSequence(*arguments, ParseSettings(*settings)); };
  });
}

}  // namespace lcpbench
