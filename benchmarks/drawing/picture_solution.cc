#include "benchmarks/drawing/picture_solution.h"

#include <memory>
#include <utility>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

PictureSolution SolveBy(LcpSolver& solver, std::string_view key, const LcpProblem& problem, bool* verified) {
  LcpResult result;
  const LcpOptions options;
  solver.Solve(problem, options, &result);
  const Verdict verdict = Verify(problem, result, options.tolerance);
  *verified = verdict.passes;
  PictureSolution solution;
  solution.found = result.f.size() == problem.size() && result.f.allFinite();
  solution.w = verdict.metrics.w;
  solution.f = std::move(result.f);
  solution.caption =
      std::string(key) + (verdict.passes ? "" : ": " + std::string(ToString(result.status)) + ", not verified");
  return solution;
}

}  // namespace

PictureSolution SolveForPicture(const LcpProblem& problem, const std::string& solver_key) {
  bool verified = false;
  if (!solver_key.empty()) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(solver_key);
    return problem.size() > 0 ? SolveBy(*solver, solver_key, problem, &verified) : PictureSolution{};
  }
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available || problem.size() == 0) continue;
    PictureSolution solution = SolveBy(*entry.make({}), entry.key, problem, &verified);
    if (verified) return solution;
  }
  return {};
}

}  // namespace lcpbench
