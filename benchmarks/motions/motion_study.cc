#include "benchmarks/motions/motion_study.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "benchmarks/measure/interrupt.h"
#include "benchmarks/measure/progress.h"
#include "model/contact/loads.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/csv.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// About as many points as a plot can show of one motion.
constexpr int kSamples = 100;

struct Instant {
  double energy = 0;
  std::vector<Vec2> places;
};

Instant InstantOf(const World& world) {
  Instant instant;
  instant.energy = KineticEnergy(world.bodies) + PotentialEnergy(world.loads, world.bodies);
  for (const Body& body : world.bodies) instant.places.push_back(body.x);
  return instant;
}

double Distance(const Instant& a, const Instant& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.places.size(); ++i) largest = std::max(largest, Norm(a.places[i] - b.places[i]));
  return largest;
}

/// The reference motion at the multiples of the scene's step.
struct Reference {
  std::vector<Instant> instants;
  double scale = 0;  ///< largest kinetic energy [J]
};

double PositiveOrOne(double scale) { return scale > 0 ? scale : 1; }

/// Thrown out of a motion that has used up its time.
struct BudgetSpent {};

/// What the answers within one interval between samples were like.
class Watch {
 public:
  Watch(double tolerance, double budget_s, MotionOutcome* total)
      : tolerance_(tolerance), end_(SteadyNow() + budget_s), total_(total) {}

  void operator()(const MotionProblem& met) {
    Interruption::Check();
    if (SteadyNow() > end_) throw BudgetSpent();
    for (const RowInfo& row : met.rows) {
      double& worst = row.bilateral ? joint_error : penetration;
      worst = std::fmax(worst, row.bilateral ? std::abs(row.d) : std::fmax(0, -row.d));
    }
    const Verdict verdict = Verify(met.problem, met.result, tolerance_);
    // NaN must not pass for small.
    const double found =
        std::isnan(verdict.metrics.rho) ? std::numeric_limits<double>::infinity() : verdict.metrics.rho;
    rho = std::fmax(rho, found);
    if (!verdict.passes) ++total_->not_passed;
    if (verdict.false_success) ++total_->false_successes;
  }

  void Restart() { penetration = joint_error = rho = kNotMeasured; }

  double penetration = kNotMeasured;
  double joint_error = kNotMeasured;
  double rho = kNotMeasured;

 private:
  double tolerance_;
  double end_;
  MotionOutcome* total_;
};

/// The largest deviations from the reference since the last sample.
struct Deviation {
  double energy = kNotMeasured;
  double distance = kNotMeasured;

  void Note(double of_energy, double of_place) {
    energy = std::fmax(energy, of_energy);
    distance = std::fmax(distance, of_place);
  }
};

const std::vector<std::string> kColumns = {
    "scene",        "level",  "size",         "seed",        "solver",          "tolerance", "step",
    "time",         "energy", "energy_error", "penetration", "joint_error",     "distance",  "rho",
    "solve_time_s", "solves", "failed",       "not_passed",  "false_successes", "stopped"};

class Study {
 public:
  Study(const MotionStudy& study, const std::string& folder, ProgressBar* bar)
      : study_(study), csv_((std::filesystem::path(folder) / "motion.csv").string(), kColumns), bar_(bar) {}

  Reference RunReference(const MovingScene& scene) {
    Reference reference;
    const std::unique_ptr<LcpSolver> solver = MakeSolver(kReferenceSolver);
    const std::unique_ptr<Motion> motion = Start(scene, kReferenceTolerance, solver.get());
    constexpr double kPatience = 3;  // without it nothing can be compared
    const double end = SteadyNow() + kPatience * study_.budget_s;
    motion->set_observer([end](const MotionProblem&) {
      Interruption::Check();
      if (SteadyNow() > end) throw BudgetSpent();
    });
    reference.instants.push_back(InstantOf(motion->world()));
    reference.scale = KineticEnergy(motion->world().bodies);
    for (int k = 0; k < study_.steps && motion->status() == MotionStatus::kMoving; ++k) {
      try {
        Interruption::Check();
        motion->Advance(scene.step);
      } catch (const InputError&) {
        break;  // the solvers' motions are compared with what there is
      } catch (const BudgetSpent&) {
        break;
      } catch (const Interrupted&) {
        break;
      }
      reference.instants.push_back(InstantOf(motion->world()));
      reference.scale = std::max(reference.scale, KineticEnergy(motion->world().bodies));
      bar_->Advance(1, scene.name + ": reference");
    }
    return reference;
  }

