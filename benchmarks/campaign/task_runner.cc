#include "benchmarks/campaign/task_runner.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recipes/another_b.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/collection/size_classes.h"
#include "benchmarks/measure/allocation_count.h"
#include "benchmarks/measure/peak_memory.h"
#include "solvers/lcp/metric_table.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/external_solver.h"
#include "support/input_error.h"

namespace lcpbench {

struct TaskRunner::Set {
  explicit Set(const std::string& path)
      : manifest(ReadManifest(path)), source(FolderOf(path)), references(manifest, FolderOf(path)) {
    for (const ManifestEntry& entry : manifest.problems) entries[entry.id] = &entry;
    for (const ManifestEntry& entry : manifest.fill) entries[entry.id] = &entry;
  }
  static std::string FolderOf(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

  Manifest manifest;
  ProblemSource source;
  References references;
  std::map<std::string, const ManifestEntry*> entries;
};

struct TaskRunner::Problem {
  std::string id;
  LcpProblem problem;
  LcpReference reference;
};

namespace {

using Json = nlohmann::json;

// Larger problems are made again when they are wanted again.
constexpr Index kMostRowsKept = 10'000;

TierVerdict Describe(const Verdict& verdict, LcpStatus claim, double tier) {
  TierVerdict described;
  described.tier = tier;
  described.passes = verdict.passes;
  if (verdict.best_tier > 0) described.best_tier = verdict.best_tier;
  described.at_floor = verdict.at_floor;
  described.false_success = verdict.false_success;
  described.false_infeasible = verdict.false_infeasible;
  described.proved_infeasible = claim == LcpStatus::kInfeasible && verdict.farkas && verdict.farkas->accepted;
  described.reason = verdict.reason;
  return described;
}

Json Describe(const Metrics& metrics) {
  Json json = Json::object();
  for (const MetricEntry& entry : AllMetrics()) {
    const double value = metrics.*entry.value;
    json[std::string(entry.key)] = std::isfinite(value) && value != -1 ? Json(value) : Json(nullptr);
  }
  return json;
}

// Counts allocations while it lives.
class AllocationWatch {
 public:
  AllocationWatch() {
    CountAllocations(true);
    count_ = AllocationCount();
  }
  ~AllocationWatch() { CountAllocations(false); }
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;
  std::int64_t count() const { return AllocationCount() - count_; }

