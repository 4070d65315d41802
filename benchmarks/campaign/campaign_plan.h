#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/sealed.h"
#include "solvers/lcp/fresh_pass.h"
#include "solvers/registry.h"
#include "support/process_watch.h"

namespace lcpbench {

/// When a timed pass counts as disturbed by the machine. It is run again then, and keeps the run that was disturbed
/// least.
struct NoiseRule {
  double slower_clock = 0.1;      ///< the probe of the clock rate took this much longer than Journal::FastProbe
  double least_cpu_share = 0.95;  ///< less processor time than this share of the wall-clock time
  int most_reruns = 2;
};

/// Whether it is, and by how much: 0 undisturbed, more is worse.
double DisturbanceOf(const NoiseRule& rule, const Disturbance& found, double fast_probe_s);

/// Where settings that a campaign runs besides the defaults were found (command/run.cc).
struct TuningSource {
  std::string file = {};  ///< name, without its folder; "" where there is none
  std::string sha256 = {};
  int budget = 0;  ///< configurations that were tried of a solver, at most
};

/// What one solve may take: time_per_row_s times the most rows of its size class, within [least_s, most_s]. An answer
/// whose measured time is longer is out of time, of every solver alike; who reads no clock is stopped some time later.
struct SolveLimits {
  double time_per_row_s = 1e-3;
  double least_s = 0.05;
  double most_s = 10;
  /// A solver that has run out of time on so many problems of a size class, and on half of those that it was given, is
  /// not given the others of the class: they count as out of time. The order of a class is drawn (PlanProblems); above
  /// 10^4 rows it is that of the shard.
  std::size_t most_late = 4;
  /// A solver that has been judged for so long on a size class at a tier is not judged on the others of the class,
  /// which count neither for nor against it; codes of the portfolio are, for it takes all their turns [s].
  double class_s = 30;

  /// [s]
  double Of(Index rows) const {
    return std::clamp(time_per_row_s * static_cast<double>(SizeClassOf(rows).most), least_s, most_s);
  }
};

/// How often a campaign times a solver on a size class: each time by a launch, a process that warms up, meets every
/// problem once and ends. What differs between processes (where memory lies, what the machine does) is larger than what
/// differs within one, so the launches carry the intervals. After the first launches the solvers that are near the best
/// of a class go on by rounds: all of a class and tier one after the other, within a minute or so, so that what the
/// machine does for minutes is the same for all of a round. Rounds are spread over the campaign.
struct Launches {
  int near = 10;   ///< of every solver within `within` times of the best of the class; those after `others` by rounds
  int others = 2;  ///< launches of all solvers
  int repeats =
      3;  ///< further rounds of a class and tier, at most, for those with a launch that is off (Journal::IsOff)
  double within = 3;       ///< median times, failures infinite, after `others` launches, at any tier
  double right = 0.99;     ///< share of the weight that a solver must verify to count as the best, where one does
  double settle_s = 0.05;  ///< how long a launch may warm up until its times settle [s]
  /// Problems whose judged solve took longer are not timed in launches: that time stands, for what differs between
  /// launches is small against it [s].
  double longest_s = 0.1;
  bool parts = true;  ///< of those that have `near`, one more launch times parts, and the same matrix with another b
};

/// What a campaign consists of, fixed before its first solve.
struct CampaignPlan {
  std::string name = {};
  std::vector<std::string> manifests = {};  ///< paths
  std::vector<std::string> solvers = {};    ///< registry keys
  std::vector<double> tiers = {1e-3, 1e-6, 1e-9};
  /// Regular expression that "solve/<problem>/" must contain, and PassName; "" for all.
  std::string filter = {};
  Index most_rows = 0;  ///< no larger problems; 0: all
  bool fills = true;    ///< streams are filled up with the manifests' problems of further seeds
  /// By key of a size class: no more problems of a side, own scenes, engines or literature, nor of a side of those that
  /// are in no mean, the first by their turns (PlanProblems). Classes that are not named have all their problems.
  std::map<std::string, int> most_of_side = {};
  std::uint64_t seed = 1;  ///< of all orders
  Launches launches = {};
  int rounds = 5;  ///< over sequences
  SolveLimits limits = {};
  std::uint64_t memory_bytes = std::uint64_t{8} << 30U;  ///< address space of a solve
  NoiseRule noise = {};
  // For the manifests' sequences.
  std::vector<double> deadlines_s = {0.1e-3, 1e-3, 16e-3};  ///< of a step
  double pass_budget_s = 20;  ///< of a pass over a sequence: no further step is begun after it
  TuningSource tuning = {};
  SealedSet sealed = {};  ///< told in campaign.json, for the report to print it apart
  /// By key of a size class: peers that a careful user would ask in turn there, until an answer passes a check; told in
  /// campaign.json, for the report. Chosen on problems that nothing is compared on (data/portfolio.json).
  std::map<std::string, std::vector<std::string>> portfolio = {};
  bool without_sealed = false;  ///< leaves its problems out
};

/// A problem of the campaign.
struct PlannedProblem {
  std::size_t manifest = 0;  ///< index into the plan's
  const ManifestEntry* entry = nullptr;
  const SizeClass* size_class = nullptr;
  double weight = 1;  ///< what it counts in medians, shares and intervals
};

/// Whether a problem is in means: not those of kNonsymmetricTier and kLiteratureTier, and not those with friction or
/// bounded rows, which most solvers do not take: what they do there is compared apart.
bool IsInMeans(const std::string& manifest, const ManifestEntry& entry);

/// "" where the solver takes such rows (SolverEntry::takes_friction, takes_bounded, takes_plain), else the kind that it
/// does not take.
std::string NotTaken(const SolverEntry& solver, const ProblemProperties& problem);

/// The campaign's problems by size class, within a class those of the collection before those that fill it up, and
/// both by turns: of sides, which are own scenes (placed or in motion), engines' recordings and literature, of origins,
/// of families and of bases, of each in an order drawn by the seed. The first so many are a fair sample
/// (CampaignPlan::most_of_side). Weights: the k problems of a size class that have a base in common share a weight of
/// 1; and within a size class all sides weigh the same, their sum being what it was. Problems that are in no mean
/// (IsInMeans) weigh apart by the same rules.
/// @param manifests  must outlive the result
std::vector<PlannedProblem> PlanProblems(const CampaignPlan& plan, const std::vector<Manifest>& manifests);

/// What is run, judged, timed and recorded together, of one solver at one tier. Either consecutive problems of a size
/// class; above 10^4 rows every problem is a task of its own, for the memory's sake. Or a pass over a sequence, in a
/// mode:
///   cold             every step from f = 0
///   warm             every step from the solver's own answer to the one before, rows that are new from 0
///   deadline-0.1ms   warm at the strictest tier, every step within the deadline; judged at all tiers
/// A solver whose settings do not depend on the tolerance has one task, at the strictest tier, for all tiers.
struct Task {
  std::string solver;
  std::string runs;            ///< the key that is run: the solver's, or the one that has its settings for this size
  std::string about;           ///< key of the size class, or id of the sequence
  double tier = 0;             ///< asked for
  std::vector<double> judged;  ///< tiers, loosest first
  std::string excluded;        ///< the rule by which none of it is run; "" for none
  // A task on problems:
  std::size_t begin = 0;  ///< of PlanProblems
  std::size_t end = 0;    ///< after the last
  std::size_t first = 0;  ///< of its size class, the place of `begin`
  // A task on a sequence:
  const SequenceEntry* sequence = nullptr;  ///< null: problems
  std::size_t manifest = 0;                 ///< that has it: index into the plan's
  std::string mode;
  bool warm = false;
  double deadline_s = 0;  ///< 0: none

