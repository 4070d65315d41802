#include "solvers/hybrid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace lcpbench {
namespace {

// Nanoseconds of an nncg iteration by row and by entry of an assembled A, and of a factorisation with its solves, by
// flop and by entry of the factor. Measured together on one machine; their ratios matter only.
constexpr double kSweepTimePerRow = 8;
constexpr double kSweepTimePerEntry = 1.5;
constexpr double kTimePerFlop = 0.1;
constexpr double kTimePerFactorEntry = 12;

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
  options.probe_factorizations = reader.Number("probe", options.probe_factorizations, 0, 1000);
  options.least_iterations = static_cast<int>(reader.Number("least-iterations", options.least_iterations, 0, 10000));
  reader.Finish();
  return options;
}

HybridSolver::HybridSolver(HybridOptions options) : options_(options), probe_(Probe()) {}

std::string HybridSolver::WhyUnsupported(const LcpProblem& problem) const { return interior_.WhyUnsupported(problem); }

void HybridSolver::DoPrepare(const LcpProblem& problem) {
  interior_.Prepare(problem);
  probe_limit_ = 0;
  if (options_.probe_factorizations == 0 || problem.size() < kLeastRows) return;
  least_.Prepare(problem);
  probe_.Prepare(problem);
  const IpmStatistics& factor = interior_.statistics();
  const double factor_time = kTimePerFlop * factor.factor_flops + kTimePerFactorEntry * factor.fill;
  const double sweep_time = problem.has_factors() && problem.has_two_body_rows()
                                ? kSweepTimePerRow * static_cast<double>(problem.size())
                                : kSweepTimePerEntry * static_cast<double>(problem.SparseA().nonZeros());
  probe_limit_ = static_cast<std::int64_t>(std::ceil(options_.probe_factorizations * factor_time / sweep_time));
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
    const std::int64_t wanted = solver == &least_ ? options_.least_iterations : probe_limit_ - sweeps;
    if (probe_limit_ == 0 || wanted <= 0) continue;
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
