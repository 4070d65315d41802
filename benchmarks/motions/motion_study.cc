#include "benchmarks/motions/motion_study.h"

#include <algorithm>
#include <boost/algorithm/string/split.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <system_error>

#include "benchmarks/measure/budget_clock.h"
#include "benchmarks/measure/environment.h"
#include "benchmarks/measure/progress.h"
#include "model/contact/loads.h"
#include "model/motion/contact_finder.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/csv.h"
#include "support/input_error.h"
#include "support/text_file.h"

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

/// Kinetic energy that the loads give bodies at rest in a time h.
double EnergyOfLoads(const std::vector<Body>& bodies, double h) {
  double energy = 0;
  for (const Body& body : bodies) {
    if (body.fixed) continue;
    energy += h * h / 2 * (Dot(body.force, body.force) / body.mass + body.torque * body.torque / body.inertia);
  }
  return energy;
}

/// The reference motion at the multiples of the scene's step.
struct Reference {
  std::vector<Instant> instants = {};
  double scale = 0;  ///< MotionStudy's of energies [J]
  double width = 0;  ///< of the thinnest movable body; 0: none has an outline [m]
};

constexpr const char* kCold = "cold";

/// What a row of motion.csv is written from.
struct Sample {
  const MotionStudy& study;
  const MotionOutcome& outcome;
  double energy = 0;
  double width = 0;  ///< Reference's
  const WorstFigures& since_last;
};

/// The columns of motion.csv.
struct Column {
  const char* name;
  std::string (*cell)(const Sample&);
};
using Csv = CsvWriter;
constexpr Column kColumns[] = {
    {"scene", [](const Sample& s) { return s.outcome.scene; }},
    {"level", [](const Sample& s) { return std::string(ToString(s.outcome.level)); }},
    {"size", [](const Sample& s) { return std::to_string(s.study.size); }},
    {"seed", [](const Sample& s) { return std::to_string(s.study.seed); }},
    {"solver", [](const Sample& s) { return s.outcome.driver.solver; }},
    {"tolerance", [](const Sample& s) { return Csv::Cell(s.outcome.tolerance); }},
    {"step", [](const Sample& s) { return std::to_string(s.outcome.steps); }},
    {"time", [](const Sample& s) { return Csv::Cell(s.outcome.time); }},
    {"energy", [](const Sample& s) { return Csv::Cell(s.energy); }},
    {"energy_error", [](const Sample& s) { return Csv::Cell(s.since_last.energy_error); }},
    {"penetration", [](const Sample& s) { return Csv::Cell(s.since_last.penetration); }},
    {"joint_error", [](const Sample& s) { return Csv::Cell(s.since_last.joint_error); }},
    {"distance", [](const Sample& s) { return Csv::Cell(s.since_last.distance); }},
    {"width", [](const Sample& s) { return Csv::Cell(s.width); }},
    {"rho", [](const Sample& s) { return Csv::Cell(s.since_last.rho); }},
    {"lost_gap", [](const Sample& s) { return Csv::Cell(s.since_last.lost_gap); }},
    {"creep", [](const Sample& s) { return Csv::Cell(s.outcome.creep); }},
    {"created", [](const Sample& s) { return Csv::Cell(s.outcome.created); }},
    {"max_iterations", [](const Sample& s) { return std::to_string(s.outcome.driver.max_iterations); }},
    {"start", [](const Sample& s) { return std::string(s.outcome.driver.warm_start ? "warm" : kCold); }},
    {"solve_time_s", [](const Sample& s) { return Csv::Cell(s.outcome.solve_time_s); }},
    {"solves", [](const Sample& s) { return std::to_string(s.outcome.solves); }},
    {"failed", [](const Sample& s) { return std::to_string(s.outcome.failed); }},
    {"not_passed", [](const Sample& s) { return std::to_string(s.outcome.not_passed); }},
    {"false_successes", [](const Sample& s) { return std::to_string(s.outcome.false_successes); }},
    {"stopped", [](const Sample& s) { return s.outcome.stopped; }}};

/// What an answer with friction is off by in one step.
struct FrictionErrors {
  double lost_gap = 0;  ///< [m]
  double creep = 0;     ///< [m]
  double created = 0;   ///< [J]
};

// Rows of a time step h with f impulses and w velocities.
FrictionErrors FrictionErrorsOf(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                                double h) {
  FrictionErrors errors;
  const Eigen::VectorXd& D = problem.DiagonalA();
  for (const FrictionRow& row : problem.friction_rows()) {
    const double spare = D[row.row] * (row.mu * std::max(f[row.normal], 0.0) - std::abs(f[row.row]));
    errors.lost_gap = std::max(errors.lost_gap, h * std::min(w[row.normal], D[row.normal] * f[row.normal]));
    errors.creep = std::max(errors.creep, h * std::min(std::abs(w[row.row]), spare));
    errors.created += std::max(f[row.row] * w[row.row], 0.0);
  }
  return errors;
}

