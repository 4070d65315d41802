#include "solvers/first_order/sweeps/stopping_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

// Scaled forces below this share of the largest one can be rounding alone: a product of a row with up to some ten
// entries is off by that much.
constexpr double kNoise = 16 * std::numeric_limits<double>::epsilon();
// A last check at the time limit costs about two sweeps: within the tenth by which a solve may overrun after so many
// iterations.
constexpr std::int64_t kIterationsThatPayForACheck = 30;
// The first iterations say little about the rate of later ones.
constexpr std::int64_t kFirstLook = 8;

}  // namespace

void StoppingTest::Prepare(const LcpProblem& problem) {
  given_.Reset(problem);
  best_.assign(static_cast<size_t>(problem.size()), 0.0);
  candidate_.setZero(problem.size());
}

bool StoppingTest::Begin(const LcpProblem& problem, const LcpOptions& options, std::int64_t default_limit,
                         RowWork* work, PacedPasses* passes, LcpResult* result) {
  given_.SetB(problem);
  tolerance_ = options.tolerance;
  limit_ = options.max_iterations > 0 ? options.max_iterations : default_limit;
  unchecked_ = 0;
  patience_ = 1;
  claimed_ = false;
  best_rho_ = std::numeric_limits<double>::infinity();
  best_ = work->f;
  work_ = work;
  passes_ = passes;
  result_ = result;
  if (Check()) return true;
  if (!passes_->Expired()) return false;
  result_->status = LcpStatus::kTimeLimit;
  return true;
}

bool StoppingTest::Continue(double residual) {
  ++result_->iterations;
  ++unchecked_;
  const bool last = result_->iterations >= limit_ || (ends_when_hopeless_ && IsHopeless(residual));
  const bool promising = !(residual > tolerance_ * work_->scaled.b_norm);  // NaN is to be looked at, too
  if (last || unchecked_ >= kCheckInterval || (promising && unchecked_ >= patience_)) {
    if (promising) patience_ = std::min(2 * patience_, kCheckInterval);
    unchecked_ = 0;
    if (Check()) return true;
    if (passes_->Expired()) {
      result_->status = LcpStatus::kTimeLimit;
      return true;
    }
  }
  if (last) result_->status = LcpStatus::kIterationLimit;
  return last;
}

bool StoppingTest::IsHopeless(double residual) {
  const std::int64_t k = result_->iterations - hopeful_iterations_;
  if (k < 1 || (k > 1 && k < kFirstLook)) return false;
  const double log_residual = std::log(residual / (tolerance_ * work_->scaled.b_norm));
  if (k == 1) {
    first_log_residual_ = log_residual;
    return false;
  }
  if (log_residual <= 0) return false;
  const double fallen = first_log_residual_ - log_residual;
  // iterations + still needed > limit
  return !(log_residual * static_cast<double>(k - 1) <= fallen * static_cast<double>(limit_ - result_->iterations));
}

void StoppingTest::EndOutOfTime() {
  result_->status = LcpStatus::kTimeLimit;
  if (result_->iterations < kIterationsThatPayForACheck) return;
  Check();
}

// True when the solve is over; the status says how.
bool StoppingTest::Check() {
  const RowKernel& rows = *work_->rows;
  const Index n = work_->scaled.size;
  rows.StartImage(&work_->image);
  rows.AddToImage(0, n, work_->f, &work_->image);
  const double rho = std::sqrt(rows.ResidualSquares(0, n, work_->f, work_->image)) / work_->scaled.b_norm;
  if (!std::isfinite(rho)) {
    result_->status = LcpStatus::kNumericalFailure;
    result_->detail = "the iterates overflow";
    return true;
  }
  if (rho < best_rho_) {
    best_rho_ = rho;
    best_ = work_->f;
  }
  if (rho > tolerance_ || !Claim()) return false;
  result_->status = LcpStatus::kSolved;
  claimed_ = true;
  return true;
}

bool StoppingTest::Claim() {
  work_->scaled.ToGiven(work_->f, &candidate_);
  if (!self_check_) return true;
  if (given_.Meets(tolerance_, candidate_)) return true;
  // Forces that are nothing but rounding of others fail the backward error of rows where the answer is 0 = 0.
  double largest = 0;
  for (const double force : work_->f) largest = std::max(largest, std::abs(force));
  for (Index k = 0; k < work_->scaled.size; ++k) {
    if (std::abs(work_->f[static_cast<size_t>(k)]) <= kNoise * largest) candidate_[work_->scaled.Given(k)] = 0;
  }
  return given_.Meets(tolerance_, candidate_);
}

void StoppingTest::Finish() {
  if (claimed_) {
    result_->f = candidate_;
  } else {
    work_->scaled.ToGiven(best_, &result_->f);
  }
}

}  // namespace lcpbench
