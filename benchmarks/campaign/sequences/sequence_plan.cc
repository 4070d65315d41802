#include "benchmarks/campaign/sequences/sequence_plan.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <regex>
#include <utility>

#include "benchmarks/campaign/exclusion_rules.h"
#include "solvers/registry.h"

namespace lcpbench {

std::string PassName(const std::string& sequence, const std::string& solver, double tier, const std::string& mode) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tier);
  return "steps/" + sequence + "/" + solver + "/" + text + "/" + mode;
}

std::string DeadlineMode(double deadline_s) {
  constexpr double kMillisecond = 1e-3;
  char text[32];
  std::snprintf(text, sizeof text, "deadline-%gms", deadline_s / kMillisecond);
  return text;
}

std::vector<PlannedPass> PlanPasses(const CampaignPlan& plan, const std::vector<Manifest>& manifests) {
  const std::regex filter(plan.filter);
  std::vector<double> tiers = plan.tiers;
  std::sort(tiers.begin(), tiers.end(), std::greater<>());
  const double strictest = tiers.back();
  std::vector<PlannedPass> passes;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    for (std::size_t k = 0; k < manifests[m].sequences.size(); ++k) {
      const SequenceEntry& entry = manifests[m].sequences[k];
      for (const std::string& key : plan.solvers) {
        const SolverEntry& solver = FindSolver(key);
        if (!solver.available) continue;
        PlannedPass pass{m, k, solver.key, strictest, tiers, "", false, 0, SizeRefusal(solver, entry.most_rows)};
        const auto add = [&](const std::string& mode) {
          pass.mode = mode;
          if (plan.filter.empty() || std::regex_search(PassName(entry.id, pass.solver, pass.tier, mode), filter)) {
            passes.push_back(pass);
          }
        };
        for (const bool warm : {false, true}) {
          pass.warm = warm;
          for (const double tier : solver.uses_tolerance ? tiers : std::vector<double>{strictest}) {
            pass.tier = tier;
            if (solver.uses_tolerance) pass.judged = {tier};
            add(warm ? "warm" : "cold");
          }
        }
        pass.tier = strictest;
        pass.judged = tiers;
        for (const double deadline : plan.deadlines_s) {
          pass.deadline_s = deadline;
          add(DeadlineMode(deadline));
        }
      }
    }
  }
  return passes;
}

std::vector<std::size_t> OrderOfRound(const std::vector<PlannedPass>& passes, std::uint64_t seed, int round) {
  std::vector<std::size_t> groups(passes.size(), 0);
  for (std::size_t k = 1; k < passes.size(); ++k) {
    const bool same = passes[k].manifest == passes[k - 1].manifest && passes[k].entry == passes[k - 1].entry &&
                      passes[k].solver == passes[k - 1].solver;
    groups[k] = groups[k - 1] + (same ? 0 : 1);
  }
  return ShuffleGroups(groups, seed, round);
}

}  // namespace lcpbench