template <class Cell>
std::vector<std::string> Row(const Cell& cell) {
  std::vector<std::string> row;
  for (const Column& column : kColumns) row.push_back(cell(column));
  return row;
}

class Study {
 public:
  Study(const MotionStudy& study, const std::string& folder, ProgressBar* bar)
      : study_(study),
        csv_((std::filesystem::path(folder) / "motion.csv").string(), Row([](const Column& c) { return c.name; })),
        bar_(bar) {}

  Reference RunReference(const MovingScene& scene) {
    constexpr double kPatience = 3;  // without it nothing can be compared
    const std::unique_ptr<LcpSolver> solver = MakeSolver(kDrivingSolver);
    const std::unique_ptr<Motion> motion = Start(scene, kReferenceTolerance, {}, solver.get());
    Reference reference{.width = ContactFinder(scene.world).least_width()};
    const auto note = [&] {
      reference.instants.push_back(InstantOf(motion->world()));
      reference.scale = std::max(reference.scale, KineticEnergy(motion->world().bodies));
    };
    note();
    // Where it stops early, the solvers' motions are compared with what there is.
    Drive(
        scene, "reference", kPatience, motion.get(),
        [&](const MotionProblem& met) {
          reference.scale = std::max(reference.scale, EnergyOfLoads(met.system.bodies, scene.step));
        },
        [&](int, const std::string& stopped) {
          if (stopped.empty()) note();
        });
    return reference;
  }

  MotionOutcome Run(const MovingScene& scene, const Reference& reference, const MotionDriver& driver,
                    double tolerance) {
    MotionOutcome outcome;
    outcome.scene = scene.name;
    outcome.level = scene.level;
    outcome.driver = driver;
    outcome.tolerance = tolerance;
    const std::unique_ptr<LcpSolver> solver = MakeMotionSolver(scene, driver.solver);
    const std::unique_ptr<Motion> motion = Start(scene, tolerance, driver, solver.get());
    const double scale = reference.scale > 0 ? reference.scale : 1;
    const double start = reference.instants.front().energy;
    const int interval = std::max(1, study_.steps / kSamples);
    WorstFigures since_last{.energy_error = 0, .distance = 0};  // at the start
    const auto write = [&](double energy) {
      const Sample sample{study_, outcome, energy, reference.width, since_last};
      csv_.Row(Row([&](const Column& column) { return column.cell(sample); }));
      since_last = {};
    };
    write(start);
    const auto judge = [&](const MotionProblem& met) {
      WorstFigures now;
      for (const RowInfo& row : met.rows) {
        if (row.axis == 't') continue;
        double& worst = row.bilateral ? now.joint_error : now.penetration;
        worst = std::fmax(worst, row.bilateral ? std::abs(row.d) : std::fmax(0, -row.d));
      }
      const Verdict verdict = Verify(met.problem, met.result, tolerance);
      // NaN must not pass for small.
      now.rho = std::isnan(verdict.metrics.rho) ? std::numeric_limits<double>::infinity() : verdict.metrics.rho;
      if (!met.problem.is_plain() && met.result.f.allFinite()) {
        const FrictionErrors errors = FrictionErrorsOf(met.problem, met.result.f, verdict.metrics.w, scene.step);
        now.lost_gap = errors.lost_gap;
        outcome.creep = std::fmax(outcome.creep, 0) + errors.creep;
        outcome.created = std::fmax(outcome.created, 0) + errors.created / scale;
      }
      since_last.Note(now);
      if (!verdict.passes) ++outcome.not_passed;
      if (verdict.false_success) ++outcome.false_successes;
    };
    Drive(scene, ToString(driver), 1, motion.get(), judge, [&](int k, const std::string& stopped) {
      outcome.stopped = stopped;
      if (stopped.empty()) outcome.steps = k;
      outcome.time = motion->time();
      const Instant now = InstantOf(motion->world());
      const MotionStatistics& statistics = motion->statistics();
      outcome.solves = statistics.solves;
      outcome.failed = statistics.failed_solves;
      outcome.solve_time_s = statistics.solve_time_s;
      if (outcome.steps > 0) outcome.energy_drift = (now.energy - start) / scale;
      if (static_cast<std::size_t>(k) < reference.instants.size() && stopped.empty()) {
        const Instant& expected = reference.instants[static_cast<std::size_t>(k)];
        since_last.Note({std::abs(now.energy - expected.energy) / scale, Distance(now, expected)});
      }
      outcome.Note(since_last);
      if (k % interval == 0 || k == study_.steps || !stopped.empty()) write(now.energy);
    });
    return outcome;
  }

