// Times warm starts against cold ones: the same problem with and without LcpOptions::initial_f from the answer to a
// problem that differs a little. Kinds of change: masses and loads drifted by 1 % and by 0.1 %, 0.5 % of the contacts
// lost and others gained (drift.h), and the next time step of a motion, its rows matched.
//
// Every solver starts from its own answer to the problem before. Warm and cold solves alternate in one process on one
// prepared solver, and the least time of each counts; where either answer is not verified, the case has no ratio.
// --with-setup counts the set-up as well: a cold solve has a new solver, a warm one that of the problem before, which
// may keep what it knows of the graph. The tables have for every solver and number of rows the median and the worst of
// warm / cold over all scene families, seeds or pairs, and how many warm answers are verified.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/drift.h"
#include "benchmarks/solver_study.h"
#include "model/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

// A measurement repeats short solves for this long [s], and is itself repeated, but no longer than the budget [s].
constexpr double kLeastMeasured = 50e-6;
constexpr int kRounds = 9;
constexpr double kBudget = 0.4;
constexpr int kFirstPairSpacing = 25;
// Dense pivoting takes minutes at this tolerance of nobody's patience; as in the suite's rules, and per solve [s].
// Sparse methods need their time in proportion to the rows.
constexpr double kLeastTimeLimit = 2;
constexpr double kTimeLimitPerRow = 0.6e-3;
constexpr double kTightTolerance = 1e-9;

struct Arguments {
  std::vector<std::string> solvers;
  std::vector<std::string> scenes;
  std::vector<int> sizes = {10, 30, 100, 300, 1000};
  std::vector<double> drifts = {0.01, 0.001};
  std::vector<double> lost = {0.005};
  bool with_setup = false;
  int seeds = 3;
  int pairs = 3;
  double tolerance = 1e-9;
  bool verbose = false;
};

// A problem, and the answer to the one before by its rows.
struct Case {
  std::string kind;
  std::string scene;
  int size;
  LcpProblem before;
  LcpProblem after;
  std::vector<int> row_before;  // empty: the same rows
};

struct Statistics {
  std::vector<double> ratios;
  int verified = 0;
  int all = 0;
};

double Seconds(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options, int solves, LcpResult* result) {
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < solves; ++k) solver->Solve(problem, options, result);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / solves;
}

