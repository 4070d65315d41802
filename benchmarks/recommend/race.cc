#include "benchmarks/recommend/race.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/reference_solves.h"
#include "support/number_text.h"
#include "support/process_watch.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

// What is slower than the leader by more than kBehind + kDoubt / passes is dropped: one pass may have been disturbed.
constexpr double kBehind = 2;
constexpr double kDoubt = 2;
// In the first round an expensive pass may take so many times the fastest one's time: enough to see that it is behind.
constexpr double kPatience = 4;
constexpr double kFloorTimeLimit = 10;  // [s]
// Copies of a problem that stands alone: enough for a quantile, and no more rows than a worker reads in a second.
constexpr double kMostCopies = 40;
constexpr double kMostCopiedRows = 20'000;

// A folder that is gone with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "lcpbench-recommend-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string File(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

struct Entrant {
  Passes passes;
  double pass_s = 0;  // of the last pass
  bool racing = true;

  const Measurement& found() const { return passes.found(); }
};

// What a pass may take [s], with `left` of the budget and `waiting` entrants yet to run in this round; 0: not begun.
// @param fastest_s  pass that was right on all steps; infinite before there is one
double Allowed(const Entrant& entrant, double left, double fastest_s, size_t waiting) {
  if (!entrant.racing || left <= 0) return 0;
  if (entrant.found().passes > 0) return entrant.pass_s <= left ? left : 0;
  return std::max(left / static_cast<double>(waiting), std::min(kPatience * fastest_s, left / 2));
}

std::string WhyBehind(const Assessment& one, const Assessment& leader) {
  if (one.verified < leader.verified) return "right on fewer steps than " + leader.measured.solver;
  const double behind = kBehind + kDoubt / one.measured.passes;
  if (one.p50_s <= behind * leader.p50_s || one.time_s <= behind * leader.time_s) return "";
  const double times = one.p50_s / leader.p50_s;
  return FormatNumber(times, times < 100 ? "%.3g x the median of " : "%.0f x the median of ") + leader.measured.solver;
}

void DropLosers(const RecommendationRequest& request, std::vector<Entrant>* entrants) {
  std::vector<Measurement> found;
  for (const Entrant& entrant : *entrants) {
    if (entrant.found().passes > 0) found.push_back(entrant.found());
  }
  if (found.empty()) return;
  const Assessment leader = RankMeasurements(found, request).front();
  for (Entrant& entrant : *entrants) {
    if (!entrant.racing || entrant.found().passes == 0) continue;
    const std::string reason = WhyBehind(Assess(entrant.found(), request), leader);
    if (reason.empty()) continue;
    entrant.racing = false;
    entrant.passes.Drop(reason);
  }
}

// As campaigns run passes over sequences.
SequenceRequest RequestOf(double tolerance, const std::string& file, const std::string& hash) {
  SequenceRequest request;
  request.file = file;
  request.sha256 = hash;
  request.tier = tolerance;
  request.judged = CampaignPlan{}.tiers;
  if (std::count(request.judged.begin(), request.judged.end(), tolerance) == 0) request.judged.push_back(tolerance);
  std::sort(request.judged.rbegin(), request.judged.rend());
  return request;
}

}  // namespace

std::vector<Measurement> Race(const std::vector<std::string>& solvers, bool warm, const RecommendationRequest& request,
                              const RaceOptions& options, SequenceRequest base, size_t steps, const PassRunner& run,
                              const Clock& now) {
  const double end = now() + options.budget_s;
  std::vector<Entrant> entrants;
  for (const std::string& key : solvers) {
    entrants.push_back({Passes(key, false, steps)});
    if (warm) entrants.push_back({Passes(key, true, steps)});
  }
  const auto measured = [&entrants] {
    std::vector<Measurement> measurements;
    for (const Entrant& entrant : entrants) measurements.push_back(entrant.found());
    return measurements;
  };
  if (options.budget_s <= 0) return measured();
  ProgressBar bar("recommend", options.rounds * static_cast<double>(entrants.size()));
  double fastest_s = std::numeric_limits<double>::infinity();
  std::vector<size_t> order(entrants.size());
  std::iota(order.begin(), order.end(), size_t{0});
  for (int round = 0; round < options.rounds; ++round) {
    size_t waiting = entrants.size();
    for (const size_t index : round == 0 ? order : ShuffleGroups(order, 1, round)) {
      Entrant& entrant = entrants[index];
      const double begun = now();
      const double allowed = Allowed(entrant, end - begun, fastest_s, waiting--);
      bar.Advance(1, entrant.found().solver);
      if (allowed <= 0) continue;
      base.solver = entrant.found().solver;
      base.warm = entrant.found().warm;
      base.budget_s = allowed;
      base.limits.most_s = allowed;
      base.limits.least_s = std::min(allowed, SolveLimits{}.least_s);
      PassRun pass = run(base);
      entrant.pass_s = now() - begun;
      if (pass.reply.results.is_null()) {
        pass.reply.results = StepRecord(base.judged).Results(static_cast<int>(steps));
      }
      entrant.passes.Add(pass.reply, pass.disturbed, base.tier);
      const double verified = Assess(entrant.found(), request).verified;
      entrant.racing = pass.reply.outcome == "completed" && verified > 0;
      if (entrant.racing && verified == 1) fastest_s = std::min(fastest_s, entrant.pass_s);
    }
    DropLosers(request, &entrants);
  }
  return measured();
}

std::vector<Measurement> RaceOnProblems(const std::vector<std::string>& solvers, ProblemSteps steps,
                                        const RecommendationRequest& request, RaceOptions options,
                                        const RaceProcess& process) {
  const double begun = SteadyNow();
  for (SequenceStep& step : steps.steps) {
    const double left = begun + options.budget_s / 2 - SteadyNow();
    if (step.reference.floor || left <= 0) continue;
    step.reference.floor = FindReferenceFloor(step.problem, request.tolerance, std::min(left, kFloorTimeLimit));
  }
  if (steps.steps.size() == 1) {
    const SequenceStep only = steps.steps.front();
    const double copies = std::clamp(kMostCopiedRows / static_cast<double>(only.problem.size()), 1.0, kMostCopies);
    steps.steps.assign(static_cast<size_t>(copies), only);
  }
  const ScratchFolder folder;
  const std::string file = folder.File("steps.jsonl.gz");
  const SequenceRequest base = RequestOf(request.tolerance, file, WriteSequenceSteps(steps.steps, file));
  WorkerProcess worker(
      {.solver_arguments = process.solver_arguments, .memory_bytes = CampaignPlan{}.memory_bytes, .cpu = process.cpu});
  double fast_probe_s = std::numeric_limits<double>::infinity();
  const auto run = [&](const SequenceRequest& pass) {
    const double before = ProbeSpeed();
    SequenceReply reply = worker.Run(pass);
    const double probe = std::max(before, ProbeSpeed());
    fast_probe_s = std::min({fast_probe_s, before, probe});
    return PassRun{std::move(reply), DisturbanceOf({}, {probe, 1, 0}, fast_probe_s) > 0};
  };
  options.budget_s -= SteadyNow() - begun;
  return Race(solvers, steps.rows_are_known, request, options, base, steps.steps.size(), run);
}

}  // namespace lcpbench
