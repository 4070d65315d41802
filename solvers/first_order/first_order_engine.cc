#include "solvers/first_order/first_order_engine.h"

#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/engine_solver.h"
#include "support/array_index.h"

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
  const bool needs_symmetry = setup_.needs_symmetry || !problem.is_plain();
  const std::string why = needs_symmetry ? WhyNotSymmetric(problem) : "";
  return why.empty() ? WhyNoRows(problem, setup_.form) : why;
}

void FirstOrderEngine::PrepareRows(const LcpProblem& problem) {
  TwoBodyCopy copy;
  const bool is_copied = problem.has_two_body_rows() && copy.Take(problem.view());
  rows_.Prepare(problem, setup_.form, setup_.coloured, is_copied ? &copy.rows() : nullptr);
  given_.Reset(problem);
  // What given_ asks for is made now, not in a solve.
  problem.DiagonalA();
  problem.b();
  problem.bilateral_rows();
  if (problem.has_factors()) problem.inverse_mass();
  best_.setZero(problem.size());
}

void FirstOrderEngine::TakeProblem(const LcpProblem& problem, const LcpOptions& options) {
  rows_.Start(problem.b().data(), options.initial_f);
  given_.SetB(problem);
  task_ = nullptr;
}

bool FirstOrderEngine::TakeRows(const RowTask& task) {
  if (setup_.form == RowForm::kAssembled || !rows_.Take(task.rows, setup_.coloured)) return false;
  task_ = &task;
  if (best_.size() < task.rows.rows) best_.resize(task.rows.rows);
  rows_.Start(task.rows.b, task.options.initial_f);
  return true;
}

bool FirstOrderEngine::Expired() {
  unread_ = 0;
  if (!Deadline::IsNeeded(*options_)) return false;
  if (!deadline_.has_value()) deadline_.emplace(*options_);
  return deadline_->Expired();
}

// True when the solve is over already, as the three that follow.
bool FirstOrderEngine::Start(const LcpOptions& options, LcpResult* result) {
  options_ = &options;
  deadline_.reset();
  chunk_ = std::max<Index>(1, kEntriesPerClockRead / rows_.rows->EntriesPerRow());
  // Few rows of a step are mostly done before the clock would be read: it starts then, some 20 us late.
  const bool is_short = task_ != nullptr && 2 * rows_.scaled.size < chunk_;
  if (!is_short && Deadline::IsNeeded(options)) deadline_.emplace(options);
  unread_ = 0;
  tolerance_ = options.tolerance;
  limit_ = options.max_iterations > 0 ? options.max_iterations : setup_.default_limit;
  unchecked_ = 0;
  patience_ = 1;
  claimed_ = false;
  best_rho_ = std::numeric_limits<double>::infinity();
  best_.head(rows_.scaled.size) = rows_.x.f.head(rows_.scaled.size);
  result_ = result;
  if (Check()) return true;
  if (is_short || !Expired()) return false;
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
    if (Check()) return true;
    // Few checks come earlier, and count as rows that the clock is read after.
    const bool is_regular = std::exchange(unchecked_, 0) >= kCheckInterval;
    if (is_regular && Expired()) {
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
  unread_ = std::min(unread_ + 2 * n, chunk_ - 1);
  rows.MakeImage(n, &rows_.x);
  const double rho = std::sqrt(rows.ResidualSquares(0, n, rows_.x, nullptr)) / rows_.scaled.b_norm;
  if (!std::isfinite(rho)) {
    result_->status = LcpStatus::kNumericalFailure;
    result_->detail = "the iterates overflow";
    return true;
  }
  if (rho < best_rho_) {
    best_rho_ = rho;
    best_.head(rows_.scaled.size) = rows_.x.f.head(rows_.scaled.size);
  }
  if (rho > tolerance_ || !Claim()) return false;
  result_->status = LcpStatus::kSolved;
  claimed_ = true;
  return true;
}

bool FirstOrderEngine::Claim() {
  const ScaledProblem& scaled = rows_.scaled;
  const auto f = rows_.x.f.head(scaled.size);
  scaled.ToGiven(rows_.x.f, result_->f.data());
  if (Passes()) return true;
  // Forces that are nothing but rounding of others fail the backward error of rows where the answer is 0 = 0.
  const double largest = f.cwiseAbs().maxCoeff();
  for (Index k = 0; k < scaled.size; ++k) {
    if (std::abs(f[k]) <= kNoise * largest) result_->f[scaled.Given(k)] = 0;
  }
  return Passes();
}

// By the given form.
bool FirstOrderEngine::Passes() {
  if (task_ == nullptr) return given_.Meets(tolerance_, result_->f);
  double rho = 0;
  return task_->judge.Passes(task_->rows, task_->all, tolerance_, result_->f.data(), task_->w, &rho);
}

void FirstOrderEngine::Finish() {
  if (!claimed_) rows_.scaled.ToGiven(best_, result_->f.data());
}

}  // namespace lcpbench
