#include <algorithm>
#include <iostream>
#include <optional>
#include <sstream>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/budget_clock.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/motions/scene_source.h"
#include "benchmarks/motions/sequence.h"
#include "model/contact/loads.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/printable.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

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

struct Sequence {
  SceneOptions start;
  int steps = 100;
  std::string solver = kDrivingSolver;
  LcpOptions lcp;
  std::vector<std::string> settings;
  SequenceWriter::Contents contents;
  std::string output = "-";

  void Declare(CLI::App& app) {
    app.add_option("SCENE", start.scene, "Scene key (lcpbench list scenes), or a scene file (.json)")->required();
    start.AddSizeAndSeed(app);
    app.add_option("--steps", steps, "Steps of --dt each")->check(AtLeast(1));
    start.AddStep(app);
    start.AddLevel(app);
    start.AddBudget(app);
    app.add_option("--solver", solver, "Solver that drives the motion (lcpbench list solvers)");
    AddToleranceOption(app, &lcp.tolerance);
    AddTimeLimitOption(app, &lcp.time_limit_s);
    AddSettingsOption(app, &settings);
    app.add_flag("--with-matrix", contents.with_matrix, "Also write A = J M^-1 J^T");
    app.add_flag("--forces", contents.with_forces, "Also write f and w of the solver that drives the motion");
    app.add_option("-o,--output", output, "File, or - for standard output");
    app.footer("Exit status 1 when the motion came to an end early; what was written until then is kept.");
  }

  int Run() const {
    const MovingScene scene = start.Load();
    const std::unique_ptr<LcpSolver> made = MakeMotionSolver(scene, solver, ParseSettings(settings));
    LcpOptions limits = lcp;
    limits.time_limit_s = std::min(lcp.time_limit_s, start.budget_s);
    const std::unique_ptr<Motion> motion = StartMotion(scene, limits, *made);
    TextOutput file(output);
    SequenceWriter writer(file.stream(), solver, lcp.tolerance, contents);
    const BudgetClock budget(start.budget_s);
    // One step of many events can take long.
    motion->set_check([&budget] {
      Interruption::Check();
      budget.Check();
    });
    motion->set_observer([&writer](const MotionProblem& met) { writer.Write(met); });

    EnergyRecord energy(motion->world());
    std::optional<InputError> failure;
    std::string stopped;
    const Interruption interruption;
    {
      ProgressBar bar("sequence", steps);
      for (int k = 0; k < steps && !Interruption::Requested(); ++k) {
        writer.BeginStep(k);
        try {
          motion->Advance(scene.step);
        } catch (const InputError& error) {
          failure = error;
          break;
        } catch (const BudgetSpent&) {
          stopped = budget.Reason();
          break;
        } catch (const Interrupted&) {
          break;
        }
        energy.Note(motion->world());
        bar.Advance(1, std::to_string(writer.counts().rows.size()) + " problems");
        if (motion->status() != MotionStatus::kMoving) {
          stopped = motion->detail();
          break;
        }
      }
    }
    file.Close();
    PrintSummary(*motion, writer.counts(), energy, stopped);
    if (failure) throw InputError(*failure);
    if (Interruption::Requested()) return Interruption::ExitStatus();
    return stopped.empty() ? 0 : 1;
  }

 private:
  void PrintSummary(const Motion& motion, SequenceCounts counts, const EnergyRecord& energy,
                    const std::string& stopped) const {
    std::ostringstream text;
    text << counts.rows.size() << " problems to t = " << motion.time() << " s";
    if (!counts.rows.empty()) {
      std::sort(counts.rows.begin(), counts.rows.end());
      text << "; rows " << counts.rows.front() << " / " << counts.rows[counts.rows.size() / 2] << " / "
           << counts.rows.back() << " (least, median, most)";
    }
    const MotionStatistics& statistics = motion.statistics();
    text << '\n'
         << solver << " at " << lcp.tolerance << ": of the written, " << counts.failed
         << " not solved by its own word, " << counts.not_passed << " not verified, " << counts.false_successes
         << " false successes; of all " << statistics.solves << " solves " << statistics.failed_solves << " failed, "
         << statistics.unsolvable << " of them without a solution\n"
         << "worst penetration " << statistics.worst_penetration << " m, worst joint error "
         << statistics.worst_joint_error << " m; energy " << energy.start << " J -> " << energy.end << " J";
    if (energy.scale > 0) {
      text << ", " << (energy.end - energy.start) / energy.scale << " of the largest kinetic energy";
    }
    if (!stopped.empty()) text << "\nstopped: " << Printable(stopped);
    std::cerr << text.str() << std::endl;
  }
};

}  // namespace

void AddSequenceCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Sequence>(app, run, "sequence", "Lets a scene move and writes the LCPs that it meets as JSON lines");
}

}  // namespace lcpbench
