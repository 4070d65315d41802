#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// One cell of a campaign's sequences: a solver's pass over a sequence at a tier, in a mode:
///   cold             every step from f = 0
///   warm             every step from the solver's own answer to the one before, rows that are new from 0
///   deadline-0.1ms   warm at the strictest tier, every step within the deadline; judged at all tiers
/// A solver whose settings do not depend on the tolerance has one pass, at the strictest tier, judged at all of them.
struct PlannedPass {
  std::size_t manifest = 0;  ///< index into the plan's
  std::size_t entry = 0;     ///< index into the manifest's sequences
  std::string solver;
  double tier = 0;             ///< asked for
  std::vector<double> judged;  ///< loosest first
  std::string mode;
  bool warm = false;
  double deadline_s = 0;  ///< 0: none
  std::string excluded;   ///< the rule by which it is not run; "" for none
};

/// "steps/<sequence>/<solver>/<tier>/<mode>", what the plan's filter is compared with.
std::string PassName(const std::string& sequence, const std::string& solver, double tier, const std::string& mode);

/// "deadline-16ms"
std::string DeadlineMode(double deadline_s);

/// All passes of a plan by sequence and solver, tiers loosest first. Solvers that are not in the build have none.
std::vector<PlannedPass> PlanPasses(const CampaignPlan& plan, const std::vector<Manifest>& manifests);

/// The order of a round: all passes of a sequence and solver together, shuffled as OrderOfRound shuffles cells.
std::vector<std::size_t> OrderOfRound(const std::vector<PlannedPass>& passes, std::uint64_t seed, int round);

}  // namespace lcpbench
