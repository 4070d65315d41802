#include "benchmarks/suite.h"

#include <algorithm>
#include <array>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

// Dense pivoting stores n^2 doubles and does O(n^3) work: above this size one solve takes longer than any limit here.
constexpr int kDenseLargest = 5000;

std::vector<std::string> EveryScene() {
  std::vector<std::string> keys;
  for (const SceneFamily& scene : AllScenes()) keys.emplace_back(scene.key);
  return keys;
}

std::vector<std::string> EverySolver() {
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) keys.emplace_back(entry.key);
  return keys;
}

}  // namespace

Suite FindSuite(std::string_view name) {
  Suite suite;
  suite.name = std::string(name);
  suite.families = EveryScene();
  suite.solvers = EverySolver();
  suite.tiers = {1e-3, 1e-6, 1e-9};
  if (name == "default") {
    suite.sizes = {10, 30, 100, 300, 1000, 3000};
    suite.seeds = {1, 2, 3};
    return suite;
  }
  if (name == "quick") {
    suite.sizes = {10, 30, 100};
    suite.seeds = {1};
    suite.time_limit_s = 0.5;
    suite.min_time_s = 0.01;
    suite.repetitions = 1;
    return suite;
  }
  throw InputError("unknown suite '" + std::string(name) + "', expected one of default, quick");
}

void ValidateSuite(const Suite& suite) {
  for (const std::string& family : suite.families) FindScene(family);
  for (const std::string& solver : suite.solvers) FindSolver(solver);
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw InputError(what);
  };
  require(!suite.families.empty(), "a suite needs at least one scene");
  require(!suite.solvers.empty(), "a suite needs at least one solver");
  require(!suite.sizes.empty(), "a suite needs at least one size");
  require(!suite.seeds.empty(), "a suite needs at least one seed");
  require(!suite.tiers.empty(), "a suite needs at least one tier");
  for (const int size : suite.sizes) require(size >= 1, "size must be >= 1, found " + std::to_string(size));
  for (const double tier : suite.tiers) {
    require(tier > 0 && tier < 1, "tier must be in (0, 1), found " + std::to_string(tier));
  }
  require(suite.time_limit_s > 0, "time limit must be > 0 s, found " + std::to_string(suite.time_limit_s));
  require(suite.min_time_s > 0, "time per repetition must be > 0 s, found " + std::to_string(suite.min_time_s));
  require(suite.repetitions >= 1, "repetitions must be >= 1, found " + std::to_string(suite.repetitions));
}

std::vector<SuiteProblem> ProblemsOf(const Suite& suite) {
  std::vector<SuiteProblem> problems;
  for (const std::string& family : suite.families) {
    for (const int size : suite.sizes) {
      for (const std::uint64_t seed : suite.seeds) {
        problems.push_back({family + "-n" + std::to_string(size) + "-s" + std::to_string(seed), family, size, seed});
      }
    }
  }
  return problems;
}

std::string ExclusionRule(const SolverEntry& solver, int size, double /*tier*/) {
  if (!solver.available) return "not in this build";
  if (solver.key == "dantzig" && size > kDenseLargest) {
    return "dense solver above n = " + std::to_string(kDenseLargest);
  }
  return {};
}

std::vector<double> TiersToRun(const Suite& suite, const SolverEntry& solver) {
  if (solver.uses_tolerance) return suite.tiers;
  return {*std::min_element(suite.tiers.begin(), suite.tiers.end())};
}

}  // namespace lcpbench
