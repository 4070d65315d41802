#include "benchmarks/campaign/task_runner.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/collection/properties.h"
#include "benchmarks/measure/allocation_count.h"
#include "benchmarks/measure/peak_memory.h"
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

// Larger problems are made again when they are wanted again.
constexpr Index kMostRowsKept = 10'000;

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

  begin();
  LcpSolver& solver = pool_.Get(entry);
  LcpResult result;
  double first_s = -1;
  double peak_bytes = -1;
  double formed_on_host_s = -1;
  std::int64_t allocated = -1;
  if (entry.origin == SolverOrigin::kOwn) {
    ResetPeak();
    const AllocationWatch allocations;
    const double start = SteadyNow();
    solver.Solve(LcpProblem::FromArrays(arrays), options, &result);
    first_s = SteadyNow() - start;
    if (AllocationsAreCounted()) allocated = allocations.count();
    peak_bytes = PeakBytes();
  } else {
    solver.Solve(given.problem, options, &result);
    first_s = result.own_fresh_s;
    const auto* external = dynamic_cast<ExternalSolver*>(&solver);
    if (external != nullptr && external->formed_on_host_s() > 0) formed_on_host_s = external->formed_on_host_s();
    result.factor_s = -1;  // not known of other processes
  }
  JudgeReply reply;
  for (const double tier : request.judged) {
    const Verdict verdict = Verify(given.problem, result, tier, &given.reference);
    reply.records.push_back(DescribeAnswer({result, verdict, first_s, peak_bytes, formed_on_host_s, allocated}));
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

  for (const TimeField& field : TimeFields()) {
    if (field.kind != request.pass.kind) continue;
    auto& seconds = reply.times[field.name];
    seconds.resize(request.stream.size());
    for (std::size_t k = 0; k < pass.size(); ++k) seconds[request.pass.order[k]] = pass[k].*field.seconds;
  }
  reply.failed.resize(request.judged.size());
  for (std::size_t k = 0; k < pass.size(); ++k) {
    const std::uint32_t place = request.pass.order[k];
    const PassEntry& entry = pass[k];
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
