// Curves that users ask authors of engines for, as tables that the report draws (RESULTS.md): a file per curve.
//   mass-ratio      the least residual that every solver delivers within one time, against the ratio of masses
//   regularization  what a shifted diagonal costs in residual and gains in time
//   sweeps          residual and penetration of motions against the sweeps of sequential impulses
//   precision       single against double precision: projected Gauss-Seidel, and steps from an engine's arrays

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/command/options.h"
#include "benchmarks/command/program.h"
#include "benchmarks/measure/budget_clock.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/motions/scene_source.h"
#include "benchmarks/studies/precision_curve.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/csv.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// An answer belongs to a time if its call took no more than this many times as long: clocks are read between sweeps.
constexpr double kLate = 1.25;
// For what reads no clock, before its worker is ended.
constexpr double kPatience_s = 1;
constexpr int kTimedSolves = 5;

struct Options {
  std::vector<std::string> curves;
  std::vector<std::string> solvers;
  std::vector<std::string> scenes = {"disc-pile", "boxes-and-discs", "oval-train"};
  std::vector<std::string> motions = {"disc-pile", "tall-stacks", "boxes-and-discs"};
  int rows = 60;
  std::uint64_t seed = 1;
  int steps = 100;
  double budget_s = 0.01;
  double motion_budget_s = 20;
  std::string output = "build/results/curves";
};

LcpProblem ProblemOf(const Options& options, const std::string& scene, double mass_ratio) {
  Recipe recipe{scene, options.rows, options.seed, {}, 0};
  if (mass_ratio > 1) recipe.changes = {{"mass-ratio", mass_ratio}};
  return MakeInstance(recipe).problem;
}

/// rho as the verifier measures it; infinite where there is none.
double RhoOf(const LcpProblem& problem, const LcpResult& result) {
  const double rho = ComputeMetrics(problem, result.f).rho;
  return std::isnan(rho) ? kInfinity : rho;
}

/// One call from the caller's arrays. Of a solver in another process the time is the one measured there.
double TimeOfSolve(LcpSolver* solver, bool is_own, const LcpProblem& problem, const ProblemArrays& arrays,
                   const LcpOptions& options, LcpResult* result) {
  const double start = SteadyNow();
  if (is_own) {
    solver->SolveArrays(arrays, options, result);
  } else {
    solver->Solve(problem, options, result);
  }
  return result->own_fresh_s >= 0 ? result->own_fresh_s : SteadyNow() - start;
}

std::string OriginOf(const SolverEntry& entry) { return entry.origin == SolverOrigin::kOwn ? "own" : "peer"; }

class Table {
 public:
  Table(const Options& options, const std::string& curve, const std::vector<std::string>& columns)
      : csv_((std::filesystem::path(options.output) / (curve + ".csv")).string(), columns) {}
  void Row(const std::vector<std::string>& cells) { csv_.Row(cells); }

 private:
  CsvWriter csv_;
};

// ----- residual against the ratio of masses at equal time

std::vector<std::string> SolversOf(const Options& options) {
  if (!options.solvers.empty()) return options.solvers;
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    // The same code compiled otherwise is another speed, not another curve.
    if (entry.available && entry.ablation.empty() && !entry.key.ends_with("-baseline")) keys.push_back(entry.key);
  }
  return keys;
}

void MassRatioCurve(const Options& options) {
  constexpr int kDecades = 8;
  Table table(options, "mass-ratio",
              {"scene", "rows", "mass_ratio", "budget_s", "solver", "origin", "asked", "rho", "seconds", "status"});
  const std::vector<std::string> keys = SolversOf(options);
  ProgressBar bar("mass-ratio", static_cast<double>(keys.size() * options.scenes.size()));
  for (const std::string& key : keys) {
    const SolverEntry entry = FindSolver(key);
    const bool is_own = entry.origin == SolverOrigin::kOwn;
    const std::vector<double> tolerances =
        entry.tolerance() == "follows" ? std::vector<double>{1e-3, 1e-6, 1e-9, 1e-12} : std::vector<double>{1e-12};
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (const std::string& scene : options.scenes) {
      for (int decade = 0; decade <= kDecades; ++decade) {
        if (Interruption::Requested()) return;
        const double ratio = std::pow(10.0, decade);
        const LcpProblem problem = ProblemOf(options, scene, ratio);
        const ProblemArrays arrays = ProblemArrays::Of(problem);
        if (!SizeRefusal(entry, problem.size()).empty()) continue;
        double best = kInfinity;
        double best_s = kInfinity;
        double asked = tolerances.front();
        LcpStatus status = LcpStatus::kNotRun;
        // The first call of all is for the workspace, and for an interpreter to load.
        for (int call = decade == 0 ? -1 : 0; call < static_cast<int>(tolerances.size()); ++call) {
          LcpOptions lcp;
          lcp.tolerance = tolerances[static_cast<std::size_t>(std::max(call, 0))];
          lcp.time_limit_s = options.budget_s;
          LcpResult result;
          const double seconds = TimeOfSolve(solver.get(), is_own, problem, arrays, lcp, &result);
          if (call < 0) continue;
          if (status == LcpStatus::kNotRun) status = result.status;
          if (result.status == LcpStatus::kUnsupported || seconds > kLate * options.budget_s) continue;
          const double rho = RhoOf(problem, result);
          if (rho < best) {
            best = rho;
            best_s = seconds;
            asked = lcp.tolerance;
            status = result.status;
          }
        }
        if (status == LcpStatus::kUnsupported) continue;
        table.Row({scene, std::to_string(problem.size()), CsvWriter::Cell(ratio), CsvWriter::Cell(options.budget_s),
                   key, OriginOf(entry), CsvWriter::Cell(asked), CsvWriter::Cell(best), CsvWriter::Cell(best_s),
                   std::string(ToString(status))});
      }
      bar.Advance(1, key);
    }
  }
}

