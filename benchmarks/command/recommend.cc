#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <set>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"
#include "benchmarks/recommend/recommendation.h"
#include "benchmarks/recommend/rules.h"
#include "solvers/registry.h"
#include "support/input_error.h"

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

struct Recommend {
  std::vector<std::string> files;
  SceneOptions start;
  int steps = 1;
  std::vector<std::string> candidates;
  bool peers = false;
  std::string rules_file;
  MeasurementPlan plan;
  bool json = false;
  bool features = false;
  NamedSolvers named;
  ReadingOptions reading;

  void Declare(CLI::App& app) {
    app.add_option("FILE", files, "Problem file of any format, or a sequence as JSON lines; - for standard input");
    app.add_option("--scene", start.scene,
                   "Instead of a file: scene key (lcpbench list scenes), or a scene file (.json)");
    start.AddSizeAndSeed(app);
    app.add_option("--steps", steps, "Of the scene: let it move for so many steps; 1: an instant")->check(AtLeast(1));
    app.add_option_function<std::string>(
        "--deadline",
        [this](const std::string& text) {
          all_.request.deadline_s = Duration(text);
          if (all_.request.deadline_s > 0) return;
          throw InputError("--deadline: expected a time > 0 in seconds, or with us, ms or s, found '" + text + "'");
        },
        "Of a step's set-up and solve, met at the 99th percentile: seconds, or 500us, 16ms");
    AddToleranceOption(app, &plan.tolerance);
    app.add_option("--candidates", candidates,
                   "Solver keys, or all: all own solvers [default: those that the rules name]")
        ->delimiter(',')
        ->allow_extra_args(false);  // the file may come next
    app.add_flag("--peers", peers, "Also try the peers that were fast in the reference");
    app.add_option("--rules", rules_file,
                   "Written by report/report.py recommendation [default: data/recommendation.json]");
    app.add_option("--rounds", plan.rounds, "How often every candidate is run")->check(AtLeast(1));
    AddCpuOption(app, &plan.cpu);
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
    const RecommendationRules rules =
        ReadRecommendationRules(rules_file.empty() ? DataFile("recommendation") : rules_file);
    const ProblemSteps problems = start.scene.empty() ? ReadProblemSteps(files.front(), reading)
                                                      : MakeProblemSteps(start.scene, start.size, start.seed, steps);

    const auto by_rows = [](const SequenceStep& a, const SequenceStep& b) {
      return a.problem.size() < b.problem.size();
    };
    const auto [smallest, largest] = std::minmax_element(problems.steps.begin(), problems.steps.end(), by_rows);
    all_.request.tolerance = plan.tolerance;
    all_.input = problems.name;
    all_.problems = static_cast<int>(problems.steps.size());
    all_.least_rows = static_cast<double>(smallest->problem.size());
    all_.most_rows = static_cast<double>(largest->problem.size());
    all_.rows_are_known = problems.rows_are_known;
    all_.request.by_tail = all_.problems > 1;
    all_.features = MeasureFeatures(largest->problem);
    all_.step_sizes = FindStepSizes(problems.steps);
    all_.rules_file = rules.file;
    all_.made_of = rules.made_of;
    all_.region = FindRegion(rules, all_.features, plan.tolerance);

    // Its words name the solvers that take what it does not.
    all_.note = MakeSolver("auto")->WhyUnsupported(largest->problem);
    ChooseCandidates(largest->problem);
    for (const std::string& key : plan.solvers) {
      if (FindSolver(key).origin == SolverOrigin::kExternal) WorkerVersion(key);  // which says why it does not start
    }
    plan.solver_arguments = named.Words();
    const std::vector<Measurement> measurements = MeasureSolvers(plan, problems);
    all_.rounds = plan.rounds;
    all_.samples = static_cast<int>(measurements.front().latency_s.size());
    all_.ranked = RankMeasurements(measurements, all_.request);
    all_.untried = Untried(largest->problem);
    if (json) {
      std::cout << DescribeRecommendation(all_).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                << std::endl;
    } else {
      std::cout << FormatRecommendation(all_) << std::flush;
    }
    return 0;
  }

 private:
  // What report/report.py recommendation makes rules of: the same numbers as the command looks them up by.
  int PrintFeatures() const {
    if (files.empty()) throw InputError("--features: expected one FILE or more");
    return ForEachProblem(files, reading, [](const LcpRecord& record) {
      nlohmann::ordered_json line = {{"problem", record.problem.id()}};
      line.update(Describe(MeasureFeatures(record.problem)));
      std::cout << line.dump() << std::endl;
    });
  }

  // Of a name the solver it stands for, so that none is tried twice.
  void Try(const SolverEntry& entry) {
    if (tried_.insert(entry.key).second) plan.solvers.push_back(entry.key);
  }

  // What a peer takes, only its worker knows.
  static bool Takes(const SolverEntry& entry, const LcpProblem& problem) {
    if (!entry.available) return false;
    return entry.origin != SolverOrigin::kOwn || entry.make({})->WhyUnsupported(problem).empty();
  }

  void ChooseCandidates(const LcpProblem& problem) {
    const bool by_rules = candidates.empty();
    const bool all = candidates == std::vector<std::string>{"all"};
    const auto fits = [&problem](const SolverEntry& entry) {
      return Takes(entry, problem) && SizeRefusal(entry, problem.size()).empty();
    };
    if (by_rules || all) {
      for (const std::string& key : all_.region.candidates) {
        if (const SolverEntry& entry = FindSolver(key); Takes(entry, problem)) Try(entry);
      }
    }
    if (all || (by_rules && plan.solvers.empty())) {  // the rules are made of problems with symmetric A
      for (const SolverEntry& entry : AllSolvers()) {
        if (entry.origin == SolverOrigin::kOwn && fits(entry)) Try(entry);
      }
    } else {
      for (const std::string& key : candidates) {
        const SolverEntry& entry = FindSolver(key);
        if (!entry.available) throw InputError("--candidates: solver '" + key + "' is not in this build");
        Try(entry);
      }
    }
    for (const std::string& key : peers ? all_.region.peers : std::vector<std::string>()) {
      if (const SolverEntry& entry = FindSolver(key); fits(entry)) Try(entry);
    }
    if (plan.solvers.empty()) throw InputError("recommend: none of the candidates of the rules is in this build");
  }

  std::vector<UntriedSolver> Untried(const LcpProblem& problem) const {
    std::vector<UntriedSolver> untried;
    std::set<std::string> known = tried_;
    int rank = 0;
    for (const ReferenceRecord& record : all_.region.solvers) {
      ++rank;
      if (!known.insert(record.solver).second || !Takes(FindSolver(record.solver), problem)) continue;
      untried.push_back({record.solver, rank, record.within});
    }
    for (const SolverEntry& entry : AllSolvers()) {
      const bool is_ours = entry.origin == SolverOrigin::kOwn && entry.base.empty() && Takes(entry, problem);
      if (is_ours && known.insert(entry.key).second) untried.push_back({entry.key, 0, 0});
    }
    return untried;
  }

  Recommendation all_;
  std::set<std::string> tried_;
};

}  // namespace

void AddRecommendCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Recommend>(
      app, run, "recommend",
      "Measures the backends that are worth trying on a problem, a scene or a sequence, and names the best");
}

}  // namespace lcpbench