// Set-up and solve, on a copy without derived forms; `before` is what the solver knows already, nullptr: nothing.
double SecondsWithSetup(const SolverEntry& entry, const LcpProblem* before, const LcpProblem& problem,
                        const LcpOptions& options, LcpResult* result) {
  const LcpProblem copy = problem.CopyOfGivenForm();
  const std::unique_ptr<LcpSolver> solver = entry.make({});
  solver->SetInSequence(true);
  if (before != nullptr) solver->Prepare(*before);
  const auto start = std::chrono::steady_clock::now();
  solver->Prepare(copy);
  solver->Solve(copy, options, result);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Eigen::VectorXd MatchedStart(const Case& item, const Eigen::VectorXd& f) {
  if (item.row_before.empty()) return f;
  Eigen::VectorXd start = Eigen::VectorXd::Zero(item.after.size());
  for (size_t i = 0; i < item.row_before.size(); ++i) {
    if (item.row_before[i] >= 0) start[static_cast<Index>(i)] = f[item.row_before[i]];
  }
  return start;
}

void Measure(const SolverEntry& entry, const Case& item, const Arguments& arguments, Statistics* statistics) {
  LcpOptions options;
  options.tolerance = kTightTolerance;
  options.time_limit_s = std::max(kLeastTimeLimit, kTimeLimitPerRow * static_cast<double>(item.after.size()));
  LcpResult before;
  entry.make({})->Solve(item.before, options, &before);
  if (!before.f.allFinite()) return;
  const Eigen::VectorXd start = MatchedStart(item, before.f);

  options.tolerance = arguments.tolerance;
  LcpOptions warm_options = options;
  warm_options.initial_f = &start;
  const std::unique_ptr<LcpSolver> solver = entry.make({});
  if (!arguments.with_setup) solver->Prepare(item.after);
  LcpResult cold;
  LcpResult warm;
  const auto time_cold = [&](int solves) {
    return arguments.with_setup ? SecondsWithSetup(entry, nullptr, item.after, options, &cold)
                                : Seconds(solver.get(), item.after, options, solves, &cold);
  };
  const auto time_warm = [&](int solves) {
    return arguments.with_setup ? SecondsWithSetup(entry, &item.before, item.after, warm_options, &warm)
                                : Seconds(solver.get(), item.after, warm_options, solves, &warm);
  };
  double cold_s = time_cold(1);
  double warm_s = time_warm(1);
  const bool cold_passes = Verify(item.after, cold, arguments.tolerance).passes;
  const bool warm_passes = Verify(item.after, warm, arguments.tolerance).passes;
  ++statistics->all;
  if (warm_passes) ++statistics->verified;
  if (cold_passes && warm_passes) {
    const double rounds = std::min<double>(kRounds, kBudget / (cold_s + warm_s));
    for (int round = 0; round < rounds; ++round) {
      const auto solves = [](double once) { return std::max(1, static_cast<int>(kLeastMeasured / once)); };
      cold_s = std::min(cold_s, time_cold(solves(cold_s)));
      warm_s = std::min(warm_s, time_warm(solves(warm_s)));
    }
    statistics->ratios.push_back(warm_s / cold_s);
  }
  if (arguments.verbose) {
    std::printf("%-18s %-8s %-16s n %5d  cold %10.2f us %5lld %s  warm %10.2f us %5lld %s  ratio %.2f\n",
                entry.key.c_str(), item.kind.c_str(), item.scene.c_str(), static_cast<int>(item.after.size()),
                1e6 * cold_s, static_cast<long long>(cold.iterations), cold_passes ? "ok" : "FAILED", 1e6 * warm_s,
                static_cast<long long>(warm.iterations), warm_passes ? "ok" : "FAILED", warm_s / cold_s);
    std::fflush(stdout);
  }
}

std::string Percent(double part) {
  char text[32];
  std::snprintf(text, sizeof text, "%g %%", 100 * part);
  return text;
}

std::vector<Case> CasesOf(const std::string& scene, int size, const Arguments& arguments) {
  std::vector<Case> cases;
  if (!arguments.drifts.empty() || !arguments.lost.empty()) {
    const LcpProblem given = AssembleContactLcp(GenerateScene(scene, size, 1)).problem;
    for (const double part : arguments.lost) {
      for (int seed = 1; seed <= arguments.seeds; ++seed) {
        ConsecutiveProblems pair = LoseContacts(given, part, static_cast<std::uint64_t>(seed));
        cases.push_back({Percent(part) + " lost", scene, size, std::move(pair.before), std::move(pair.after),
                         std::move(pair.row_before)});
      }
    }
    for (const double drift : arguments.drifts) {
      for (int seed = 1; seed <= arguments.seeds; ++seed) {
        cases.push_back(
            {Percent(drift), scene, size, given, Drift(given, drift, static_cast<std::uint64_t>(seed)), {}});
      }
    }
  }
  if (arguments.pairs == 0) return cases;
  for (ConsecutiveProblems& pair : PairsOfMotion(scene, size, 1, arguments.pairs, kFirstPairSpacing)) {
    cases.push_back({"motion", scene, size, std::move(pair.before), std::move(pair.after), std::move(pair.row_before)});
  }
  return cases;
}

using Table = std::map<std::string, std::map<std::pair<std::string, int>, Statistics>>;  // by kind, solver and size

void PrintTables(const Table& table, const std::vector<std::string>& solvers, const std::vector<int>& sizes) {
  for (const auto& [kind, cells] : table) {
    std::printf("\nwarm / cold, %s: median (worst) verified of all\n%-18s", kind.c_str(), "solver");
    for (const int size : sizes) std::printf("  %20s", ("n = " + std::to_string(size)).c_str());
    std::printf("\n");
    for (const std::string& solver : solvers) {
      std::printf("%-18s", solver.c_str());
      for (const int size : sizes) {
        const auto found = cells.find({solver, size});
        if (found == cells.end()) {
          std::printf("  %20s", "-");
          continue;
        }
        std::vector<double> ratios = found->second.ratios;
        std::sort(ratios.begin(), ratios.end());
        const double median = ratios.empty() ? NAN : ratios[ratios.size() / 2];
        const double worst = ratios.empty() ? NAN : ratios.back();
        std::printf("  %5.2f (%5.2f) %3d/%-3d", median, worst, found->second.verified, found->second.all);
      }
      std::printf("\n");
    }
  }
}

void Run(Arguments arguments) {
  if (arguments.solvers.empty()) arguments.solvers = AvailableOwnSolvers();
  if (arguments.scenes.empty()) {
    for (const SceneFamily& scene : AllScenes()) arguments.scenes.emplace_back(scene.key);
  }
  Table table;
  for (const int size : arguments.sizes) {
    for (const std::string& scene : arguments.scenes) {
      std::fprintf(stderr, "n = %d: %s          \r", size, scene.c_str());
      for (const Case& item : CasesOf(scene, size, arguments)) {
        for (const std::string& solver : arguments.solvers) {
          Measure(FindSolver(solver), item, arguments, &table[item.kind][{solver, size}]);
        }
      }
    }
  }
  PrintTables(table, arguments.solvers, arguments.sizes);
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  lcpbench::Arguments arguments;
  CLI::App app("Times warm starts against cold ones");
  app.add_option("--solvers", arguments.solvers, "Solver keys [default: all own]")->delimiter(',');
  app.add_option("--scenes", arguments.scenes, "Scene keys [default: all]")->delimiter(',');
  app.add_option("--sizes", arguments.sizes, "Numbers of rows")->delimiter(',')->capture_default_str();
  app.add_option("--drifts", arguments.drifts, "Relative drifts")->delimiter(',')->capture_default_str();
  app.add_option("--lost", arguments.lost, "Parts of the contacts that go, and come")
      ->delimiter(',')
      ->capture_default_str();
  app.add_flag("--with-setup", arguments.with_setup, "Time the set-up as well");
  app.add_option("--seeds", arguments.seeds, "Drifted problems per scene")->capture_default_str();
  app.add_option("--pairs", arguments.pairs, "Pairs of consecutive time steps per scene")->capture_default_str();
  app.add_option("--tolerance", arguments.tolerance, "Bound on rho")->capture_default_str();
  app.add_flag("--verbose", arguments.verbose, "Print every case");
  return lcpbench::RunStudy(&app, argc, argv, [&] { lcpbench::Run(arguments); });
}
