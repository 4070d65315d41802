#include "benchmarks/campaign/campaign_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <regex>
#include <utility>

#include "benchmarks/exclusion_rules.h"
#include "model/scenes/random.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

double TimeLimitOf(const CampaignPlan& plan, Index rows) {
  return std::clamp(plan.time_per_row_s * static_cast<double>(rows), plan.least_s, plan.most_s);
}

bool SameGroup(const PlannedCell& a, const PlannedCell& b) {
  return a.manifest == b.manifest && a.entry == b.entry && a.solver == b.solver;
}

// FNV-1a, of 64 bits.
std::uint64_t Hash(const std::string& text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

}  // namespace

double DisturbanceOf(const NoiseRule& rule, const Disturbance& found, double fast_probe_s) {
  const double slower = found.probe_s / fast_probe_s - 1;
  const double waiting = 1 - found.cpu_share;
  if (slower <= rule.slower_clock && found.cpu_share >= rule.least_cpu_share) return 0;
  return std::max(slower, 0.0) + waiting;
}

std::string CellName(const std::string& problem, const std::string& solver, double tier, const std::string& mode) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tier);
  return "solve/" + problem + "/" + solver + "/" + text + (mode == kColdStart ? "" : "/" + mode);
}

void RequireValid(const CampaignPlan& plan) {
  const auto require = [](bool holds, const std::string& expected) {
    if (!holds) throw InputError("campaign: expected " + expected);
  };
  for (const std::string& solver : plan.solvers) FindSolver(solver);
  require(!plan.manifests.empty(), "at least one manifest");
  require(!plan.solvers.empty(), "at least one solver");
  require(!plan.tiers.empty(), "at least one tier");
  for (const double tier : plan.tiers) require(tier > 0 && tier < 1, "tiers in (0, 1)");
  require(!plan.modes.empty(), "at least one mode");
  for (const std::string& mode : plan.modes) {
    require(mode == kColdStart || mode == kColdCache,
            std::string("modes ") + kColdStart + " or " + kColdCache + ", found '" + mode + "'");
    require(std::count(plan.modes.begin(), plan.modes.end(), mode) == 1, "every mode once");
  }
  require(plan.noise.slower_clock > 0 && plan.noise.least_cpu_share < 1 && plan.noise.most_reruns >= 0,
          "a rule for noise that some cells pass");
  require(plan.rounds >= 1 && plan.most_rounds >= plan.rounds, "rounds >= 1, and no fewer at most");
  require(plan.tight > 0, "a relative width > 0");
  require(plan.repetitions >= 1, "repetitions >= 1");
  require(plan.min_time_s > 0 && plan.budget_s > 0 && plan.cell_budget_s > 0, "times > 0 s");
  require(plan.time_per_row_s >= 0 && plan.least_s > 0 && plan.most_s >= plan.least_s, "time limits > 0 s, in order");
  for (const double deadline : plan.deadlines_s) require(deadline > 0, "deadlines > 0 s");
  require(plan.pass_budget_s > 0, "a pass's budget > 0 s");
  try {
    const std::regex filter(plan.filter);
  } catch (const std::regex_error&) {
    throw InputError("campaign: expected a regular expression, found '" + plan.filter + "'");
  }
}

std::vector<PlannedCell> PlanCells(const CampaignPlan& plan, const std::vector<Manifest>& manifests) {
  const std::regex filter(plan.filter);
  std::vector<double> loosest_first = plan.tiers;
  std::sort(loosest_first.begin(), loosest_first.end(), std::greater<>());
  std::vector<PlannedCell> cells;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    const std::vector<ManifestEntry>& problems = manifests[m].problems;
    for (std::size_t k = 0; k < problems.size(); ++k) {
      for (const std::string& key : plan.solvers) {
        const SolverEntry& solver = FindSolver(key);
        if (!solver.available) continue;
        const auto tiers = solver.uses_tolerance ? loosest_first : std::vector<double>{loosest_first.back()};
        for (const double tier : tiers) {
          for (const std::string& mode : plan.modes) {
            const std::string name = CellName(problems[k].id, solver.key, tier, mode);
            if (!plan.filter.empty() && !std::regex_search(name, filter)) continue;
            const Index rows = problems[k].properties.rows;
            cells.push_back({m, k, solver.key, mode, tier, TimeLimitOf(plan, rows), SizeRefusal(solver, rows)});
          }
        }
      }
    }
  }
  return cells;
}

std::vector<double> TiersOfRun(const CampaignPlan& plan, const PlannedCell& cell) {
  if (FindSolver(cell.solver).uses_tolerance) return {cell.tier};
  return plan.tiers;
}

std::vector<std::size_t> ShuffleGroups(const std::vector<std::size_t>& group_of_cell, std::uint64_t seed, int round) {
  std::vector<std::pair<std::size_t, std::size_t>> groups;  // first cell, count
  for (std::size_t k = 0; k < group_of_cell.size(); ++k) {
    if (k > 0 && group_of_cell[k] == group_of_cell[k - 1]) {
      ++groups.back().second;
    } else {
      groups.emplace_back(k, 1);
    }
  }
  constexpr std::uint64_t kRoundStep = 1'000'003;
  Random random(seed + kRoundStep * static_cast<std::uint64_t>(round));
  for (std::size_t k = groups.size(); k > 1; --k) {
    std::swap(groups[k - 1], groups[static_cast<std::size_t>(random.Integer(static_cast<int>(k)))]);
  }
  std::vector<std::size_t> order;
  order.reserve(group_of_cell.size());
  for (const auto& [first, count] : groups) {
    for (std::size_t k = first; k < first + count; ++k) order.push_back(k);
  }
  return order;
}

std::vector<std::size_t> OrderOfRound(const std::vector<PlannedCell>& cells, std::uint64_t seed, int round) {
  std::vector<std::size_t> groups(cells.size(), 0);
  for (std::size_t k = 1; k < cells.size(); ++k) {
    groups[k] = groups[k - 1] + (SameGroup(cells[k], cells[k - 1]) ? 0 : 1);
  }
  return ShuffleGroups(groups, seed, round);
}

bool IsInShard(const std::string& problem, const std::string& solver, int k, int n) {
  return Hash(problem + "|" + solver) % static_cast<std::uint64_t>(n) == static_cast<std::uint64_t>(k - 1);
}

}  // namespace lcpbench
