#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/solver_options.h"
#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"
#include "benchmarks/recommend/recommendation.h"
#include "benchmarks/recommend/rules.h"
#include "build_info.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct RecommendArguments {
  std::vector<std::string> files;
  std::string scene;
  int size = 100;
  std::uint64_t seed = 1;
  int steps = 1;
  std::string deadline;
  double tolerance = 1e-6;
  std::vector<std::string> candidates;
  bool peers = false;
  std::string rules;
  int rounds = 5;
  int cpu = -1;
  bool json = false;
  bool features = false;
};

constexpr const char* kAllCandidates = "all";

// "0.001", "1ms", "100us", "16.7 ms"
double ParseDuration(const std::string& option, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' ') == std::string::npos ? unit.size() : unit.find_first_not_of(' '));
  double units = 0;  // of a second: dividing rounds once, and 100us is 1e-4
  if (unit.empty() || unit == "s") units = 1;
  if (unit == "ms") units = 1e3;
  if (unit == "us" || unit == "µs") units = 1e6;
  if (error != std::errc() || !(value > 0) || !std::isfinite(value) || units == 0) {
    throw InputError(option + ": expected a time > 0 in seconds, or with us, ms or s, found '" + text + "'");
  }
  return value / units;
}

std::string RulesFile(const RecommendArguments& arguments) {
  if (!arguments.rules.empty()) return arguments.rules;
  for (const std::string& folder : {std::string("data"), std::string(kDataFolder)}) {
    std::string path = folder + "/recommendation.json";
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError(std::string("data/recommendation.json: not there, nor in ") + kDataFolder);
}

void RequireValid(const RecommendArguments& arguments) {
  if (!(arguments.tolerance > 0 && arguments.tolerance < 1)) {
    throw InputError("--tolerance: expected a number in (0, 1)");
  }
  if (arguments.rounds < 1) throw InputError("--rounds: expected a number >= 1");
  const size_t inputs = arguments.files.size() + (arguments.scene.empty() ? 0 : 1);
  if (!arguments.features && inputs != 1) {
    throw InputError("recommend: expected one FILE or --scene, found " + std::to_string(inputs));
  }
}

ProblemSteps StepsOf(const RecommendArguments& arguments) {
  if (arguments.scene.empty()) return ReadProblemSteps(arguments.files.front());
  return MakeProblemSteps(arguments.scene, arguments.size, arguments.seed, arguments.steps);
}

bool Contains(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

// Of a name the solver it stands for, so that none is tried twice.
std::vector<std::string> Candidates(const RecommendArguments& arguments, const RecommendationRegion& region,
                                    Index rows) {
  std::vector<std::string> keys;
  const auto add = [&keys](const std::string& key) {
    if (!Contains(keys, key)) keys.push_back(key);
  };
  const bool by_rules = arguments.candidates.empty();
  const bool all = arguments.candidates == std::vector<std::string>{kAllCandidates};
  if (by_rules || all) {
    for (const std::string& key : region.candidates) {
      if (FindSolver(key).available) add(key);
    }
  }
  if (all) {
    for (const SolverEntry& entry : AllSolvers()) {
      const bool fits = entry.origin == SolverOrigin::kOwn && SizeRefusal(entry, rows).empty();
      if (entry.available && fits) add(entry.key);
    }
  } else if (!by_rules) {
    for (const std::string& key : arguments.candidates) {
      const SolverEntry& entry = FindSolver(key);
      if (!entry.available) throw InputError("--candidates: solver '" + key + "' is not in this build");
      add(entry.key);
    }
  }
  if (arguments.peers) {
    for (const std::string& key : region.peers) {
      const SolverEntry& entry = FindSolver(key);
      if (entry.available && SizeRefusal(entry, rows).empty()) add(key);
    }
  }
  if (keys.empty()) throw InputError("recommend: none of the candidates of the rules is in this build");
  return keys;
}

std::vector<UntriedSolver> Untried(const std::vector<std::string>& tried, const RecommendationRegion& region) {
  std::vector<UntriedSolver> untried;
  int rank = 0;
  std::vector<std::string> ranked;
  for (const ReferenceRecord& record : region.solvers) {
    ++rank;
    ranked.push_back(record.solver);
    if (!Contains(tried, record.solver)) untried.push_back({record.solver, rank, record.within});
  }
  for (const SolverEntry& entry : AllSolvers()) {
    const bool is_ours = entry.origin == SolverOrigin::kOwn && entry.available && entry.base.empty();
    if (is_ours && !Contains(ranked, entry.key) && !Contains(tried, entry.key)) untried.push_back({entry.key, 0, 0});
  }
  return untried;
}

int Recommend(const RecommendArguments& arguments, std::vector<std::string> solver_arguments) {
  RequireValid(arguments);
  Recommendation all;
  all.request.tolerance = arguments.tolerance;
  if (!arguments.deadline.empty()) all.request.deadline_s = ParseDuration("--deadline", arguments.deadline);
  const RecommendationRules rules = ReadRecommendationRules(RulesFile(arguments));
  const ProblemSteps steps = StepsOf(arguments);

  const auto by_rows = [](const SequenceStep& a, const SequenceStep& b) { return a.problem.size() < b.problem.size(); };
  const auto [smallest, largest] = std::minmax_element(steps.steps.begin(), steps.steps.end(), by_rows);
  all.input = steps.name;
  all.problems = static_cast<int>(steps.steps.size());
  all.least_rows = static_cast<double>(smallest->problem.size());
  all.most_rows = static_cast<double>(largest->problem.size());
  all.rows_are_known = steps.rows_are_known;
  all.request.by_tail = all.problems > 1;
  all.features = MeasureFeatures(largest->problem);
  all.rules_file = rules.file;
  all.made_of = rules.made_of;
  all.region = FindRegion(rules, all.features, arguments.tolerance);

  MeasurementPlan plan;
  plan.solvers = Candidates(arguments, all.region, largest->problem.size());
  plan.tolerance = arguments.tolerance;
  plan.rounds = arguments.rounds;
  plan.cpu = arguments.cpu;
  plan.solver_arguments = std::move(solver_arguments);
  const std::vector<Measurement> measurements = MeasureSolvers(plan, steps);
  all.rounds = plan.rounds;
  all.samples = static_cast<int>(measurements.front().latency_s.size());
  all.ranked = RankMeasurements(measurements, all.request);
  all.untried = Untried(plan.solvers, all.region);
  if (arguments.json) {
    std::cout << DescribeRecommendation(all).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << std::endl;
  } else {
    std::cout << FormatRecommendation(all) << std::flush;
  }
  return 0;
}

// What report/report.py recommendation makes rules of: the same numbers as the command looks them up by.
int PrintFeatures(const RecommendArguments& arguments) {
  if (arguments.files.empty()) throw InputError("--features: expected one FILE or more");
  return ForEachProblem(arguments.files, [](const LcpRecord& record) {
    nlohmann::ordered_json line = {{"problem", record.problem.id()}};
    line.update(Describe(MeasureFeatures(record.problem)));
    std::cout << line.dump() << std::endl;
  });
}

}  // namespace

void AddRecommendCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<RecommendArguments>();
  CLI::App* recommend = app.add_subcommand(
      "recommend",
      "Measures the backends that are worth trying on a problem, a scene or a sequence, and names the best");
  recommend->add_option("FILE", arguments->files,
                        "Problem file of any format, or a sequence as JSON lines; - for standard input");
  recommend->add_option("--scene", arguments->scene,
                        "Instead of a file: scene key (lcpbench list scenes), or a scene file (.json)");
  recommend->add_option("--size", arguments->size, "Of the scene: number of rows n");
  recommend->add_option("--seed", arguments->seed, "Of the scene");
  recommend->add_option("--steps", arguments->steps, "Of the scene: let it move for so many steps; 1: an instant");
  recommend->add_option("--deadline", arguments->deadline,
                        "Of a step's set-up and solve, met at the 99th percentile: seconds, or 500us, 16ms");
  recommend->add_option("--tolerance", arguments->tolerance, "Bound on rho, the scaled natural residual");
  recommend
      ->add_option("--candidates", arguments->candidates,
                   "Solver keys, or all: all own solvers [default: those that the rules name]")
      ->delimiter(',');
  recommend->add_flag("--peers", arguments->peers, "Also try the peers that were fast in the reference");
  recommend->add_option("--rules", arguments->rules,
                        "Written by report/report.py recommendation [default: data/recommendation.json]");
  recommend->add_option("--rounds", arguments->rounds, "How often every candidate is run");
  recommend->add_option("--cpu", arguments->cpu, "The processor that solves are kept on");
  recommend->add_flag("--json", arguments->json, "All of it as one JSON object");
  recommend->add_flag("--features", arguments->features, "Only print the features of all problems, as JSON lines");
  const auto named = AddNamedSolverOptions(*recommend);
  recommend->footer("Exit status 0 also where nothing meets the request; the answer then says so.");
  recommend->callback([arguments, named, &run] {
    run = [arguments, named] {
      named->Register();
      return arguments->features ? PrintFeatures(*arguments) : Recommend(*arguments, named->Words());
    };
  });
}

}  // namespace lcpbench
