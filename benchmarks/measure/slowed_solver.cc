#include "benchmarks/measure/slowed_solver.h"

#include <utility>

namespace lcpbench {

SlowedSolver::SlowedSolver(std::unique_ptr<LcpSolver> solver, double factor)
    : solver_(std::move(solver)), factor_(factor) {}

std::string SlowedSolver::WhyUnsupported(const LcpProblem& problem) const { return solver_->WhyUnsupported(problem); }
void SlowedSolver::Reserve(Index max_rows) { solver_->Reserve(max_rows); }
void SlowedSolver::DoPrepare(const LcpProblem& problem) {
  const double start = SteadyNow();
  solver_->Prepare(problem);
  WaitSince(start);
}

void SlowedSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const double start = SteadyNow();
  solver_->Solve(problem, options, result);
  WaitSince(start);
}

void SlowedSolver::WaitSince(double start) const {
  const double end = start + factor_ * (SteadyNow() - start);
  while (SteadyNow() < end) {
  }
}

}  // namespace lcpbench
