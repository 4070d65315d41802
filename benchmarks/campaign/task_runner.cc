#include "benchmarks/campaign/task_runner.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/measure/process_watch.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Larger problems are made again when they are wanted again.
constexpr Index kMostRowsKept = 10'000;
constexpr double kJudgingLimit = 300;  // [s]

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

ExternalSolver& TaskRunner::ProcessOf(const SolverEntry& entry) {
  if (entry.origin == SolverOrigin::kOwn) {
    std::unique_ptr<ExternalSolver>& served = served_[entry.key];
    if (served == nullptr) {
      ExternalSolverOptions options;
      options.command = serve_;
      options.command.push_back(entry.key);
      options.name = entry.key;
      served = std::make_unique<ExternalSolver>(options);
    }
    return *served;
  }
  auto* external = dynamic_cast<ExternalSolver*>(&pool_.Get(entry));
  if (external == nullptr) throw std::logic_error("solver '" + entry.key + "' does not run in a process of its own");
  return *external;
}

PassReply TaskRunner::RunInItsProcess(const TimedRequest& request, const std::function<void()>& begin) {
  ExternalSolver& solver = ProcessOf(FindSolver(request.solver));
  std::string& loaded = loaded_[request.solver];
  if (loaded != stream_) {
    solver.LoadStream(arrays_);
    loaded = stream_;
  }
  begin();
  const double most_s =
      2 * (request.pass.budget_s + request.pass.time_limit_s) * static_cast<double>(2 + request.pass.warm_up.size());
  return solver.RunPass(request.pass, most_s);
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
  const DisturbanceWatch watch;
  PassReply pass;
  // Warm-ups are not in the budget, and judging the answers takes its time, too.
  const auto solves = static_cast<double>(request.pass.warm_up.size() + 1);
  const double limit_s = kJudgingLimit + request.pass.budget_s + solves * request.pass.time_limit_s;
  try {
    pass = RunInItsProcess(asked, [&] { begin(limit_s, "in a timed pass"); });
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // another process that did not come to its end
    reply.outcome = "crashed";
    reply.detail = error.what();
  }
  reply.disturbance = watch.Finish();
  reply.disturbance->cpu_share = 1;  // this thread waits while another process solves
  reply.retried = ProcessOf(FindSolver(request.solver)).TakeRetried();

  for (const TimeField& field : TimeFields()) {
    if (field.kind != request.pass.kind) continue;
    auto& seconds = reply.times[field.name];
    seconds.resize(request.stream.size());
    for (std::size_t k = 0; k < pass.size(); ++k) seconds[request.pass.order[k]] = pass[k].*field.seconds;
  }
  reply.failed.resize(request.judged.size());
  for (std::size_t k = 0; k < pass.size(); ++k) {
    const std::uint32_t place = request.pass.order[k];
    const Problem& given = Get(request.stream.at(place));
    const Metrics metrics = with_other_b ? ComputeMetrics(given.problem.WithB(asked.pass.other_b[k]), pass[k].f)
                                         : ComputeMetrics(given.problem, pass[k].f, &given.reference);
    for (std::size_t tier = 0; tier < request.judged.size(); ++tier) {
      if (!PassesTier(metrics, request.judged[tier])) reply.failed[tier].push_back(place);
    }
  }
  return reply;
}

}  // namespace lcpbench
