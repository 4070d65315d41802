#include "benchmarks/recommend/measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <stdexcept>

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
constexpr NoiseRule kNoise;
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

// One solver in one mode: its passes so far.
struct Entrant {
  Measurement found;
  bool done = false;
  std::vector<std::vector<double>> calm;  // by step: latencies in rounds without preemption
  std::vector<std::vector<double>> all;
};

class Study {
 public:
  Study(const MeasurementPlan& plan, const ProblemSteps& steps, const std::string& file, const std::string& hash)
      : plan_(plan), steps_(static_cast<int>(steps.steps.size())), worker_(OptionsOf(plan)) {
    request_.file = file;
    request_.sha256 = hash;
    request_.tier = plan.tolerance;
    request_.judged = {plan.tolerance};
    for (const double tier : kTiers) {
      if (tier != plan.tolerance) request_.judged.push_back(tier);
    }
    std::sort(request_.judged.rbegin(), request_.judged.rend());
    request_.limits.most_s = kBudget;
    request_.budget_s = kBudget;
    for (const std::string& key : plan.solvers) {
      for (const bool warm : {false, true}) {
        if (warm && !steps.rows_are_known) continue;
        Entrant entrant;
        entrant.found.solver = key;
        entrant.found.warm = warm;
        entrant.calm.resize(steps.steps.size());
        entrant.all.resize(steps.steps.size());
        entrants_.push_back(std::move(entrant));
      }
    }
  }

  std::vector<Measurement> Run() {
    ProgressBar bar("recommend", plan_.rounds * static_cast<int>(entrants_.size()));
    std::vector<size_t> round(entrants_.size());
    std::iota(round.begin(), round.end(), size_t{0});
    for (int k = 0; k < plan_.rounds; ++k) {
      for (const size_t index : ShuffleGroups(round, 1, k)) {
        Entrant& entrant = entrants_[index];
        if (!entrant.done) Pass(k, &entrant);
        bar.Advance(1, entrant.found.solver);
      }
    }
    std::vector<Measurement> measurements;
    for (Entrant& entrant : entrants_) {
      for (size_t step = 0; step < entrant.all.size(); ++step) {
        const std::vector<double>& times = entrant.calm[step].empty() ? entrant.all[step] : entrant.calm[step];
        entrant.found.latency_s.push_back(times.empty() ? kInfinity : MedianOf(times));
      }
      measurements.push_back(std::move(entrant.found));
    }
    return measurements;
  }

 private:
  static WorkerOptions OptionsOf(const MeasurementPlan& plan) {
    WorkerOptions options;
    options.solver_arguments = plan.solver_arguments;
    options.memory_bytes = std::uint64_t{8} << 30U;
    options.cpu = plan.cpu;
    return options;
  }

  // Again where the clock was slow meanwhile: the last pass counts.
  void Pass(int round, Entrant* entrant) {
    request_.solver = entrant->found.solver;
    request_.warm = entrant->found.warm;
    SequenceReply reply;
    for (int run = 0; run <= kNoise.most_reruns; ++run) {
      const double before = ProbeSpeed();
      reply = worker_.Run(request_);
      const double probe = std::max(before, ProbeSpeed());
      fast_probe_s_ = std::min({fast_probe_s_, before, probe});
      const bool disturbed = DisturbanceOf(kNoise, {probe, 1, 0}, fast_probe_s_) > 0;
      if (!disturbed || reply.outcome != "completed") break;
      if (run == kNoise.most_reruns) ++entrant->found.disturbed;
    }
    if (reply.results.is_null()) reply.results = StepRecord(request_.judged).Results(steps_);
    Add(round, reply, entrant);
  }

  void Add(int round, const SequenceReply& reply, Entrant* entrant) {
    Measurement& found = entrant->found;
    const Json& results = reply.results;
    found.outcome = reply.outcome;
    found.detail = reply.detail;
    found.claims = results.at("claims").get<std::map<std::string, int>>();
    for (const Json& verdict : results.at("verdicts")) {
      const auto tier = verdict.at("tier").get<double>();
      const int passed = verdict.at("passed").get<int>();
      found.passed[tier] = round == 0 ? passed : std::min(found.passed[tier], passed);
      if (tier == plan_.tolerance) {
        found.false_successes = std::max(found.false_successes, verdict.at("false_successes").get<int>());
      }
    }
    const auto preempted = results.at("preempted").get<std::vector<int>>();
    const auto reached = results.at("reached").get<size_t>();
    for (size_t step = 0; step < reached; ++step) {
      const double latency = NumberAt(results.at("latency_s"), step);
      entrant->all[step].push_back(latency);
      found.raw_max_s = std::max(found.raw_max_s, latency);
      if (std::find(preempted.begin(), preempted.end(), static_cast<int>(step)) == preempted.end()) {
        entrant->calm[step].push_back(latency);
      }
      found.rho = std::max(found.rho, NumberAt(results.at("rho"), step));
    }
    if (reached == 0) found.rho = kInfinity;
    if (reply.outcome != "completed" || found.passed[plan_.tolerance] == 0) entrant->done = true;
  }

  // Null where it is not finite.
  static double NumberAt(const Json& numbers, size_t step) {
    const Json& number = numbers.at(step);
    return number.is_number() ? number.get<double>() : kInfinity;
  }

  const MeasurementPlan& plan_;
  int steps_;
  WorkerProcess worker_;
  SequenceRequest request_;
  std::vector<Entrant> entrants_;
  double fast_probe_s_ = kInfinity;
};

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
  const std::string hash = WriteSequenceSteps(steps.steps, file);
  return Study(plan, steps, file, hash).Run();
}

}  // namespace lcpbench
