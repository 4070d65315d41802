#include "benchmarks/measure/exact_guess.h"

#include "solvers/registry.h"

namespace lcpbench {
namespace {

constexpr double kTolerance = 1e-12;
constexpr double kTimeLimit = 30;

LcpResult SolveBy(const char* key, const LcpProblem& problem) {
  LcpOptions options;
  options.tolerance = kTolerance;
  options.time_limit_s = kTimeLimit;
  LcpResult result;
  MakeSolver(key)->Solve(problem, options, &result);
  return result;
}

}  // namespace

ExactGuess GuessBySolvers(const LcpProblem& problem) {
  ExactGuess guess;
  for (const char* key : {"dantzig", "auto"}) {
    const LcpResult result = SolveBy(key, problem);
    if (result.status == LcpStatus::kInfeasible && result.farkas_ray.has_value()) {
      guess.ray = *result.farkas_ray;
      return guess;
    }
    if (guess.f.size() == 0 || result.status == LcpStatus::kSolved) guess.f = result.f;
    if (result.status == LcpStatus::kSolved) return guess;
  }
  return guess;
}

LcpResult SolveNearly(const LcpProblem& problem) { return SolveBy("auto", problem); }

}  // namespace lcpbench
