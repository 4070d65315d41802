#include "solvers/auto/exact_rule.h"

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr double kSecondsOfProduct = 1e-6;  // of two rationals, in J M^-1 J^T

}  // namespace

void TryExact(const LcpProblem& problem, const LcpOptions& options, const AutoLimits& limits, const Deadline& deadline,
              LcpResult* result) {
  const Index n = problem.size();
  const auto others = problem.bilateral_rows().size() + problem.friction_rows().size() + problem.bounded_rows().size();
  const bool has_few = n - static_cast<Index>(others) <= limits.exact_contacts && n <= limits.exact_mode_rows &&
                       (problem.has_factors() || problem.Asymmetry() == 0);
  const auto entries = static_cast<double>(problem.has_factors() ? problem.J().nonZeros() : 0);
  LcpOptions rest = options;
  rest.time_limit_s = deadline.Remaining() - kSecondsOfProduct * entries * entries / static_cast<double>(n);
  if (!(problem.is_plain() || has_few) || n > limits.exact_rows || options.max_iterations > 0) return;
  if (!(rest.time_limit_s > 0)) return;
  LcpResult exact;
  exact.status = LcpStatus::kUnsupported;
  if (problem.is_plain()) ExactSolver(true).Solve(problem, rest, &exact);
  if (exact.status == LcpStatus::kUnsupported && has_few) {
    ExactOptions modes{.time_limit_s = rest.time_limit_s, .now = options.now, .most_modes = limits.exact_modes};
    modes.guessed_modes = [&] { return std::vector{ModesOf(problem, result->f)}; };
    const ExactAnswer answer = SolveByModes(ExactFrom(problem), modes);
    if (answer.is_solved()) exact.status = LcpStatus::kSolved;
    if (answer.status == ExactAnswer::Status::kInfeasible) exact.status = LcpStatus::kInfeasible;
    exact.iterations = answer.steps;
    exact.detail = answer.detail;
    exact.f = Rounded(answer.f);
    exact.farkas_ray = Rounded(answer.ray);
  }
  result->status = deadline.Expired() ? LcpStatus::kTimeLimit : LcpStatus::kNumericalFailure;
  if (exact.status == LcpStatus::kSolved) {
    const Metrics metrics = ComputeMetrics(problem, exact.f);
    const bool passes = PassesTier(metrics, options.tolerance);
    if (passes || !(metrics.rho >= ComputeMetrics(problem, result->f).rho)) result->f = exact.f;
    if (passes) result->status = LcpStatus::kSolved;
    if (!passes) exact.detail = "the exact solution, rounded to doubles, does not pass";
  } else if (exact.status == LcpStatus::kInfeasible) {
    if (exact.farkas_ray->size() == n) result->farkas_ray = AcceptedRay(problem, *exact.farkas_ray);
    if (result->farkas_ray) result->status = LcpStatus::kInfeasible;
    if (!result->farkas_ray) exact.detail = "there is no solution, which no ray of doubles proves";
  }
  result->iterations = exact.iterations;
  result->detail += (result->detail.empty() ? "exact" : "; exact") + (exact.detail.empty() ? "" : ": " + exact.detail);
}

}  // namespace lcpbench
