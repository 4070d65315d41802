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
#include "benchmarks/command/program.h"
#include "benchmarks/measure/budget_clock.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/motions/scene_source.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "solvers/rows/row_input.h"
#include "solvers/step/step_solver.h"
#include "support/clock.h"
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

constexpr const char* kScenes[] = {"disc-pile", "boxes-and-discs", "oval-train"};
constexpr const char* kMotions[] = {"disc-pile", "tall-stacks", "boxes-and-discs"};
constexpr int kRows = 60;
constexpr std::uint64_t kSeed = 1;
constexpr int kSteps = 100;         // of a motion
constexpr double kBudget_s = 0.01;  // that every solver has, of mass-ratio
constexpr double kMotionBudget_s = 20;

struct Options {
  std::vector<std::string> curves;
  std::vector<std::string> solvers;
  std::string output = "build/results/curves";
};

LcpProblem ProblemOf(const std::string& scene, double mass_ratio) {
  Recipe recipe{scene, kRows, kSeed, {}, 0};
  if (mass_ratio > 1) recipe.changes = {{"mass-ratio", mass_ratio}};
  return MakeInstance(recipe).problem;
}

/// rho as the verifier measures it; infinite where there is none.
double RhoOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const double rho = ComputeMetrics(problem, f).rho;
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

CsvWriter TableOf(const Options& options, const std::string& curve, const std::vector<std::string>& columns) {
  return CsvWriter((std::filesystem::path(options.output) / (curve + ".csv")).string(), columns);
}

// ----- residual against the ratio of masses at equal time

std::vector<std::string> SolversOf(const Options& options) {
  if (!options.solvers.empty()) return options.solvers;
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    // The same code compiled otherwise is another speed, not another curve.
    if (entry.available && entry.takes_plain && !entry.key.ends_with("-baseline")) keys.push_back(entry.key);
  }
  return keys;
}

