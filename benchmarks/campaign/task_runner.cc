#include "benchmarks/campaign/task_runner.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "support/process_watch.h"

namespace lcpbench {
namespace {

// Larger problems are made again when they are wanted again.
constexpr Index kMostRowsKept = 10'000;
constexpr double kJudgingLimit = 300;  // of all answers of a pass [s]

}  // namespace

const TaskRunner::Problem& TaskRunner::Get(const ProblemName& name) {
  if (const auto kept = problems_.find(name.id); kept != problems_.end()) return kept->second;
  std::erase_if(problems_, [](const auto& kept) { return kept.second.problem.size() > kMostRowsKept; });
  std::unique_ptr<ProblemSet>& set = sets_[name.manifest];
  if (!set) set = std::make_unique<ProblemSet>(name.manifest);
  for (const auto* entries : {&set->manifest.problems, &set->manifest.fill}) {
    const auto entry = std::find_if(entries->begin(), entries->end(), [&](const auto& e) { return e.id == name.id; });
    if (entry == entries->end()) continue;
    LcpProblem problem = set->source.Get(*entry);
    std::optional<KnownAnswer> known = set->references.Find(problem);
    LcpReference reference = known ? std::move(known->reference) : LcpReference();
    return problems_.emplace(name.id, Problem{std::move(problem), std::move(reference)}).first->second;
  }
  throw InputError(name.manifest + ": expected a problem '" + name.id + "', found none");
}

JudgeReply TaskRunner::Run(const JudgeRequest& request, const BeginPhase& begin) {
  const SolverEntry& entry = FindSolver(request.solver);
  const Problem& given = Get(request.problem);
  LcpOptions options;
  options.tolerance = request.tier;
  options.time_limit_s = request.time_limit_s;
  options.time_factorizations = true;
  const ProblemArrays arrays = ProblemArrays::Of(given.problem);

  const bool is_own = entry.origin == SolverOrigin::kOwn;
  timed_.reset();
  begin(is_own ? request.time_limit_s : 2 * request.time_limit_s, "while it was solved");  // it may be tried again
  LcpSolver& solver = pool_.Get(entry);
  LcpResult result;
  double first_s = -1;
  double peak_bytes = -1;
  double formed_on_host_s = -1;
  JudgeReply reply;
  if (is_own) {
    ResetPeak();
    const double start = SteadyNow();
    solver.Solve(LcpProblem::FromArrays(arrays), options, &result);
    first_s = SteadyNow() - start;
    peak_bytes = PeakBytes();
  } else {
    solver.Solve(given.problem, options, &result);
    first_s = result.own_fresh_s;
    if (auto* external = dynamic_cast<ExternalSolver*>(&solver)) {
      if (external->formed_on_host_s() > 0) formed_on_host_s = external->formed_on_host_s();
      reply.retried = external->TakeRetried();
    }
    result.factor_s = -1;  // not known of other processes
  }
  for (const double tier : request.judged) {
    const Verdict verdict = Verify(given.problem, result, tier, &given.reference);
    reply.records.push_back(DescribeAnswer({result, verdict, first_s, peak_bytes, formed_on_host_s}));
  }
  return reply;
}

ExternalSolver& TaskRunner::ProcessOf(const TimedRequest& request) {
  const std::string launch =
      request.solver + "\n" + std::to_string(request.launch) + "\n" + std::to_string(request.run) + "\n" + stream_;
  const SolverEntry& entry = FindSolver(request.solver);
  if (timed_ == nullptr || launch_ != launch) {
    pool_.Clear();
    timed_.reset();
    if (entry.origin == SolverOrigin::kOwn) {
      ExternalSolverOptions options;
      options.command = serve_;
      options.command.push_back(entry.key);
      options.name = entry.key;
      timed_ = std::make_unique<ExternalSolver>(options);
    } else {
      timed_ = entry.make({});
    }
    launch_ = launch;
    auto* external = dynamic_cast<ExternalSolver*>(timed_.get());
    if (external == nullptr) throw std::logic_error("solver '" + entry.key + "' does not run in a process of its own");
    external->LoadStream(arrays_);
  }
  return dynamic_cast<ExternalSolver&>(*timed_);
}

TimedReply TaskRunner::Run(const TimedRequest& request, const BeginPhase& begin) {
  std::string names;
  for (const ProblemName& name : request.stream) names += name.id + "\n";
  if (names != stream_) {
    arrays_.clear();
    arrays_.reserve(request.stream.size());
    for (const ProblemName& name : request.stream) arrays_.push_back(ProblemArrays::Of(Get(name).problem));
    stream_ = std::move(names);
  }
  const bool with_other_b = request.pass.kind == PassKind::kAgain;
  TimedRequest asked = request;
  for (const std::uint32_t place : with_other_b ? asked.pass.order : std::vector<std::uint32_t>()) {
    asked.pass.other_b.push_back(AnotherB(Get(request.stream.at(place)).problem, request.other_b_seed));
  }

  TimedReply reply;
  PassReply pass;
  const double limit_s = PassLimit(request.pass);
  try {
    ExternalSolver& solver = ProcessOf(request);
    begin(kJudgingLimit + limit_s, "in a timed pass");
    pass = solver.RunPass(asked.pass, limit_s);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // another process that did not come to its end
    reply.outcome = "crashed";
    reply.detail = error.what();
  }
  reply.disturbance = pass.disturbance;
  if (auto* external = dynamic_cast<ExternalSolver*>(timed_.get())) reply.retried = external->TakeRetried();

  for (const TimeField& field : TimeFields()) {
    if (field.kind != request.pass.kind) continue;
    auto& seconds = reply.times[field.name];
    seconds.resize(request.stream.size());
    for (std::size_t k = 0; k < pass.entries.size(); ++k) {
      seconds[request.pass.order[k]] = pass.entries[k].*field.seconds;
    }
  }
  reply.failed.resize(request.judged.size());
  for (std::size_t k = 0; k < pass.entries.size(); ++k) {
    const std::uint32_t place = request.pass.order[k];
    const Problem& given = Get(request.stream.at(place));
    const Metrics metrics = with_other_b ? ComputeMetrics(given.problem.WithB(asked.pass.other_b[k]), pass.entries[k].f)
                                         : ComputeMetrics(given.problem, pass.entries[k].f, &given.reference);
    for (std::size_t tier = 0; tier < request.judged.size(); ++tier) {
      if (!PassesTier(metrics, request.judged[tier])) reply.failed[tier].push_back(place);
    }
  }
  return reply;
}

}  // namespace lcpbench
