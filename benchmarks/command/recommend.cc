#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <set>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/recommend/problem_steps.h"
#include "benchmarks/recommend/race.h"
#include "benchmarks/recommend/recommendation.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// Seconds of "0.001", "1ms", "100us", "16.7 ms"; 0 for anything else.
double Duration(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  unit.erase(0, std::min(unit.find_first_not_of(' '), unit.size()));
  if (error != std::errc() || !std::isfinite(value)) return 0;
  if (unit.empty() || unit == "s") return value;
  // Dividing rounds once, so that 100us is 1e-4.
  return unit == "ms" ? value / 1e3 : unit == "us" || unit == "µs" ? value / 1e6 : 0;
}

// What is known of a problem before it is solved: as in manifests, and how it falls apart.
nlohmann::ordered_json FeaturesOf(const LcpProblem& problem) {
  nlohmann::ordered_json line = {{"problem", problem.id()}};
  line.update(DescribeProperties(MeasureProperties(problem)));
  if (problem.size() == 0) return line;
  Islands islands;
  islands.Find(problem.SparseA(), std::vector<char>(static_cast<size_t>(problem.size()), 1));
  line["islands"] = islands.count();
  line["largest_island"] = static_cast<double>(islands.largest()) / static_cast<double>(problem.size());
  const Eigen::VectorXd& D = problem.DiagonalA();
  const double least = (D.array() > 0).select(D.array(), D.maxCoeff()).minCoeff();
  line["diagonal_spread"] = least > 0 ? D.maxCoeff() / least : 1;
  return line;
}

struct Recommend {
  std::vector<std::string> files;
  SceneOptions start;
  int steps = 1;
  std::vector<std::string> candidates;
  bool peers = false;
  RaceOptions race;
  RaceProcess process;
  bool json = false;
  bool features = false;
  NamedSolvers named;
  ReadingOptions reading;

  void Declare(CLI::App& app) {
    app.add_option("FILE", files, "Problem file of any format, or a sequence as JSON lines; - for standard input");
    CLI::Option* scene = app.add_option("--scene", start.scene,
                                        "Instead of a file: scene key (lcpbench list scenes), or a scene file (.json)");
    for (CLI::Option* of_scene : start.AddSizeAndSeed(app)) of_scene->needs(scene);
    app.add_option("--steps", steps, "Of the scene: let it move for so many steps; 1: an instant")
        ->check(AtLeast(1))
        ->needs(scene);
    app.add_option_function<std::string>(
        "--deadline",
        [this](const std::string& text) {
          all_.request.deadline_s = Duration(text);
          if (all_.request.deadline_s > 0) return;
          throw InputError("--deadline: expected a time > 0 in seconds, or with us, ms or s, found '" + text + "'");
        },
        "Of a step's set-up and solve, met at the 99th percentile: seconds, or 500us, 16ms");
    AddToleranceOption(app, &all_.request.tolerance);
    app.add_option("--candidates", candidates,
                   "Solver keys [default: all own solvers that take the problems, and those named by --external]")
        ->delimiter(',')
        ->allow_extra_args(false);  // the file may come next
    app.add_flag("--peers", peers, "Also all peers of this build");
    app.add_option("--rounds", race.rounds, "How often every solver runs, unless a better one leaves it behind")
        ->check(AtLeast(1));
    app.add_option("--budget", race.budget_s, "Of the whole race [s]")->check(PositiveSeconds());
    AddCpuOption(app, &process.cpu);
    app.add_flag("--json", json, "All of it as one JSON object");
    app.add_flag("--features", features, "Only print the features of all problems, as JSON lines");
    AddReadingOptions(app, &reading);
    named.Declare(app);
    app.footer("Exit status 0 also where nothing meets the request; the answer then says so.");
  }

