#include "benchmarks/recommend/measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/measure/process_watch.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/measure/reference_solves.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFloorTimeLimit = 10;  // [s]
constexpr double kBudget = 60;          // of a pass [s]
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

void FindFloors(double tolerance, std::vector<SequenceStep>* steps) {
  for (SequenceStep& step : *steps) {
    if (step.reference.floor) continue;
    step.reference.floor = FindReferenceFloor(step.problem, tolerance, kFloorTimeLimit);
  }
}

// Null where it is not finite.
double NumberAt(const Json& numbers, size_t step) {
  const Json& number = numbers.at(step);
  return number.is_number() ? number.get<double>() : kInfinity;
}

// One solver in one mode: its passes so far.
struct Entrant {
  Measurement found;
  bool done = false;
  std::vector<std::vector<double>> calm;  // by step: latencies in rounds without preemption
  std::vector<std::vector<double>> all;

  void Add(const SequenceReply& reply, int round, double tolerance) {
    const Json& results = reply.results;
    found.outcome = reply.outcome;
    found.detail = reply.detail;
    found.claims = results.at("claims").get<std::map<std::string, int>>();
    for (const Json& verdict : results.at("verdicts")) {
      const auto tier = verdict.at("tier").get<double>();
      const int passed = verdict.at("passed").get<int>();
      found.passed[tier] = round == 0 ? passed : std::min(found.passed[tier], passed);
      if (tier != tolerance) continue;
      found.false_successes = std::max(found.false_successes, verdict.at("false_successes").get<int>());
    }
    const auto preempted = results.at("preempted").get<std::set<size_t>>();
    const auto reached = results.at("reached").get<size_t>();
    for (size_t step = 0; step < reached; ++step) {
      const double latency = NumberAt(results.at("latency_s"), step);
      all[step].push_back(latency);
      if (preempted.count(step) == 0) calm[step].push_back(latency);
      found.raw_max_s = std::max(found.raw_max_s, latency);
      found.rho = std::max(found.rho, NumberAt(results.at("rho"), step));
    }
    if (reached == 0) found.rho = kInfinity;
    done = reply.outcome != "completed" || found.passed[tolerance] == 0;
  }

  Measurement Finish() {
    for (size_t step = 0; step < all.size(); ++step) {
      const std::vector<double>& times = calm[step].empty() ? all[step] : calm[step];
      found.latency_s.push_back(times.empty() ? kInfinity : MedianOf(times));
    }
    return std::move(found);
  }
};

// As campaigns run passes over sequences.
SequenceRequest RequestOf(const MeasurementPlan& plan, const std::string& file, const std::string& hash) {
  const CampaignPlan campaign;
  SequenceRequest request;
  request.file = file;
  request.sha256 = hash;
  request.tier = plan.tolerance;
  request.judged = campaign.tiers;
  if (std::count(campaign.tiers.begin(), campaign.tiers.end(), plan.tolerance) == 0) {
    request.judged.push_back(plan.tolerance);
  }
  std::sort(request.judged.rbegin(), request.judged.rend());
  request.limits = campaign.limits;
  request.limits.most_s = kBudget;
  request.budget_s = kBudget;
  return request;
}

// A pass; again where the clock was slow meanwhile: the last one counts.
SequenceReply RunPass(WorkerProcess* worker, const SequenceRequest& request, double* fast_probe_s, int* disturbed) {
  const NoiseRule noise;
  for (int run = 0;; ++run) {
    const double before = ProbeSpeed();
    SequenceReply reply = worker->Run(request);
    const double probe = std::max(before, ProbeSpeed());
    *fast_probe_s = std::min({*fast_probe_s, before, probe});
    const bool calm = DisturbanceOf(noise, {probe, 1, 0}, *fast_probe_s) <= 0;
    if (!calm && reply.outcome == "completed" && run < noise.most_reruns) continue;
    if (!calm && reply.outcome == "completed") ++*disturbed;
    return reply;
  }
}

}  // namespace

std::vector<Measurement> MeasureSolvers(const MeasurementPlan& plan, ProblemSteps steps) {
  FindFloors(plan.tolerance, &steps.steps);
  if (steps.steps.size() == 1) {
    const SequenceStep only = steps.steps.front();
    const double copies = std::clamp(kMostCopiedRows / static_cast<double>(only.problem.size()), 1.0, kMostCopies);
    steps.steps.assign(static_cast<size_t>(copies), only);
  }
  const ScratchFolder folder;
  const std::string file = folder.File("steps.jsonl.gz");
  SequenceRequest request = RequestOf(plan, file, WriteSequenceSteps(steps.steps, file));
  const size_t count = steps.steps.size();
  std::vector<Entrant> entrants;
  for (const std::string& key : plan.solvers) {
    for (const bool warm : {false, true}) {
      if (warm && !steps.rows_are_known) continue;
      Entrant& entrant = entrants.emplace_back();
      entrant.found.solver = key;
      entrant.found.warm = warm;
      entrant.calm.resize(count);
      entrant.all.resize(count);
    }
  }
  WorkerProcess worker(
      {.solver_arguments = plan.solver_arguments, .memory_bytes = CampaignPlan{}.memory_bytes, .cpu = plan.cpu});
  double fast_probe_s = kInfinity;
  ProgressBar bar("recommend", plan.rounds * static_cast<int>(entrants.size()));
  std::vector<size_t> order(entrants.size());
  std::iota(order.begin(), order.end(), size_t{0});
  for (int round = 0; round < plan.rounds; ++round) {
    for (const size_t index : ShuffleGroups(order, 1, round)) {
      Entrant& entrant = entrants[index];
      bar.Advance(1, entrant.found.solver);
      if (entrant.done) continue;
      request.solver = entrant.found.solver;
      request.warm = entrant.found.warm;
      SequenceReply reply = RunPass(&worker, request, &fast_probe_s, &entrant.found.disturbed);
      if (reply.results.is_null()) {
        reply.results = StepRecord(request.judged).Results(static_cast<int>(count));
      }
      entrant.Add(reply, round, plan.tolerance);
    }
  }
  std::vector<Measurement> measurements;
  for (Entrant& entrant : entrants) measurements.push_back(entrant.Finish());
  return measurements;
}

}  // namespace lcpbench