 private:
  std::unique_ptr<Motion> Start(const MovingScene& scene, double tolerance, const MotionDriver& driver,
                                LcpSolver* solver) const {
    LcpOptions lcp;
    lcp.tolerance = tolerance;
    lcp.max_iterations = driver.max_iterations;
    lcp.time_limit_s = study_.budget_s;
    return StartMotion(scene, lcp, *solver, driver.warm_start);
  }

  // Calls judge(problem) for what the motion's observer meets, and done(k, why the motion stopped) after every step.
  template <class Judge, class Done>
  void Drive(const MovingScene& scene, const std::string& who, double budgets, Motion* motion, const Judge& judge,
             const Done& done) {
    const BudgetClock budget(budgets * study_.budget_s);
    motion->set_check([&budget] {
      Interruption::Check();
      budget.Check();
    });
    motion->set_observer(judge);
    std::string stopped;
    for (int k = 1; k <= study_.steps && stopped.empty() && !Interruption::Requested(); ++k) {
      try {
        motion->Advance(scene.step);
        if (motion->status() != MotionStatus::kMoving) stopped = motion->detail();
      } catch (const InputError& error) {
        stopped = error.what();
      } catch (const BudgetSpent&) {
        stopped = budget.Reason();
      } catch (const Interrupted&) {
        return;
      }
      done(k, stopped);
      const bool goes_on = stopped.empty();
      bar_->Advance(goes_on ? 1 : study_.steps - k + 1, scene.name + ": " + who + (goes_on ? "" : " stopped"));
    }
  }

  const MotionStudy& study_;
  CsvWriter csv_;
  ProgressBar* bar_;
};

std::vector<double> TolerancesOf(const MotionStudy& study, const MotionDriver& driver) {
  if (driver.tolerance > 0) return {driver.tolerance};
  if (FindSolver(driver.solver).uses_tolerance && driver.max_iterations == 0) return study.tolerances;
  return {*std::min_element(study.tolerances.begin(), study.tolerances.end())};
}

void RequireValid(const MotionStudy& study) {
  if (study.scenes.empty()) throw InputError("motion: expected at least one scene");
  if (study.drivers.empty()) throw InputError("motion: expected at least one solver");
  if (study.tolerances.empty()) throw InputError("motion: expected at least one tolerance");
  for (const double tolerance : study.tolerances) {
    if (!(tolerance > 0 && tolerance < 1)) throw InputError("motion: tolerances: expected numbers in (0, 1)");
  }
  for (const MotionDriver& driver : study.drivers) {
    for (const MovingScene& scene : study.scenes) MakeMotionSolver(scene, driver.solver);
  }
  if (study.steps < 1) throw InputError("motion: steps: expected a number >= 1");
  if (!(study.budget_s > 0)) throw InputError("motion: budget: expected seconds > 0");
}

// What the rows of motion.csv do not say of themselves.
void Describe(const MotionStudy& study, const std::string& folder) {
  nlohmann::ordered_json json = {{"schema", "lcpbench-motion/1"}, {"steps", study.steps}, {"budget_s", study.budget_s}};
  for (const MovingScene& scene : study.scenes) {
    json["scenes"].push_back({{"scene", scene.name}, {"level", ToString(scene.level)}, {"step_s", scene.step}});
  }
  json["environment"] = DescribeEnvironment();
  TextOutput file((std::filesystem::path(folder) / "motion.json").string());
  file.Write(json.dump(1) + "\n");
  file.Close();
}

// The table.

std::string Text(const char* format, double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return value == 0 ? "0" : text;
}

std::string Short(double value) { return Text("%.1e", value); }

std::string TimePerStep(const MotionOutcome& outcome) {
  if (outcome.steps == 0 || outcome.solves == 0) return "-";
  return Text("%.1f", 1e6 * outcome.solve_time_s / outcome.steps);
}