  int Run() {
    named.Register();
    if (features) return PrintFeatures();
    const size_t inputs = files.size() + (start.scene.empty() ? 0 : 1);
    if (inputs != 1) throw InputError("recommend: expected one FILE or --scene, found " + std::to_string(inputs));
    const ProblemSteps problems = start.scene.empty() ? ReadProblemSteps(files.front(), reading)
                                                      : MakeProblemSteps(start.scene, start.size, start.seed, steps);

    const auto by_rows = [](const SequenceStep& a, const SequenceStep& b) {
      return a.problem.size() < b.problem.size();
    };
    const auto [smallest, largest] = std::minmax_element(problems.steps.begin(), problems.steps.end(), by_rows);
    all_.input = problems.name;
    all_.problems = static_cast<int>(problems.steps.size());
    all_.least_rows = static_cast<double>(smallest->problem.size());
    all_.most_rows = static_cast<double>(largest->problem.size());
    all_.rows_are_known = problems.rows_are_known;
    all_.has_friction = std::ranges::any_of(
        problems.steps, [](const SequenceStep& step) { return !step.problem.friction_rows().empty(); });
    all_.request.by_tail = all_.problems > 1;
    all_.step_sizes = FindStepSizes(problems.steps);
    all_.rounds = race.rounds;
    all_.budget_s = race.budget_s;

    // Its words name the solvers that take what it does not.
    all_.note = WhyNotTaken(FindSolver("auto"), problems.steps);
    ChooseCandidates(problems.steps, largest->problem.size());
    for (const std::string& key : solvers_) {
      if (FindSolver(key).origin == SolverOrigin::kExternal) WorkerVersion(key);  // which says why it does not start
    }
    process.solver_arguments = named.Words();
    RunRace(problems);
    if (json) {
      std::cout << DescribeRecommendation(all_).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                << std::endl;
    } else {
      std::cout << FormatRecommendation(all_) << std::flush;
    }
    return 0;
  }

 private:
  int PrintFeatures() const {
    if (files.empty()) throw InputError("--features: expected one FILE or more");
    return ForEachProblem(files, reading,
                          [](const LcpRecord& record) { std::cout << FeaturesOf(record.problem).dump() << std::endl; });
  }

  // What a peer takes, only its worker knows.
  static std::string WhyNotTaken(const SolverEntry& entry, const std::vector<SequenceStep>& problems) {
    if (entry.origin != SolverOrigin::kOwn) return "";
    const auto solver = entry.make({});
    for (const SequenceStep& step : problems) {
      if (std::string why = solver->WhyRefused(step.problem); !why.empty()) return why;
    }
    return "";
  }

  // "" where it takes part in the race.
  std::string WhyNot(const SolverEntry& entry, const std::vector<SequenceStep>& problems, Index most_rows) const {
    if (!entry.available) return "not in this build";
    if (entry.origin == SolverOrigin::kPeer && !peers) return "a peer: --peers tries it";
    if (std::string why = SizeRefusal(entry, most_rows); !why.empty()) return why;
    return WhyNotTaken(entry, problems);
  }

  void ChooseCandidates(const std::vector<SequenceStep>& problems, Index most_rows) {
    const bool all = candidates.empty() || candidates == std::vector<std::string>{"all"};
    std::set<std::string> chosen;
    for (const std::string& key : all ? std::vector<std::string>() : candidates) {
      const SolverEntry& entry = FindSolver(key);
      if (!entry.available) throw InputError("--candidates: solver '" + key + "' is not in this build");
      if (chosen.insert(entry.key).second) solvers_.push_back(entry.key);  // a solver may have two names
    }
    for (const SolverEntry& entry : AllSolvers()) {
      if (chosen.count(entry.key) > 0) continue;
      std::string why = WhyNot(entry, problems, most_rows);
      if (why.empty() && !all && !(peers && entry.origin == SolverOrigin::kPeer)) why = "not named by --candidates";
      if (!why.empty()) {
        all_.untried.push_back({entry.key, why});
      } else if (entry.key == "auto") {
        solvers_.insert(solvers_.begin(), entry.key);  // its time soon tells how patient to be with others
      } else {
        solvers_.push_back(entry.key);
      }
    }
    if (solvers_.empty()) throw InputError("recommend: no solver of this build takes these problems");
  }

  void RunRace(const ProblemSteps& problems) {
    const double begun = SteadyNow();
    std::vector<Measurement> raced;
    for (Measurement& measured : RaceOnProblems(solvers_, problems, all_.request, race, process)) {
      if (measured.passes > 0) {
        raced.push_back(std::move(measured));
      } else {
        all_.untried.push_back({measured.solver, "the budget was spent before its turn"});
      }
    }
    all_.spent_s = SteadyNow() - begun;
    if (raced.empty()) {
      throw InputError("--budget: no solver had its turn within " + NumberText(race.budget_s) + " s, expected more");
    }
    all_.samples = static_cast<int>(raced.front().latency_s.size());
    all_.ranked = RankMeasurements(raced, all_.request);
  }

  Recommendation all_;
  std::vector<std::string> solvers_;
};

}  // namespace

void AddRecommendCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Recommend>(app, run, "recommend",
                        "Lets solvers race on a problem, a scene or a sequence, and names the best");
}

}  // namespace lcpbench