  MotionOutcome Run(const MovingScene& scene, const Reference& reference, const std::string& key, double tolerance) {
    MotionOutcome outcome;
    outcome.scene = scene.name;
    outcome.level = scene.level;
    outcome.solver = key;
    outcome.tolerance = tolerance;
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    const std::unique_ptr<Motion> motion = Start(scene, tolerance, solver.get());
    Watch watch(tolerance, study_.budget_s, &outcome);
    motion->set_observer([&watch](const MotionProblem& met) { watch(met); });

    const double scale = PositiveOrOne(reference.scale);
    const double start = reference.instants.front().energy;
    const int interval = std::max(1, study_.steps / kSamples);
    WriteSample(outcome, start, {0, 0}, watch);
    Deviation deviation;
    for (int k = 1; k <= study_.steps; ++k) {
      if (Interruption::Requested()) break;
      try {
        motion->Advance(scene.step);
      } catch (const InputError& error) {
        outcome.stopped = error.what();
      } catch (const BudgetSpent&) {
        outcome.stopped = "not finished within " + CsvWriter::Cell(study_.budget_s) + " s";
      } catch (const Interrupted&) {
        break;
      }
      if (motion->status() != MotionStatus::kMoving) outcome.stopped = motion->detail();
      const bool stopped = !outcome.stopped.empty();
      if (!stopped) outcome.steps = k;
      outcome.time = motion->time();
      const Instant now = InstantOf(motion->world());
      const MotionStatistics& statistics = motion->statistics();
      outcome.solves = statistics.solves;
      outcome.failed = statistics.failed_solves;
      outcome.solve_time_s = statistics.solve_time_s;
      if (outcome.steps > 0) outcome.energy_drift = (now.energy - start) / scale;
      if (static_cast<std::size_t>(k) < reference.instants.size() && !stopped) {
        const Instant& expected = reference.instants[static_cast<std::size_t>(k)];
        deviation.Note(std::abs(now.energy - expected.energy) / scale, Distance(now, expected));
        outcome.energy_error = std::fmax(outcome.energy_error, deviation.energy);
        outcome.distance = std::fmax(outcome.distance, deviation.distance);
      }
      outcome.penetration = std::fmax(outcome.penetration, watch.penetration);
      outcome.joint_error = std::fmax(outcome.joint_error, watch.joint_error);
      outcome.rho = std::fmax(outcome.rho, watch.rho);
      if (k % interval == 0 || k == study_.steps || stopped) {
        WriteSample(outcome, now.energy, deviation, watch);
        watch.Restart();
        deviation = {};
      }
      bar_->Advance(1, scene.name + ": " + key);
      if (stopped) {
        bar_->Advance(study_.steps - k, scene.name + ": " + key + " stopped");
        break;
      }
    }
    return outcome;
  }

 private:
  std::unique_ptr<Motion> Start(const MovingScene& scene, double tolerance, LcpSolver* solver) const {
    LcpOptions lcp;
    lcp.tolerance = tolerance;
    lcp.time_limit_s = study_.budget_s;
    return StartMotion(scene, lcp, *solver);
  }

  void WriteSample(const MotionOutcome& outcome, double energy, const Deviation& deviation, const Watch& watch) {
    using Csv = CsvWriter;
    csv_.Row({outcome.scene,
              std::string(ToString(outcome.level)),
              std::to_string(study_.size),
              std::to_string(study_.seed),
              outcome.solver,
              Csv::Cell(outcome.tolerance),
              std::to_string(outcome.steps),
              Csv::Cell(outcome.time),
              Csv::Cell(energy),
              Csv::Cell(deviation.energy),
              Csv::Cell(watch.penetration),
              Csv::Cell(watch.joint_error),
              Csv::Cell(deviation.distance),
              Csv::Cell(watch.rho),
              Csv::Cell(outcome.solve_time_s),
              std::to_string(outcome.solves),
              std::to_string(outcome.failed),
              std::to_string(outcome.not_passed),
              std::to_string(outcome.false_successes),
              outcome.stopped});
  }

  const MotionStudy& study_;
  CsvWriter csv_;
  ProgressBar* bar_;
};

std::vector<double> TolerancesOf(const MotionStudy& study, const std::string& solver) {
  if (FindSolver(solver).uses_tolerance) return study.tolerances;
  return {*std::min_element(study.tolerances.begin(), study.tolerances.end())};
}

void RequireValid(const MotionStudy& study) {
  if (study.scenes.empty()) throw InputError("motion: expected at least one scene");
  if (study.solvers.empty()) throw InputError("motion: expected at least one solver");
  if (study.tolerances.empty()) throw InputError("motion: expected at least one tolerance");
  for (const double tolerance : study.tolerances) {
    if (!(tolerance > 0 && tolerance < 1)) throw InputError("motion: tolerances: expected numbers in (0, 1)");
  }
  for (const std::string& solver : study.solvers) MakeSolver(solver);
  if (study.steps < 1) throw InputError("motion: steps: expected a number >= 1");
  if (!(study.budget_s > 0)) throw InputError("motion: budget: expected seconds > 0");
}

}  // namespace

std::vector<MotionOutcome> RunMotionStudy(const MotionStudy& study, const std::string& folder) {
  RequireValid(study);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": cannot be created: " + error.message());
  std::size_t motions = 1;  // the reference
  for (const std::string& solver : study.solvers) motions += TolerancesOf(study, solver).size();

  std::vector<MotionOutcome> outcomes;
  ProgressBar bar("motion", static_cast<double>(study.scenes.size() * motions) * study.steps);
  Study runner(study, folder, &bar);
  for (const MovingScene& scene : study.scenes) {
    const Reference reference = runner.RunReference(scene);
    for (const std::string& solver : study.solvers) {
      for (const double tolerance : TolerancesOf(study, solver)) {
        if (Interruption::Requested()) return outcomes;
        outcomes.push_back(runner.Run(scene, reference, solver, tolerance));
      }
    }
  }
  return outcomes;
}

}  // namespace lcpbench