void MassRatioCurve(const Options& options) {
  constexpr int kDecades = 8;
  CsvWriter table =
      TableOf(options, "mass-ratio",
              {"scene", "rows", "mass_ratio", "budget_s", "solver", "origin", "asked", "rho", "seconds", "status"});
  const std::vector<std::string> keys = SolversOf(options);
  ProgressBar bar("mass-ratio", static_cast<double>(keys.size() * std::size(kScenes)));
  for (const std::string& key : keys) {
    const SolverEntry entry = FindSolver(key);
    const bool is_own = entry.origin == SolverOrigin::kOwn;
    const std::vector<double> tolerances =
        entry.tolerance() == "follows" ? std::vector<double>{1e-3, 1e-6, 1e-9, 1e-12} : std::vector<double>{1e-12};
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (const std::string scene : kScenes) {
      for (int decade = 0; decade <= kDecades; ++decade) {
        if (Interruption::Requested()) return;
        const double ratio = std::pow(10.0, decade);
        const LcpProblem problem = ProblemOf(scene, ratio);
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
          lcp.time_limit_s = kBudget_s;
          LcpResult result;
          const double seconds = TimeOfSolve(solver.get(), is_own, problem, arrays, lcp, &result);
          if (call < 0) continue;
          if (status == LcpStatus::kNotRun) status = result.status;
          if (result.status == LcpStatus::kUnsupported || seconds > kLate * kBudget_s) continue;
          const double rho = RhoOf(problem, result.f);
          if (rho < best) {
            best = rho;
            best_s = seconds;
            asked = lcp.tolerance;
            status = result.status;
          }
        }
        if (status == LcpStatus::kUnsupported) continue;
        table.Row({scene, std::to_string(problem.size()), CsvWriter::Cell(ratio), CsvWriter::Cell(kBudget_s), key,
                   OriginOf(entry), CsvWriter::Cell(asked), CsvWriter::Cell(best), CsvWriter::Cell(best_s),
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
  CsvWriter table =
      TableOf(options, "regularization",
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
    for (const std::string scene : kScenes) {
      if (Interruption::Requested()) return;
      const LcpProblem problem = ProblemOf(scene, 1);
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

Drive DriveMotion(const MovingScene& scene, LcpSolver* solver, std::int64_t sweeps) {
  LcpOptions lcp;
  lcp.tolerance = 1e-12;
  lcp.max_iterations = sweeps;
  lcp.time_limit_s = kMotionBudget_s;
  const std::unique_ptr<Motion> motion = StartMotion(scene, lcp, *solver);
  const BudgetClock budget(kMotionBudget_s);
  motion->set_check([&budget] {
    Interruption::Check();
    budget.Check();
  });
  Drive drive;
  std::vector<double> residuals;
  motion->set_observer([&](const MotionProblem& met) {
    residuals.push_back(RhoOf(met.problem, met.result.f));
    for (const RowInfo& row : met.rows) {
      double& worst = row.bilateral ? drive.joint_error : drive.penetration;
      worst = std::max(worst, row.bilateral ? std::abs(row.d) : -row.d);
    }
  });
  try {
    for (; drive.steps < kSteps && drive.stopped.empty(); ++drive.steps) {
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
  CsvWriter table = TableOf(options, "sweeps",
                            {"scene", "rows", "step_s", "solver", "sweeps", "rho", "penetration", "joint_error",
                             "seconds_per_step", "steps", "stopped"});
  const auto run = [&](const std::string& key, std::int64_t sweeps) {
    if (!FindSolver(key).available) return;
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (const char* const name : kMotions) {
      if (Interruption::Requested()) return;
      const MovingScene scene = LoadScene(name, kRows, kSeed);
      const Drive drive = DriveMotion(scene, solver.get(), sweeps);
      table.Row({scene.name, std::to_string(kRows), CsvWriter::Cell(scene.step), key,
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

/// One problem in the precision of `Real`, and its forces and velocities.
template <typename Real>
class GaussSeidel {
 public:
  explicit GaussSeidel(const StepRows& rows)
      : rows_(rows),
        width_(rows.columns_per_body),
        J_(rows.J, rows.J + 2 * width_ * rows.rows),
        inverse_mass_(rows.inverse_mass, rows.inverse_mass + width_ * rows.bodies),
        b_(rows.b, rows.b + rows.rows),
        f_(static_cast<std::size_t>(rows.rows), 0),
        step_(f_.size()),
        velocity_(inverse_mass_.size(), 0) {
    for (Index i = 0; i < rows_.rows; ++i) {
      Real diagonal = 0;
      Visit(i,
            [&](std::size_t entry, std::size_t column) { diagonal += J_[entry] * J_[entry] * inverse_mass_[column]; });
      step_[static_cast<std::size_t>(i)] = diagonal > 0 ? 1 / diagonal : 0;
    }
  }

  void Sweep() {
    for (Index i = 0; i < rows_.rows; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Real w = b_[row];
      Visit(i, [&](std::size_t entry, std::size_t column) { w += J_[entry] * velocity_[column]; });
      const bool is_free = rows_.bilateral != nullptr && rows_.bilateral[i] != 0;
      const Real wanted = f_[row] - w * step_[row];
      const Real next = is_free ? wanted : std::max<Real>(wanted, 0);
      const Real change = next - f_[row];
      f_[row] = next;
      Visit(i, [&](std::size_t entry, std::size_t column) {
        velocity_[column] += inverse_mass_[column] * J_[entry] * change;
      });
    }
  }

  Eigen::VectorXd Forces() const {
    return Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>>(f_.data(), rows_.rows).template cast<double>();
  }

 private:
  // act(place in J, column of J) for each number of a row.
  template <typename Act>
  void Visit(Index row, const Act& act) const {
    for (Index side = 0; side < 2; ++side) {
      const Index body = rows_.body[2 * row + side];
      if (body < 0) continue;
      for (Index k = 0; k < width_; ++k) {
        act(static_cast<std::size_t>((2 * row + side) * width_ + k), static_cast<std::size_t>(body * width_ + k));
      }
    }
  }

  const StepRows& rows_;
  Index width_;
  std::vector<Real> J_, inverse_mass_, b_, f_, step_, velocity_;
};

// Projected Gauss-Seidel over the velocities of bodies, the same code in both precisions, after 1, 3, 10, ... sweeps;
// and StepSolver with StepRows::J and with J_single, its sums in double. Answers are judged against the problem as
// given.
class PrecisionStudy {
 public:
  explicit PrecisionStudy(const Options& options)
      : table_(TableOf(options, "precision",
                       {"scene", "rows", "method", "precision", "sweeps", "mass_ratio", "rho", "seconds"})) {}

  void Compare(const std::string& scene, const LcpProblem& problem, double mass_ratio) {
    const auto write = [&](const char* method, bool is_single, int sweeps, const Eigen::VectorXd& f, double seconds) {
      table_.Row({scene, std::to_string(problem.size()), method, is_single ? "single" : "double",
                  sweeps == 0 ? "" : std::to_string(sweeps), CsvWriter::Cell(mass_ratio),
                  CsvWriter::Cell(RhoOf(problem, f)), CsvWriter::Cell(seconds)});
    };
    const ProblemArrays arrays = ProblemArrays::Of(problem);  // the copy points to them
    TwoBodyCopy copy;
    if (!problem.has_factors() || !copy.Take(arrays)) return;  // a row acts on more than two bodies
    const StepRows rows = copy.rows();
    Sweep<double>(rows, false, write);
    Sweep<float>(rows, true, write);
    Step(rows, false, write);
    const std::vector<float> J(rows.J, rows.J + Index{2} * rows.columns_per_body * rows.rows);
    StepRows single = rows;
    single.J = nullptr;
    single.J_single = J.data();
    Step(single, true, write);
  }

 private:
  template <typename Real>
  static void Sweep(const StepRows& rows, bool is_single, const auto& write) {
    GaussSeidel<Real> solver(rows);
    double seconds = 0;
    int done = 0;
    for (const int sweeps : {1, 3, 10, 30, 100, 300, 1000, 3000, 10000}) {
      const double start = SteadyNow();
      for (; done < sweeps; ++done) solver.Sweep();
      seconds += SteadyNow() - start;
      write("gauss-seidel", is_single, sweeps, solver.Forces(), seconds);
    }
  }

  static void Step(const StepRows& rows, bool is_single, const auto& write) {
    constexpr int kTimedSteps = 21;
    StepSolver solver;
    Eigen::VectorXd f(rows.rows);
    std::vector<double> seconds;
    for (int call = -1; call < kTimedSteps; ++call) {
      const double start = SteadyNow();
      solver.Solve(rows, nullptr, f.data());
      if (call >= 0) seconds.push_back(SteadyNow() - start);
    }
    write("tableau", is_single, 0, f, MedianOf(seconds));
  }

  CsvWriter table_;
};

void PrecisionCurve(const Options& options) {
  PrecisionStudy study(options);
  for (const std::string scene : kScenes) {
    for (const double ratio : {1.0, 1e4}) study.Compare(scene, ProblemOf(scene, ratio), ratio);
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
