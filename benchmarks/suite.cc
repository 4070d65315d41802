#include "benchmarks/suite.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

// Which solver is given how much is settled here, before any run: by what its method costs, not by how it fares.
constexpr std::string_view kDensePivoting = "dense pivoting, O(n^3) and n^2 numbers";
constexpr std::string_view kDenseMatrix = "works on the dense matrix, n^2 numbers";
constexpr std::array kSizeLimits{
    SizeLimit{"dantzig", 5000, kDensePivoting},
    SizeLimit{"lemke", 2000, kDensePivoting},
    SizeLimit{"bullet-dantzig", 1000, kDensePivoting},
    SizeLimit{"bullet-lemke", 300, "dense tableau, O(n^2) a pivot"},
    SizeLimit{"ode", 1000, kDensePivoting},
    SizeLimit{"dart", 1000, kDenseMatrix},
    SizeLimit{"siconos-lexicolemke", 300, kDensePivoting},
    SizeLimit{"siconos-avi", 300, kDensePivoting},
    SizeLimit{"siconos-newton-fb", 300, kDenseMatrix},
    SizeLimit{"siconos-pgs", 300, kDenseMatrix},
    SizeLimit{"cgal-qp", 30, "exact rational arithmetic"},
    SizeLimit{"clp", 1000, "reduced gradients without a limit of their own"},
};

// Is `solver` the key itself or a variant of it?
bool Names(std::string_view key, std::string_view solver) {
  return solver.starts_with(key) && (solver.size() == key.size() || solver[key.size()] == '-');
}

const SizeRule* RuleFor(const Suite& suite, int size) {
  const SizeRule* found = nullptr;
  for (const SizeRule& rule : suite.size_rules) {
    if (size > rule.above) found = &rule;
  }
  return found;
}

template <typename Value>
bool Contains(const std::vector<Value>& values, const Value& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

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
    suite.sizes = {10, 30, 100, 300, 1000, 10'000};
    suite.seeds = {1, 2, 3};
    // Ten minutes for everything: many problems where they are cheap. What goes on above 300 rows is redundant
    // (discs-in-v, boxes-and-discs, roller-bearing) or not, with joints, with curved bodies, with mass ratios.
    suite.size_rules = {
        {30, 2, {}, {}},
        {100, 1, {}, {}},
        {300,
         1,
         {"discs-in-v", "disc-pile", "disc-track", "boxes-and-discs", "chain-of-links", "ovals-in-bowl",
          "roller-bearing", "tall-stacks"},
         {}},
        {1000, 1, {"discs-in-v", "disc-pile", "ovals-in-bowl", "tall-stacks"}, {1e-6}},
    };
    suite.time_limit_per_row_s = 1e-3;
    suite.min_time_s = 0.005;
    suite.repeat_below_s = 0.02;
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
  require(suite.time_limit_per_row_s >= 0, "time limit per row must be >= 0 s");
  for (const SizeRule& rule : suite.size_rules) require(rule.seeds >= 1, "a size needs at least one seed");
  require(suite.min_time_s > 0, "time per repetition must be > 0 s, found " + std::to_string(suite.min_time_s));
  require(suite.repetitions >= 1, "repetitions must be >= 1, found " + std::to_string(suite.repetitions));
}

std::vector<SuiteProblem> ProblemsOf(const Suite& suite) {
  std::vector<SuiteProblem> problems;
  for (const std::string& family : suite.families) {
    for (const int size : suite.sizes) {
      const SizeRule* rule = RuleFor(suite, size);
      if (rule != nullptr && !rule->families.empty() && !Contains(rule->families, family)) continue;
      std::size_t left = rule == nullptr ? suite.seeds.size() : rule->seeds;
      for (const std::uint64_t seed : suite.seeds) {
        if (left-- == 0) break;
        problems.push_back({family + "-n" + std::to_string(size) + "-s" + std::to_string(seed), family, size, seed});
      }
    }
  }
  return problems;
}

double TimeLimit(const Suite& suite, int size) {
  if (suite.time_limit_per_row_s <= 0) return suite.time_limit_s;
  return std::min(suite.time_limit_s, std::max(kLeastTimeLimit, suite.time_limit_per_row_s * size));
}

std::span<const SizeLimit> SizeLimits() { return kSizeLimits; }

std::string SizeRefusal(const SolverEntry& solver, Index size) {
  for (const SizeLimit& limit : kSizeLimits) {
    if (size > limit.largest && Names(limit.solver, solver.base.empty() ? solver.key : solver.base)) {
      return "not above n = " + std::to_string(limit.largest) + ": " + std::string(limit.reason);
    }
  }
  return {};
}

std::string ExclusionRule(const Suite& suite, const SolverEntry& solver, int size, double tier) {
  std::string refusal = SizeRefusal(solver, size);
  if (!refusal.empty()) return refusal;
  const SizeRule* rule = RuleFor(suite, size);
  // A direct method's one run is judged at every tier.
  if (rule != nullptr && !rule->tiers.empty() && solver.uses_tolerance && !Contains(rule->tiers, tier)) {
    return "tier not run above n = " + std::to_string(rule->above);
  }
  return {};
}

std::string OutOfTimeRule(double tier) {
  char text[64];
  std::snprintf(text, sizeof text, "out of time at the looser tier %.0e", tier);
  return text;
}

std::vector<double> TiersToRun(const Suite& suite, const SolverEntry& solver) {
  if (solver.uses_tolerance) {
    std::vector<double> loosest_first = suite.tiers;
    std::sort(loosest_first.begin(), loosest_first.end(), std::greater<>());
    return loosest_first;
  }
  return {*std::min_element(suite.tiers.begin(), suite.tiers.end())};
}

}  // namespace lcpbench
