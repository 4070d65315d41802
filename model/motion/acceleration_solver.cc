#include "model/motion/acceleration_solver.h"

namespace lcpbench {

CountedSolver::CountedSolver(LcpSolver& solver, const LcpOptions& options, MotionStatistics* statistics)
    : solver_(solver), options_(options), statistics_(statistics) {}

void CountedSolver::Solve(const LcpProblem& problem, const Eigen::VectorXd* initial_f, LcpResult* result) {
  if (problem.size() == 0) {
    *result = {};
    result->status = LcpStatus::kSolved;
    result->iterations = 0;
    return;
  }
  options_.initial_f = initial_f != nullptr && initial_f->size() == problem.size() ? initial_f : nullptr;
  const double begin = SteadyNow();
  solver_.Prepare(problem);
  solver_.Solve(problem, options_, result);
  statistics_->solve_time_s += SteadyNow() - begin;
  ++statistics_->solves;
  if (result->status != LcpStatus::kSolved) ++statistics_->failed_solves;
  if (result->f.size() == problem.size() && result->f.allFinite()) return;
  std::string detail = "the solver gave no finite forces for problem '" + problem.id() + "' (" +
                       std::string(ToString(result->status)) + ")";
  if (!result->detail.empty()) detail += ": " + result->detail;
  throw NoFinitePoint{detail};
}

}  // namespace lcpbench
