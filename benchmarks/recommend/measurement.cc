#include "benchmarks/recommend/measurement.h"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

#include "benchmarks/campaign/reference_floor.h"
#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/measure/speed_probe.h"
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

std::string Percent(double share) { return FormatNumber(100 * share, share < 0.01 ? "%.1g %%" : "%.0f %%"); }

// "1e-6"
std::string TierText(double tier) {
  return boost::algorithm::replace_first_copy(FormatNumber(tier, "%.0e"), "e-0", "e-");
}

int PassedAt(const Measurement& measured, double tier) {
  const auto found = measured.passed.find(tier);
  return found == measured.passed.end() ? 0 : found->second;
}

// The solver's own words for most steps that were not solved.
std::string MostFrequentFailure(const Measurement& measured) {
  std::string failure;
  int steps = 0;
  for (const auto& [claim, count] : measured.claims) {
    if (claim == "solved" || count <= steps) continue;
    failure = claim;
    steps = count;
  }
  return failure;
}

std::string WhyNotVerified(const Measurement& measured, double tolerance) {
  if (measured.outcome != "completed") return measured.outcome + ": " + measured.detail;
  const int steps = static_cast<int>(measured.latency_s.size());
  const int failed = steps - PassedAt(measured, tolerance);
  std::string text;
  // Strictest first.
  for (const auto& [tier, passed] : measured.passed) {
    if (tier > tolerance && passed == steps) {
      text = "meets " + TierText(tier) + " only";
      break;
    }
  }
  if (text.empty() && failed == steps) text = "not verified";
  if (failed < steps) {
    const std::string count = "fails " + std::to_string(failed) + " of " + std::to_string(steps) + " steps";
    text = text.empty() ? count : count + ", " + text;
  }
  const std::string claim = MostFrequentFailure(measured);
  if (!claim.empty()) text += " (" + claim + ")";
  if (measured.false_successes > 0) text += ", claims success falsely";
  return text;
}

Assessment Assess(const Measurement& measured, const RecommendationRequest& request) {
  Assessment found;
  found.measured = measured;
  const std::vector<double>& latency = measured.latency_s;
  found.p50_s = Quantile(latency, 0.5);
  found.p99_s = Quantile(latency, 0.99);
  found.max_s = Quantile(latency, 1);
  const auto steps = static_cast<double>(latency.size());
  if (request.deadline_s) {
    const auto in_time =
        std::count_if(latency.begin(), latency.end(), [&](double time) { return time <= *request.deadline_s; });
    found.in_time = static_cast<double>(in_time) / steps;
  }
  found.verified = PassedAt(measured, request.tolerance) / steps;
  found.time_s = request.by_tail ? found.p99_s : found.p50_s;
  const bool in_time = !request.deadline_s || found.p99_s <= *request.deadline_s;
  const bool verified = measured.outcome == "completed" && found.verified == 1;
  found.meets = verified && in_time;
  if (!verified) found.shortcoming = WhyNotVerified(measured, request.tolerance);
  // Of a pass that ended early the verdict says enough.
  if (!in_time && measured.outcome == "completed") {
    found.shortcoming += (found.shortcoming.empty() ? "" : "; ") + std::string("deadline missed in ") +
                         Percent(1 - found.in_time) + " of the steps";
  }
  return found;
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

std::string FormatNumber(double value, const char* format) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::vector<Assessment> RankMeasurements(const std::vector<Measurement>& measurements,
                                         const RecommendationRequest& request) {
  std::vector<Assessment> ranked;
  ranked.reserve(measurements.size());
  for (const Measurement& measured : measurements) ranked.push_back(Assess(measured, request));
  const auto key = [](const Assessment& each) {
    const double verified = each.meets ? 1 : each.verified;
    return std::make_tuple(each.meets ? 0 : 1, -verified, each.meets ? 0.0 : -each.in_time, each.time_s);
  };
  std::stable_sort(ranked.begin(), ranked.end(),
                   [&](const Assessment& a, const Assessment& b) { return key(a) < key(b); });
  return ranked;
}

}  // namespace lcpbench