  std::size_t count() const { return end - begin; }
};

/// All tasks, by class, problem, solver and tier, the loosest tier first. Solvers that are not in the build have none,
/// and methods made for friction none where all is plain (SolverEntry::takes_plain).
std::vector<Task> PlanTasks(const CampaignPlan& plan, const std::vector<PlannedProblem>& problems);

/// All passes over the manifests' sequences, in the same order. @param manifests  must outlive the result
std::vector<Task> PlanPasses(const CampaignPlan& plan, const std::vector<Manifest>& manifests);

/// "solve/<problem>/<solver>/<tier>", for lists.
std::string CellName(const std::string& problem, const std::string& solver, double tier);
/// "steps/<sequence>/<solver>/<tier>/<mode>"
std::string PassName(const Task& pass);

/// Indices of cells, those of one group (equal numbers, side by side) together and in order, the groups shuffled by the
/// seed and the round. The same on every machine.
std::vector<std::size_t> ShuffleGroups(const std::vector<std::size_t>& group_of_cell, std::uint64_t seed, int round);

/// What a task's launches are in a round with: those of the same first problem and the same tier. A solver whose
/// settings do not depend on the tolerance has one launch for all tiers, which is in the rounds of the tier next to
/// 1e-6.
std::pair<std::size_t, double> RoundOf(const CampaignPlan& plan, const Task& task);

/// The order of a round: class by class, within a class tier by tier (RoundOf), and within that the solvers shuffled by
/// the seed and the round. Round 0 takes the sequences one after the other, from the least work to the most: a sequence
/// is made before its first use, and so the first solve waits for one that is made quickly.
std::vector<std::size_t> OrderOfRound(const CampaignPlan& plan, const std::vector<Task>& tasks, int round);

/// Some of the parts into which a campaign is divided, from 1: part k has every n-th size class, or sequence, from the
/// k-th on, so that all solvers of one run in turn on one processor.
struct Shard {
  int first = 1;
  int last = 1;
  int parts = 1;
};
std::vector<Task> TasksOfShard(std::vector<Task> tasks, const Shard& shard);

/// What is timed in a pass, and what the solver object and the processor are warmed with before: other problems than
/// those that are timed, other ones in every pass. Tolerance and limits are the caller's.
/// @param places  in the stream, of the problems to time
/// @param pass    from 1
PassRequest PlanPass(const std::vector<std::size_t>& places, PassKind kind, std::uint64_t seed, int pass);

/// What a solver is excluded by at stricter tiers after it ran out of time at `tier` on the same problem.
std::string OutOfTimeRule(double tier);
/// And by what on the rest of a size class (SolveLimits::most_late).
std::string OutOfTimeRule(const SolveLimits& limits);

/// @throws InputError naming what cannot
void RequireValid(const CampaignPlan& plan);

}  // namespace lcpbench