// ----- what a regularization costs and gains

struct Shifted {
  std::string solver;
  std::string setting;  ///< "": as it is
  std::string value;
};

std::vector<Shifted> Regularizations() {
  std::vector<Shifted> all = {{"ode-dantzig", "", ""}, {"mujoco-newton-default", "", ""}, {"auto", "", ""}};
  for (int decade = -12; decade <= -2; ++decade) {
    const std::string value = "1e" + std::to_string(decade);
    all.push_back({"ode-dantzig-cfm", "cfm", value});
    all.push_back({"mujoco-newton", "regularization", value});
  }
  return all;
}

void RegularizationCurve(const Options& options) {
  Table table(options, "regularization",
              {"scene", "rows", "solver", "origin", "regularization", "rho", "violation", "seconds", "status"});
  const std::vector<Shifted> all = Regularizations();
  ProgressBar bar("regularization", static_cast<double>(all.size()));
  for (const Shifted& shifted : all) {
    bar.Advance(1, shifted.solver + ' ' + shifted.value);
    const SolverEntry entry = FindSolver(shifted.solver);
    if (!entry.available) continue;
    Settings settings;
    if (!shifted.setting.empty()) settings[shifted.setting] = shifted.value;
    const std::unique_ptr<LcpSolver> solver = MakeSolver(shifted.solver, settings);
    for (const std::string& scene : options.scenes) {
      if (Interruption::Requested()) return;
      const LcpProblem problem = ProblemOf(options, scene, 1);
      const ProblemArrays arrays = ProblemArrays::Of(problem);
      LcpOptions lcp;
      lcp.tolerance = 1e-9;
      lcp.time_limit_s = kPatience_s;
      LcpResult result;
      std::vector<double> seconds;
      for (int call = -1; call < kTimedSolves; ++call) {
        const double taken =
            TimeOfSolve(solver.get(), entry.origin == SolverOrigin::kOwn, problem, arrays, lcp, &result);
        if (call >= 0) seconds.push_back(taken);
      }
      if (result.status == LcpStatus::kUnsupported) continue;
      const Metrics metrics = ComputeMetrics(problem, result.f);
      // The largest acceleration that penetrates, of that which the loads alone would give.
      const double violation = metrics.dual_infeasibility / problem.b().cwiseAbs().maxCoeff();
      table.Row({scene, std::to_string(problem.size()), shifted.solver, OriginOf(entry),
                 shifted.value.empty() ? "" : shifted.value, CsvWriter::Cell(metrics.rho), CsvWriter::Cell(violation),
                 CsvWriter::Cell(MedianOf(seconds)), std::string(ToString(result.status))});
    }
  }
}

// ----- sequential impulses

struct Drive {
  double rho = 0;          ///< median over the problems met
  double penetration = 0;  ///< deepest [m]
  double joint_error = 0;  ///< largest [m]
  double solve_s = 0;      ///< per step
  int steps = 0;
  std::string stopped;
};

Drive DriveMotion(const Options& options, const MovingScene& scene, LcpSolver* solver, std::int64_t sweeps) {
  LcpOptions lcp;
  lcp.tolerance = 1e-12;
  lcp.max_iterations = sweeps;
  lcp.time_limit_s = options.motion_budget_s;
  const std::unique_ptr<Motion> motion = StartMotion(scene, lcp, *solver);
  const BudgetClock budget(options.motion_budget_s);
  motion->set_check([&budget] {
    Interruption::Check();
    budget.Check();
  });
  Drive drive;
  std::vector<double> residuals;
  motion->set_observer([&](const MotionProblem& met) {
    residuals.push_back(RhoOf(met.problem, met.result));
    for (const RowInfo& row : met.rows) {
      double& worst = row.bilateral ? drive.joint_error : drive.penetration;
      worst = std::max(worst, row.bilateral ? std::abs(row.d) : -row.d);
    }
  });
  try {
    for (; drive.steps < options.steps && drive.stopped.empty(); ++drive.steps) {
      motion->Advance(scene.step);
      if (motion->status() != MotionStatus::kMoving) drive.stopped = motion->detail();
    }
  } catch (const BudgetSpent&) {
    drive.stopped = budget.Reason();
  } catch (const Interrupted&) {
    drive.stopped = "interrupted";
  } catch (const InputError& error) {
    drive.stopped = error.what();
  }
  drive.rho = residuals.empty() ? kInfinity : MedianOf(residuals);
  drive.solve_s = motion->statistics().solve_time_s / std::max(1, drive.steps);
  return drive;
}

