#include "solvers/active_set/active_set_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lcpbench {
namespace {

BppOptions Impatient(BppOptions options) {
  options.end_when_cycling = true;
  return options;
}

}  // namespace

ActiveSetOptions ActiveSetOptions::FromSettings(const Settings& settings) {
  ActiveSetOptions options;
  Settings rest = settings;
  if (const auto rows = rest.extract("continuation_rows"); !rows.empty()) {
    options.newton = SemismoothNewtonOptions::FromSettings({{rows.key(), rows.mapped()}}, "active-set");
  }
  options.blocks = BppOptions::FromSettings(rest, "active-set");
  options.newton.self_check = options.blocks.self_check;
  return options;
}

class ActiveSetEngine {
 public:
  explicit ActiveSetEngine(const ActiveSetOptions& options)
      : continuation_rows_(options.newton.continuation_rows),
        patient_(options.blocks),
        impatient_(Impatient(options.blocks)),
        newton_(options.newton) {}
  static constexpr bool kSolvesByFaces = true;

  std::string WhyUnsupported(const LcpProblem& problem) const { return patient_.WhyUnsupported(problem); }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
    if (arrays.rows >= continuation_rows_) return false;
    patient_.SolveArrays(arrays, options, result);
    return true;
  }

 private:
  bool IsLarge(const LcpProblem& problem) const { return problem.size() >= continuation_rows_; }

  Index continuation_rows_;
  BppSolver patient_;    // for problems that are not large
  BppSolver impatient_;  // ends where blocks cycle
  SemismoothNewtonSolver newton_;
  bool newton_is_prepared_ = false;
};

void ActiveSetEngine::Prepare(const LcpProblem& problem) {
  newton_is_prepared_ = false;
  (IsLarge(problem) ? impatient_ : patient_).Prepare(problem);
}

void ActiveSetEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!IsLarge(problem)) return patient_.Solve(problem, options, result);
  const Deadline deadline(options);
  impatient_.Solve(problem, options, result);
  if (result->status != LcpStatus::kNumericalFailure) return;
  if (!deadline.Expired() && !std::exchange(newton_is_prepared_, true)) newton_.Prepare(problem);
  LcpOptions rest = options;
  if (options.max_iterations > 0) rest.max_iterations = options.max_iterations - result->iterations;
  if (options.max_iterations > 0 && rest.max_iterations <= 0) {
    result->status = LcpStatus::kIterationLimit;
    return;
  }
  if (std::isfinite(options.time_limit_s)) {
    rest.time_limit_s = deadline.Remaining();
    if (rest.time_limit_s <= 0) {
      result->status = LcpStatus::kTimeLimit;
      return;
    }
  }
  LcpResult second;
  newton_.Solve(problem, rest, &second);
  second.iterations += result->iterations;
  *result = std::move(second);
}

template class EngineSolver<ActiveSetOptions, ActiveSetEngine>;

}  // namespace lcpbench
