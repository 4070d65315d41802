#include "benchmarks/slowed_solver.h"

#include <utility>

namespace lcpbench {

SlowedSolver::SlowedSolver(std::unique_ptr<LcpSolver> solver, double factor)
    : solver_(std::move(solver)), factor_(factor) {}

std::string SlowedSolver::WhyUnsupported(const LcpProblem& problem) const { return solver_->WhyUnsupported(problem); }
void SlowedSolver::Reserve(Index max_rows) { solver_->Reserve(max_rows); }
void SlowedSolver::DoPrepare(const LcpProblem& problem) { solver_->Prepare(problem); }

void SlowedSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const double start = SteadyNow();
  solver_->Solve(problem, options, result);
  const double end = start + factor_ * (SteadyNow() - start);
  while (SteadyNow() < end) {
  }
}

}  // namespace lcpbench