struct TableColumn {
  const char* title;
  std::string (*cell)(const MotionOutcome&);
  bool of_friction = false;  ///< left out where nothing has any
};
constexpr TableColumn kTableColumns[] = {
    {"solver", [](const MotionOutcome& o) { return ToString(o.driver); }},
    {"tolerance", [](const MotionOutcome& o) { return Short(o.tolerance); }},
    {"energy drift", [](const MotionOutcome& o) { return Text("%+.3e", o.energy_drift); }},
    {"energy error", [](const MotionOutcome& o) { return Short(o.energy_error); }},
    {"penetration/m", [](const MotionOutcome& o) { return Short(o.penetration); }},
    {"joint/m", [](const MotionOutcome& o) { return Short(o.joint_error); }},
    {"distance/m", [](const MotionOutcome& o) { return Short(o.distance); }},
    {"lost gap/m", [](const MotionOutcome& o) { return Short(o.lost_gap); }, true},
    {"creep/m", [](const MotionOutcome& o) { return Short(o.creep); }, true},
    {"created", [](const MotionOutcome& o) { return Short(o.created); }, true},
    {"us/step", TimePerStep},
    {"worst rho", [](const MotionOutcome& o) { return Short(o.rho); }},
    {"solves", [](const MotionOutcome& o) { return std::to_string(o.solves); }},
    {"failed", [](const MotionOutcome& o) { return std::to_string(o.failed); }},
    {"unverified", [](const MotionOutcome& o) { return std::to_string(o.not_passed); }},
    {"false", [](const MotionOutcome& o) { return std::to_string(o.false_successes); }}};

// A block's lines, the first column to the left, numbers to the right.
std::string Aligned(const std::vector<MotionOutcome>& block) {
  std::vector<std::string> lines(block.size() + 1);
  const bool friction = std::any_of(block.begin(), block.end(), [](const auto& o) { return !std::isnan(o.creep); });
  for (const TableColumn& column : kTableColumns) {
    if (column.of_friction && !friction) continue;
    std::vector<std::string> cells = {column.title};
    for (const MotionOutcome& outcome : block) cells.push_back(column.cell(outcome));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const std::string blank(width - cells[k].size(), ' ');
      lines[k] += lines[k].empty() ? cells[k] + blank : "  " + blank + cells[k];
    }
  }
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

}  // namespace

MotionDriver ParseMotionDriver(const std::string& text) {
  std::vector<std::string> parts;
  boost::algorithm::split(parts, text, [](char c) { return c == '@'; });
  MotionDriver driver{.solver = parts.front()};
  for (const std::string& part : std::span(parts).subspan(1)) {
    double number = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    const bool is_number = error == std::errc() && end == part.data() + part.size();
    constexpr double kMost = 1e15;  // a whole number as a double
    if (part == kCold) {
      driver.warm_start = false;
    } else if (is_number && number > 0 && number < 1) {
      driver.tolerance = number;
    } else if (is_number && number >= 1 && number <= kMost && number == std::floor(number)) {
      driver.max_iterations = static_cast<std::int64_t>(number);
    } else {
      throw InputError("--solvers: " + text + ": expected after @ a tolerance below 1, a number of iterations or '" +
                       kCold + "', found '" + part + "'");
    }
  }
  return driver;
}

std::string ToString(const MotionDriver& driver) {
  return driver.solver + (driver.max_iterations > 0 ? "@" + std::to_string(driver.max_iterations) : "") +
         (driver.warm_start ? "" : std::string("@") + kCold);
}

std::vector<MotionOutcome> RunMotionStudy(const MotionStudy& study, const std::string& folder) {
  RequireValid(study);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": cannot be created: " + error.message());
  Describe(study, folder);
  std::size_t motions = 1;  // the reference
  for (const MotionDriver& driver : study.drivers) motions += TolerancesOf(study, driver).size();

  std::vector<MotionOutcome> outcomes;
  ProgressBar bar("motion", static_cast<double>(study.scenes.size() * motions) * study.steps);
  Study runner(study, folder, &bar);
  for (const MovingScene& scene : study.scenes) {
    const Reference reference = runner.RunReference(scene);
    for (const MotionDriver& driver : study.drivers) {
      for (const double tolerance : TolerancesOf(study, driver)) {
        if (Interruption::Requested()) return outcomes;
        outcomes.push_back(runner.Run(scene, reference, driver, tolerance));
      }
    }
  }
  return outcomes;
}

std::string FormatMotionTable(const std::vector<MotionOutcome>& outcomes) {
  std::string text;
  for (auto begin = outcomes.begin(); begin != outcomes.end();) {
    const auto end = std::find_if(begin, outcomes.end(), [&](const MotionOutcome& outcome) {
      return outcome.scene != begin->scene || outcome.level != begin->level;
    });
    text += (text.empty() ? "" : "\n") + begin->scene + ", " + std::string(ToString(begin->level)) + " level\n" +
            Aligned({begin, end});
    for (; begin != end; ++begin) {
      if (begin->stopped.empty()) continue;
      text += ToString(begin->driver) + " at " + Short(begin->tolerance) + " stopped after " +
              std::to_string(begin->steps) + " steps: " + begin->stopped + '\n';
    }
  }
  return text;
}

}  // namespace lcpbench
