#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/campaign/cell.h"
#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// When a cell counts as disturbed by the machine. It is run again then, and keeps the run that was disturbed least.
struct NoiseRule {
  double slower_clock = 0.1;      ///< the probe of the clock rate took this much longer than Journal::FastProbe
  double least_cpu_share = 0.95;  ///< less processor time than this share of the wall-clock time
  int most_reruns = 2;
};

/// Whether it is, and by how much: 0 undisturbed, more is worse.
double DisturbanceOf(const NoiseRule& rule, const Disturbance& found, double fast_probe_s);

/// Where settings that a campaign runs besides the defaults were found (tuned_file.h).
struct TuningSource {
  std::string file;  ///< name, without its folder; "" where there is none
  std::string sha256;
  int budget = 0;  ///< configurations that were tried of a solver, at most
};

/// What a campaign consists of, fixed before its first solve.
struct CampaignPlan {
  std::string name;
  std::vector<std::string> manifests;  ///< paths
  std::vector<std::string> solvers;    ///< registry keys
  std::vector<double> tiers = {1e-3, 1e-6, 1e-9};
  std::vector<std::string> modes = {kColdStart};  ///< of cell.h
  std::string filter;      ///< regular expression that a cell's name must contain, CellName; "" for all
  std::uint64_t seed = 1;  ///< of the order
  int rounds = 6;          ///< every cell is visited so often, each time in another order
  int most_rounds = 8;     ///< and so often at most, while its time is not known to `tight`
  double tight = 0.05;     ///< relative half width of the time's 95 % interval (median_interval.h)
  int repetitions = 5;     ///< of a round, at most
  double min_time_s = 0.0005;
  double budget_s = 0.03;      ///< of a cell and round: no further repetition is begun after it
  double cell_budget_s = 0.2;  ///< of a cell: it gets no further round once its repetitions took so long in all
  // A solve may take time_per_row_s times its rows, within [least_s, most_s].
  double time_per_row_s = 1e-3;
  double least_s = 0.2;
  double most_s = 2;
  std::uint64_t memory_bytes = std::uint64_t{8} << 30U;  ///< address space of a solve
  NoiseRule noise;
  // Of the manifests' sequences (sequence_plan.h).
  std::vector<double> deadlines_s = {0.1e-3, 1e-3, 16e-3};  ///< of a step
  double pass_budget_s = 20;  ///< of a pass over a sequence: no further step is begun after it
  TuningSource tuning;
};

/// One cell. A solver whose settings do not depend on the tolerance has one, at the strictest tier, for all.
struct PlannedCell {
  std::size_t manifest = 0;  ///< index into the plan's
  std::size_t entry = 0;     ///< index into the manifest's problems
  std::string solver;
  std::string mode;
  double tier = 0;
  double time_limit_s = 0;
  std::string excluded;  ///< the rule by which it is not run; "" for none
};

/// "solve/<problem>/<solver>/<tier>", and "/<mode>" where it is not cold
std::string CellName(const std::string& problem, const std::string& solver, double tier, const std::string& mode);

/// All cells of a plan by problem and solver, tiers loosest first. Solvers that are not in the build have none.
std::vector<PlannedCell> PlanCells(const CampaignPlan& plan, const std::vector<Manifest>& manifests);

/// The tiers that one run of a cell's solver is judged at, a line of results each: the cell's, or all where the
/// solver's settings do not depend on the tolerance.
std::vector<double> TiersOfRun(const CampaignPlan& plan, const PlannedCell& cell);

/// Indices of cells, those of one group (equal numbers, side by side) together and in order, the groups shuffled by the
/// seed and the round. The same on every machine.
std::vector<std::size_t> ShuffleGroups(const std::vector<std::size_t>& group_of_cell, std::uint64_t seed, int round);

/// The order of a round: all cells of a problem and solver together, these groups shuffled by the plan's seed and the
/// round.
std::vector<std::size_t> OrderOfRound(const std::vector<PlannedCell>& cells, std::uint64_t seed, int round);

/// Whether a cell is in shard k of n (k from 1): by a hash of problem and solver, so that shards do not depend on the
/// order, and a problem's cells of one solver stay together.
bool IsInShard(const std::string& problem, const std::string& solver, int k, int n);

/// "" where the plan can be run. @throws InputError naming what cannot
void RequireValid(const CampaignPlan& plan);

}  // namespace lcpbench
