#include "solvers/lcp/fresh_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "support/clock.h"

namespace lcpbench {
namespace {

// The warm-up has settled when two rounds of it, and the probes of the clock rate after them, differ by less than this.
constexpr double kSettled = 0.02;

bool IsSettled(double before, double now) { return std::abs(now - before) <= kSettled * before; }

void WarmUp(LcpSolver* solver, std::span<const ProblemArrays> problems, const PassRequest& request,
            const LcpOptions& options, LcpResult* result) {
  const double begun = SteadyNow();
  double until = std::numeric_limits<double>::infinity();
  double took = 0;
  double probe = 0;
  for (bool settled = request.warm_up.empty(); !settled && SteadyNow() < until;) {
    const double start = SteadyNow();
    for (const std::uint32_t index : request.warm_up) solver->SolveArrays(problems[index], options, result);
    const double took_now = SteadyNow() - start;
    const double probe_now = ProbeSpeed();
    settled = IsSettled(took, took_now) && IsSettled(probe, probe_now);
    if (took == 0) until = begun + took_now + request.settle_s;
    took = took_now;
    probe = probe_now;
  }
}

// Who asks for forces has just written the arrays. Here the warm-up, and perhaps another process, ran in between, and
// the first solve on each page of memory would take several hundred nanoseconds longer.
void ReadAll(std::span<const ProblemArrays> problems) {
  const auto read = [](const auto& numbers) {
    for (const auto& number : numbers) asm volatile("" : : "r"(number));
  };
  for (const ProblemArrays& arrays : problems) {
    read(arrays.id);
    read(arrays.row_start);
    read(arrays.column);
    read(arrays.value);
    read(arrays.inverse_mass);
    read(arrays.b);
    read(arrays.bilateral);
    for (const FrictionRow& row : arrays.friction) asm volatile("" : : "r"(row.row));
    for (const BoundedRow& row : arrays.bounded) asm volatile("" : : "r"(row.row));
  }
}

// The parts of a time, with clock reads in between.
void TimeParts(LcpSolver* solver, const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result,
               PassEntry* entry) {
  const double start = SteadyNow();
  const LcpProblem problem = LcpProblem::FromArrays(arrays);
  const double made = SteadyNow();
  solver->Prepare(problem);
  const double prepared = SteadyNow();
  solver->Solve(problem, options, result);
  const double solved = SteadyNow();
  entry->seconds = solved - start;
  entry->problem_s = made - start;
  entry->prepare_s = prepared - made;
  entry->convert_s = std::max(0.0, result->own_convert_s);
  entry->solve_s = std::max(0.0, solved - prepared - entry->convert_s);
}

}  // namespace

double PassLimit(const PassRequest& request) {
  constexpr double kGrace = 5;  // s
  const auto solves = static_cast<double>(request.order.size() + 2 * request.warm_up.size());
  const double limit_s = 2 * request.time_limit_s;
  const double each_s = request.longest_s > 0 ? std::min(limit_s, 4 * request.longest_s) : limit_s;
  return kGrace + limit_s + solves * each_s + request.settle_s;
}

PassReply RunPass(const SolverFactory& make, std::span<const ProblemArrays> problems, const PassRequest& request) {
  const std::unique_ptr<LcpSolver> solver = make();
  LcpOptions options;
  options.tolerance = request.tolerance;
  options.time_limit_s = request.time_limit_s;
  options.time_parts = request.kind == PassKind::kParts;
  Stopwatch watch;
  LcpResult result;
  PassReply reply;
  reply.entries.resize(request.order.size());
  for (std::size_t k = 0; k < request.order.size(); ++k) reply.entries[k].f.resize(problems[request.order[k]].rows);
  WarmUp(solver.get(), problems, request, options, &result);

  ReadAll(problems);
  const DisturbanceWatch disturbance;
  for (std::size_t k = 0; k < request.order.size(); ++k) {
    const ProblemArrays& arrays = problems[request.order[k]];
    PassEntry& entry = reply.entries[k];
    if (request.kind == PassKind::kFresh) {
      watch.Start();
      solver->SolveArrays(arrays, options, &result);
      entry.seconds = watch.Seconds();
    } else if (request.kind == PassKind::kParts) {
      TimeParts(solver.get(), arrays, options, &result, &entry);
    } else {
      const LcpProblem problem = LcpProblem::FromArrays(arrays);
      solver->Solve(problem, options, &result);
      Eigen::VectorXd b = request.other_b[k];
      watch.Start();
      solver->Solve(problem.WithB(std::move(b)), options, &result);
      entry.seconds = watch.Seconds();
    }
    entry.status = result.status;
    entry.f = result.f;
  }
  reply.disturbance = disturbance.Finish();
  return reply;
}

}  // namespace lcpbench
