#include "solvers/hybrid.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace lcpbench {
namespace {

// Below, a factorisation takes no longer than a few sweeps, and its answers have more digits.
constexpr Index kLeastRows = 500;

NncgOptions Probe() {
  NncgOptions options;
  options.end_when_hopeless = true;
  return options;
}

}  // namespace

HybridOptions HybridOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("hybrid", settings);
  HybridOptions options;
  constexpr double kMost = 100000;
  options.least_iterations = static_cast<int>(reader.Number("least-iterations", options.least_iterations, 0, kMost));
  options.most_iterations = static_cast<int>(reader.Number("most-iterations", options.most_iterations, 0, kMost));
  reader.Finish();
  return options;
}

HybridSolver::HybridSolver(HybridOptions options) : options_(options), probe_(Probe()) {}

std::string HybridSolver::WhyUnsupported(const LcpProblem& problem) const { return interior_.WhyUnsupported(problem); }

void HybridSolver::DoPrepare(const LcpProblem& problem) {
  probes_ = options_.most_iterations > 0 && problem.size() >= kLeastRows;
  if (!probes_) {
    interior_.Prepare(problem);
    return;
  }
  least_.Prepare(problem);
  probe_.Prepare(problem);
}

void HybridSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  LcpOptions rest = options;
  Eigen::VectorXd start;
  std::int64_t sweeps = 0;
  const auto left = [&](std::int64_t wanted) {
    return options.max_iterations > 0 ? std::min(wanted, options.max_iterations - sweeps) : wanted;
  };
  for (NncgSolver* solver : {&least_, &probe_}) {
    const std::int64_t wanted = solver == &least_ ? options_.least_iterations : options_.most_iterations - sweeps;
    if (!probes_ || wanted <= 0) continue;
    rest.max_iterations = left(wanted);
    rest.time_limit_s = deadline.Remaining();
    if (!(rest.time_limit_s > 0)) break;
    solver->Solve(problem, rest, result);
    sweeps += result->iterations;
    result->iterations = sweeps;
    result->detail = "nncg";
    if (result->status == LcpStatus::kSolved || result->status == LcpStatus::kTimeLimit) return;
    if (options.max_iterations > 0 && sweeps >= options.max_iterations) return;
    if (!result->f.allFinite()) continue;
    start = result->f;
    rest.initial_f = &start;
  }
  rest.max_iterations = options.max_iterations > 0 ? options.max_iterations - sweeps : 0;
  rest.time_limit_s = deadline.Remaining();
  if (!(rest.time_limit_s > 0)) {
    result->status = LcpStatus::kTimeLimit;
    return;
  }
  interior_.Solve(problem, rest, result);
  if (sweeps > 0) result->detail = "nncg; ipm" + (result->detail.empty() ? "" : ": " + result->detail);
  result->iterations += sweeps;
}

}  // namespace lcpbench
