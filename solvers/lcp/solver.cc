#include "solvers/lcp/solver.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/in_sequence.h"
#include "solvers/lcp/memory_budget.h"
#include "support/cancellation.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr std::array<std::pair<LcpStatus, std::string_view>, 7> kStatusKeys{{
    {LcpStatus::kNotRun, "not_run"},
    {LcpStatus::kSolved, "solved"},
    {LcpStatus::kInfeasible, "infeasible"},
    {LcpStatus::kIterationLimit, "iteration_limit"},
    {LcpStatus::kTimeLimit, "time_limit"},
    {LcpStatus::kNumericalFailure, "numerical_failure"},
    {LcpStatus::kUnsupported, "unsupported"},
}};

void CheckOptions(Index rows, const LcpOptions& options) {
  const auto require = [](bool holds, const std::string_view what, auto found) {
    if (!holds) throw InputError(std::string(what) + ", found " + std::to_string(found));
  };
  require(options.tolerance > 0 && options.tolerance < 1, "tolerance must be in (0, 1)", options.tolerance);
  require(options.time_limit_s > 0, "time limit must be > 0 s", options.time_limit_s);
  require(options.max_iterations >= 0, "iteration limit must be >= 0", options.max_iterations);
  if (options.initial_f == nullptr) return;
  const Index size = options.initial_f->size();
  if (size != rows) require(false, "initial f must have " + std::to_string(rows) + " entries", size);
  if (!options.initial_f->allFinite()) throw InputError("initial f must be finite");
}

void StartResult(Index rows, LcpResult* result) {
  result->f.setZero(rows);
  result->model = FrictionModel::kCoulomb;
  result->friction_bounds.resize(0);
  result->iterations = 0;
  result->detail.clear();
  result->own_solve_s = -1;
  result->own_convert_s = -1;
  result->own_fresh_s = -1;
  result->factor_s = -1;
  result->farkas_ray.reset();
}

}  // namespace

std::string_view ToString(LcpStatus status) {
  for (const auto& [value, key] : kStatusKeys) {
    if (value == status) return key;
  }
  return "unknown";
}

LcpStatus LcpStatusFromString(std::string_view key) {
  for (const auto& [value, name] : kStatusKeys) {
    if (name == key) return value;
  }
  throw InputError("unknown status '" + std::string(key) + "'");
}

bool Deadline::IsNeeded(const LcpOptions& options) {
  return std::isfinite(options.time_limit_s) || Cancellation::IsPossible();
}
Deadline::Deadline(const LcpOptions& options) : now_(options.now), start_(now_()), limit_(options.time_limit_s) {}
bool Deadline::Expired() const { return Elapsed() >= limit_; }
double Deadline::Elapsed() const {
  Cancellation::Check();
  return now_() - start_;
}
double Deadline::Remaining() const { return std::max(0.0, limit_ - Elapsed()); }
double Deadline::RestOfLimit() const { return std::max(std::numeric_limits<double>::min(), limit_ - Elapsed()); }

std::string LcpSolver::WhyUnsupported(const LcpProblem& /*problem*/) const { return {}; }
void LcpSolver::Reserve(Index /*max_rows*/) {}

std::string LcpSolver::WhyRefused(const LcpProblem& problem) const {
  if (!problem.friction_rows().empty() && !TakesFriction()) return "friction rows";
  if (!problem.bounded_rows().empty() && !TakesBounded()) return "bounded rows";
  return WhyUnsupported(problem);
}

void LcpSolver::Prepare(const LcpProblem& problem) {
  if (prepared_.has_value() && prepared_->SharesMatrixWith(problem)) return;
  prepared_.reset();
  if (problem.size() == 0 || IsByFaces(problem) || !WhyRefused(problem).empty()) return;
  const InSequence::Scope sequence(in_sequence_);
  DoPrepare(problem);
  prepared_ = problem;
}

void LcpSolver::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  CheckOptions(problem.size(), options);
  StartResult(problem.size(), result);
  if (problem.size() == 0) {
    result->status = LcpStatus::kSolved;
    return;
  }
  result->status = LcpStatus::kNumericalFailure;
  try {
    if (IsByFaces(problem) && WhyRefused(problem).empty()) return SolveByFaces(problem, options, result);
    Prepare(problem);
    if (!prepared_.has_value()) {
      result->status = LcpStatus::kUnsupported;
      result->detail = WhyRefused(problem);
      return;
    }
    const InSequence::Scope sequence(in_sequence_);
    const FactorClock::Session clock(options.time_factorizations);
    DoSolve(problem, options, result);
    // What another process solves it factorizes there.
    const bool is_known = result->own_solve_s < 0 && !std::isnan(clock.seconds());
    if (options.time_factorizations && is_known) result->factor_s = clock.seconds();
  } catch (const Cancelled&) {
    prepared_.reset();  // what the solve had prepared besides may be half done
    throw;
  } catch (const MemoryRefusal& refusal) {
    result->status = LcpStatus::kUnsupported;
    result->detail = refusal.what();
    result->f.setZero(problem.size());
  } catch (const std::exception& error) {
    result->status = LcpStatus::kNumericalFailure;
    result->detail = error.what();
    if (result->f.size() != problem.size()) result->f.setZero(problem.size());
  }
}

bool LcpSolver::DoSolveArrays(const ProblemArrays& /*arrays*/, const LcpOptions& /*options*/, LcpResult* /*result*/) {
  return false;
}

void LcpSolver::SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  CheckOptions(arrays.rows, options);
  if (arrays.rows > 0) {
    StartResult(arrays.rows, result);
    result->status = LcpStatus::kNumericalFailure;
    prepared_.reset();  // DoSolveArrays may use what was prepared for other arrays
    try {
      const bool is_plain = arrays.friction.empty() && arrays.bounded.empty();
      const bool is_read = is_plain || (TakesFriction() && !arrays.friction.empty());
      if (is_read && DoSolveArrays(arrays, options, result)) return;
    } catch (const InputError&) {
      throw;
    } catch (const MemoryRefusal& refusal) {
      result->status = LcpStatus::kUnsupported;
      result->detail = refusal.what();
      return;
    } catch (const std::exception& error) {
      result->detail = error.what();
      return;
    }
  }
  Solve(LcpProblem::FromArrays(arrays), options, result);
}

}  // namespace lcpbench
