#include "solvers/exact/exact_solver.h"

#include <mpfr.h>

#include <limits>
#include <utility>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

ExactOptions AnswerOnly(const LcpOptions& options, double elapsed_s) {
  ExactOptions exact;
  exact.answer_only = true;
  exact.time_limit_s = options.time_limit_s - elapsed_s;
  exact.now = options.now;
  return exact;
}

}  // namespace

double RoundToNearest(const Rational& value) {
  mpfr_t rounded;
  mpfr_init2(rounded, std::numeric_limits<double>::digits);
  // Subnormal results have fewer digits: rounded once, to what they have.
  const mpfr_exp_t least = mpfr_get_emin();
  const mpfr_exp_t largest = mpfr_get_emax();
  mpfr_set_emin(std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits + 1);
  mpfr_set_emax(std::numeric_limits<double>::max_exponent);
  const int direction = mpfr_set_q(rounded, value.backend().data(), MPFR_RNDN);
  mpfr_subnormalize(rounded, direction, MPFR_RNDN);
  const double result = mpfr_get_d(rounded, MPFR_RNDN);
  mpfr_set_emin(least);
  mpfr_set_emax(largest);
  mpfr_clear(rounded);
  return result;
}

Eigen::VectorXd Rounded(const std::vector<Rational>& values) {
  Eigen::VectorXd rounded(static_cast<Index>(values.size()));
  for (Index i = 0; i < rounded.size(); ++i) rounded[i] = RoundToNearest(values[static_cast<size_t>(i)]);
  return rounded;
}

std::string ExactSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > kMostExactRows) {
    return "more than " + std::to_string(kMostExactRows) + " rows";
  }
  if (problem.has_factors()) return {};
  if (problem.Asymmetry() != 0) return "A is not symmetric to the last bit";
  const Index most = ExactOptions{}.most_rows_of_proofs;
  if (problem.size() > most) {
    return "a matrix of more than " + std::to_string(most) + " rows is not proved to be positive semidefinite";
  }
  return {};
}

void ExactSolver::DoPrepare(const LcpProblem& problem) { exact_ = ExactFrom(problem); }

// The nearly exact answer to a problem that one rounding makes unsolvable; false where it does not pass the tolerance.
bool ExactSolver::SolveContradiction(const LcpProblem& problem, const LcpOptions& options, double elapsed_s,
                                     LcpResult* result) {
  ExactLcp regular = *exact_;
  for (Index i = 0; i < regular.size; ++i) {
    regular.A[static_cast<size_t>(i * regular.size + i)] *= 1 + Rational(kProximal);
  }
  const ExactAnswer answer = SolveExactly(regular, AnswerOnly(options, elapsed_s));
  result->iterations += answer.pivots;
  if (answer.status != ExactAnswer::Status::kSolved) return false;
  Eigen::VectorXd f = Rounded(answer.f);
  if (!PassesTier(ComputeMetrics(problem, f), options.tolerance)) return false;
  result->f = std::move(f);
  return true;
}

void ExactSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  const ExactAnswer answer = SolveExactly(*exact_, AnswerOnly(options, 0));
  result->iterations = answer.pivots;
  result->detail = answer.detail;
  switch (answer.status) {
    case ExactAnswer::Status::kSolved:
      result->f = Rounded(answer.f);
      result->status = LcpStatus::kSolved;
      if (result->f.allFinite()) break;
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "a force is beyond the range of doubles";
      break;
    case ExactAnswer::Status::kInfeasible:
      if (SolveContradiction(problem, options, deadline.Elapsed(), result)) {
        result->status = LcpStatus::kSolved;
        result->detail = "contradicts itself by a rounding: solved to the tolerance";
        break;
      }
      result->status = LcpStatus::kInfeasible;
      result->farkas_ray = Rounded(answer.ray);
      break;
    case ExactAnswer::Status::kNotSemidefinite:
      result->status = LcpStatus::kUnsupported;
      if (result->detail.empty()) result->detail = "A is not positive semidefinite";
      break;
    case ExactAnswer::Status::kTimeLimit:
      result->status = LcpStatus::kTimeLimit;
      break;
  }
}

}  // namespace lcpbench