void SweepsCurve(const Options& options) {
  constexpr std::int64_t kSweeps[] = {1, 2, 4, 10, 20, 50, 100, 200, 500, 1000};
  Table table(options, "sweeps",
              {"scene", "rows", "step_s", "solver", "sweeps", "rho", "penetration", "joint_error", "seconds_per_step",
               "steps", "stopped"});
  const auto run = [&](const std::string& key, std::int64_t sweeps) {
    if (!FindSolver(key).available) return;
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (const std::string& name : options.motions) {
      if (Interruption::Requested()) return;
      const MovingScene scene = LoadScene(name, options.rows, options.seed);
      const Drive drive = DriveMotion(options, scene, solver.get(), sweeps);
      table.Row({scene.name, std::to_string(options.rows), CsvWriter::Cell(scene.step), key,
                 sweeps == 0 ? "" : std::to_string(sweeps), CsvWriter::Cell(drive.rho),
                 CsvWriter::Cell(drive.penetration), CsvWriter::Cell(drive.joint_error), CsvWriter::Cell(drive.solve_s),
                 std::to_string(drive.steps), drive.stopped});
    }
  };
  ProgressBar bar("sweeps", static_cast<double>(std::size(kSweeps) + 1));
  // For comparison: a motion has errors with exact impulses, too.
  run("dantzig", 0);
  bar.Advance(1, "dantzig");
  for (const std::int64_t sweeps : kSweeps) {
    run("bullet-si-1000", sweeps);
    bar.Advance(1, std::to_string(sweeps) + " sweeps");
  }
}

// ----- single precision

void PrecisionCurve(const Options& options) {
  Table table(options, "precision", {"scene", "rows", "method", "precision", "sweeps", "mass_ratio", "rho", "seconds"});
  for (const std::string& scene : options.scenes) {
    for (const double ratio : {1.0, 1e4}) {
      const LcpProblem problem = ProblemOf(options, scene, ratio);
      for (const PrecisionPoint& point : ComparePrecisions(problem)) {
        table.Row({scene, std::to_string(problem.size()), point.method, point.is_single ? "single" : "double",
                   point.sweeps == 0 ? "" : std::to_string(point.sweeps), CsvWriter::Cell(ratio),
                   CsvWriter::Cell(point.rho), CsvWriter::Cell(point.seconds)});
      }
    }
  }
}

struct Curve {
  const char* name;
  void (*make)(const Options& options);
};
constexpr Curve kCurves[] = {{"mass-ratio", &MassRatioCurve},
                             {"regularization", &RegularizationCurve},
                             {"sweeps", &SweepsCurve},
                             {"precision", &PrecisionCurve}};

int Main(int argc, char** argv) {
  Options options;
  CLI::App app{"Curves of all solvers that the report draws, a CSV file each", "solver_curves"};
  std::vector<std::string> names;
  for (const Curve& curve : kCurves) names.emplace_back(curve.name);
  options.curves = names;
  app.add_option("curves", options.curves, "Which [default: all]")->check(CLI::IsMember(names));
  app.add_option("--solvers", options.solvers, "Of mass-ratio [default: all of this build]")->delimiter(',');
  app.add_option("--scenes", options.scenes, "Families whose problems are solved")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--motions", options.motions, "Families that sequential impulses drive")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--rows", options.rows, "Of the scenes")->check(AtLeast(1))->capture_default_str();
  app.add_option("--seed", options.seed, "Of the scenes")->capture_default_str();
  app.add_option("--steps", options.steps, "Of a motion")->check(AtLeast(1))->capture_default_str();
  app.add_option("--budget", options.budget_s, "Seconds that every solver has, of mass-ratio")
      ->check(PositiveSeconds())
      ->capture_default_str();
  app.add_option("-o,--output", options.output, "Folder of the files")->capture_default_str();
  if (const auto status = ParseCommandLine(app, argc, argv)) return *status;
  for (const std::string& key : options.solvers) MakeSolver(key);
  std::error_code error;
  std::filesystem::create_directories(options.output, error);
  if (error) throw InputError(options.output + ": cannot be created: " + error.message());
  const Interruption interruption;
  for (const Curve& curve : kCurves) {
    if (std::find(options.curves.begin(), options.curves.end(), curve.name) == options.curves.end()) continue;
    curve.make(options);
    if (Interruption::Requested()) return Interruption::ExitStatus();
  }
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunProgram("solver_curves", [&] { return lcpbench::Main(argc, argv); });
}
