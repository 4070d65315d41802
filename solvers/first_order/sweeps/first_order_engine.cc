#include "solvers/first_order/sweeps/first_order_engine.h"

#include <cmath>
#include <limits>

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {
namespace {

// At least every so many iterations there is a check. In between the residuals that a pass sees at each row's own
// moment tell when one is likely to succeed.
constexpr std::int64_t kCheckInterval = 32;
// Scaled forces below this share of the largest one can be rounding alone: a product of a row with up to some ten
// entries is off by that much.
constexpr double kNoise = 16 * std::numeric_limits<double>::epsilon();
// A last check at the time limit costs about two sweeps: within the tenth by which a solve may overrun after so many
// iterations.
constexpr std::int64_t kIterationsThatPayForACheck = 30;
// The first iterations say little about the rate of later ones.
constexpr std::int64_t kFirstLook = 8;

}  // namespace

std::string FirstOrderEngine::WhyUnsupported(const LcpProblem& problem) const {
  const std::string why = setup_.needs_symmetry ? WhyNotSymmetric(problem) : "";
  return why.empty() ? WhyNoRows(problem, setup_.form) : why;
}

void FirstOrderEngine::PrepareRows(const LcpProblem& problem) {
  rows_.Prepare(problem, setup_.form, setup_.coloured);
  given_.Reset(problem);
  best_.setZero(problem.size());
  candidate_.setZero(problem.size());
}

bool FirstOrderEngine::Expired() {
  unread_ = 0;
  return deadline_.has_value() && deadline_->Expired();
}

// True when the solve is over already, as the three that follow.
bool FirstOrderEngine::Begin(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  rows_.Start(problem, options.initial_f);
  deadline_.reset();
  if (std::isfinite(options.time_limit_s)) deadline_.emplace(options);
  chunk_ = std::max<Index>(1, kEntriesPerClockRead / rows_.rows->EntriesPerRow());
  unread_ = 0;
  given_.SetB(problem);
  tolerance_ = options.tolerance;
  limit_ = options.max_iterations > 0 ? options.max_iterations : setup_.default_limit;
  unchecked_ = 0;
  patience_ = 1;
  claimed_ = false;
  best_rho_ = std::numeric_limits<double>::infinity();
  best_ = rows_.x.f;
  result_ = result;
  if (Check()) return true;
  if (!Expired()) return false;
  result_->status = LcpStatus::kTimeLimit;
  return true;
}

// An iteration is done: counts it, and checks where that is due.
bool FirstOrderEngine::Continue(double residual) {
  ++result_->iterations;
  ++unchecked_;
  const bool last = result_->iterations >= limit_ || (setup_.end_when_hopeless && IsHopeless(residual));
  const bool promising = !(residual > tolerance_ * rows_.scaled.b_norm);  // NaN is to be looked at, too
  if (last || unchecked_ >= kCheckInterval || (promising && unchecked_ >= patience_)) {
    if (promising) patience_ = std::min(2 * patience_, kCheckInterval);
    unchecked_ = 0;
    if (Check()) return true;
    if (Expired()) {
      result_->status = LcpStatus::kTimeLimit;
      return true;
    }
  }
  if (last) result_->status = LcpStatus::kIterationLimit;
  return last;
}

// Whether the mean rate of convergence since iteration hopeful_iterations + 1 will not do within the limit. (The rate
// of the last iterations says less: it falls where the active set changes, and recovers.)
bool FirstOrderEngine::IsHopeless(double residual) {
  const std::int64_t k = result_->iterations - setup_.hopeful_iterations;
  if (k < 1 || (k > 1 && k < kFirstLook)) return false;
  const double log_residual = std::log(residual / (tolerance_ * rows_.scaled.b_norm));
  if (k == 1) {
    first_log_residual_ = log_residual;
    return false;
  }
  if (log_residual <= 0) return false;
  const double fallen = first_log_residual_ - log_residual;
  // iterations + still needed > limit
  return !(log_residual * static_cast<double>(k - 1) <= fallen * static_cast<double>(limit_ - result_->iterations));
}

// The time was up within an iteration, and f (not its image) is a valid iterate.
bool FirstOrderEngine::EndOutOfTime() {
  result_->status = LcpStatus::kTimeLimit;
  if (result_->iterations >= kIterationsThatPayForACheck) Check();
  return true;
}

bool FirstOrderEngine::Check() {
  const RowKernel& rows = *rows_.rows;
  const Index n = rows_.scaled.size;
  rows.MakeImage(n, &rows_.x);
  const double rho = std::sqrt(rows.ResidualSquares(0, n, rows_.x, nullptr)) / rows_.scaled.b_norm;
  if (!std::isfinite(rho)) {
    result_->status = LcpStatus::kNumericalFailure;
    result_->detail = "the iterates overflow";
    return true;
  }
  if (rho < best_rho_) {
    best_rho_ = rho;
    best_ = rows_.x.f;
  }
  if (rho > tolerance_ || !Claim()) return false;
  result_->status = LcpStatus::kSolved;
  claimed_ = true;
  return true;
}

bool FirstOrderEngine::Claim() {
  const Array& f = rows_.x.f;
  rows_.scaled.ToGiven(f, candidate_.data());
  if (!setup_.self_check || given_.Meets(tolerance_, candidate_)) return true;
  // Forces that are nothing but rounding of others fail the backward error of rows where the answer is 0 = 0.
  const double largest = f.cwiseAbs().maxCoeff();
  for (Index k = 0; k < f.size(); ++k) {
    if (std::abs(f[k]) <= kNoise * largest) candidate_[rows_.scaled.Given(k)] = 0;
  }
  return given_.Meets(tolerance_, candidate_);
}

void FirstOrderEngine::Finish() {
  if (claimed_) {
    result_->f = candidate_;
  } else {
    rows_.scaled.ToGiven(best_, result_->f.data());
  }
}

}  // namespace lcpbench