 private:
  long count_ = 0;
};

}  // namespace

TaskRunner::TaskRunner() = default;
TaskRunner::~TaskRunner() = default;

TaskRunner::Set& TaskRunner::Load(const std::string& manifest) {
  std::unique_ptr<Set>& set = sets_[manifest];
  if (!set) set = std::make_unique<Set>(manifest);
  return *set;
}

const TaskRunner::Problem& TaskRunner::Get(const ProblemName& name) {
  if (const auto kept = kept_.find(name.id); kept != kept_.end()) return *kept->second;
  if (large_ && large_->id == name.id) return *large_;
  large_.reset();
  Set& set = Load(name.manifest);
  const auto entry = set.entries.find(name.id);
  if (entry == set.entries.end()) {
    throw InputError(name.manifest + ": expected a problem '" + name.id + "', found none");
  }
  LcpProblem problem = set.source.Get(*entry->second);
  std::optional<KnownAnswer> known = set.references.Find(problem);
  const bool is_large = problem.size() > kMostRowsKept;
  std::unique_ptr<Problem>& place = is_large ? large_ : kept_[name.id];
  place = std::make_unique<Problem>(Problem{name.id, std::move(problem), {}});
  if (known) place->reference = std::move(known->reference);
  return *place;
}

JudgeReply TaskRunner::Run(const JudgeRequest& request, const std::function<void()>& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  const Problem& given = Get(request.problem);
  LcpOptions options;
  options.tolerance = request.tier;
  options.time_limit_s = request.time_limit_s;
  options.time_factorisations = true;
  const ProblemArrays arrays = ProblemArrays::Of(given.problem);

  JudgeReply reply;
  begin();
  LcpSolver& solver = pool_.Get(entry);
  LcpResult result;
  if (entry.origin == SolverOrigin::kOwn) {
    ResetPeak();
    const AllocationWatch allocations;
    const double start = SteadyNow();
    solver.Solve(LcpProblem::FromArrays(arrays), options, &result);
    const double fresh_s = SteadyNow() - start;
    if (AllocationsAreCounted()) reply.allocations = allocations.count();
    reply.fresh_s = fresh_s;
    if (result.factor_s >= 0 && fresh_s > 0) reply.factor_share = result.factor_s / fresh_s;
    reply.peak_bytes = PeakBytes();
  } else {
    solver.Solve(given.problem, options, &result);
    if (result.own_fresh_s >= 0) reply.fresh_s = result.own_fresh_s;
    if (const auto* external = dynamic_cast<ExternalSolver*>(&solver); external && external->formed_on_host_s() > 0) {
      reply.formed_on_host_s = external->formed_on_host_s();
    }
  }

  reply.claim = ToString(result.status);
  reply.iterations = result.iterations;
  reply.detail = result.detail;
  for (const double tier : request.judged) {
    const Verdict verdict = Verify(given.problem, result, tier, &given.reference);
    reply.verdicts.push_back(Describe(verdict, result.status, tier));
    reply.metrics = Describe(verdict.metrics);
  }
  return reply;
}

const std::vector<bool>& TaskRunner::Passes(const Problem& given, const Eigen::VectorXd& f,
                                            const std::vector<double>& judged) {
  const auto bytes = [](const double* values, std::size_t count) {
    return std::string_view(reinterpret_cast<const char*>(values), count * sizeof(double));
  };
  std::string key = given.id;
  key += bytes(judged.data(), judged.size());
  key += bytes(f.data(), static_cast<std::size_t>(f.size()));
  std::vector<bool>& passes = judged_[std::hash<std::string>()(key)];
  if (passes.empty()) {
    const Metrics metrics = ComputeMetrics(given.problem, f, &given.reference);
    passes.reserve(judged.size());
    for (const double tier : judged) passes.push_back(PassesTier(metrics, tier));
  }
  return passes;
}

PassReply TaskRunner::RunOwnOrForeign(const TimedRequest& request, const std::function<void()>& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  if (entry.origin == SolverOrigin::kOwn) {
    begin();
    return RunPass([&entry] { return entry.make({}); }, arrays_, request.pass);
  }
  auto* external = dynamic_cast<ExternalSolver*>(&pool_.Get(entry));
  if (external == nullptr) throw std::logic_error("solver '" + request.solver + "' is in no process of its own");
  std::string& loaded = loaded_[request.solver];
  if (loaded != stream_) {
    external->LoadStream(arrays_);
    loaded = stream_;
  }
  begin();
  const double most_s =
      2 * (request.pass.budget_s + request.pass.time_limit_s) * static_cast<double>(2 + request.pass.warm_up.size());
  return external->RunPass(request.pass, most_s);
}

TimedReply TaskRunner::Run(const TimedRequest& request, const std::function<void()>& begin) {
  std::string names;
  for (const ProblemName& name : request.stream) names += name.id + "\n";
  const auto problem = [&](std::uint32_t place) -> const Problem& { return Get(request.stream.at(place)); };
  if (names != stream_) {
    arrays_.clear();
    arrays_.reserve(request.stream.size());
    for (const ProblemName& name : request.stream) arrays_.push_back(ProblemArrays::Of(Get(name).problem));
    stream_ = std::move(names);
  }
  TimedRequest asked = request;
  if (asked.pass.kind == PassKind::kAgain) {
    for (const std::uint32_t place : asked.pass.order) {
      asked.pass.other_b.push_back(AnotherB(problem(place).problem, request.other_b_seed));
    }
  }

  TimedReply reply;
  const DisturbanceWatch watch;
  PassReply pass;
  try {
    pass = RunOwnOrForeign(asked, begin);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // another process that did not come to its end
    reply.outcome = "crashed";
    reply.detail = error.what();
  }
  reply.disturbance = watch.Finish();
  // This thread waits while another process solves.
  if (FindSolver(request.solver).origin != SolverOrigin::kOwn) reply.disturbance->cpu_share = 1;

  const std::size_t count = request.stream.size();
  const bool has_parts = request.pass.kind == PassKind::kParts;
  reply.seconds.resize(count);
  for (auto* part : {&reply.problem_s, &reply.prepare_s, &reply.convert_s, &reply.solve_s}) {
    if (has_parts) part->resize(count);
  }
  reply.failed.resize(request.judged.size());
  for (std::size_t k = 0; k < pass.size(); ++k) {
    const std::uint32_t place = request.pass.order[k];
    const PassEntry& entry = pass[k];
    reply.seconds[place] = entry.seconds;
    if (has_parts) {
      reply.problem_s[place] = entry.problem_s;
      reply.prepare_s[place] = entry.prepare_s;
      reply.convert_s[place] = entry.convert_s;
      reply.solve_s[place] = entry.solve_s;
    }
    const Problem& given = problem(place);
    std::vector<bool> passes;
    if (request.pass.kind == PassKind::kAgain) {
      const Metrics metrics = ComputeMetrics(given.problem.WithB(asked.pass.other_b[k]), entry.f);
      passes.reserve(request.judged.size());
      for (const double tier : request.judged) passes.push_back(PassesTier(metrics, tier));
    } else {
      passes = Passes(given, entry.f, request.judged);
    }
    for (std::size_t tier = 0; tier < passes.size(); ++tier) {
      if (!passes[tier]) reply.failed[tier].push_back(place);
    }
  }
  return reply;
}

}  // namespace lcpbench
