#include "solvers/friction/friction_answer.h"

#include "solvers/lcp/verify.h"

namespace lcpbench {

bool FrictionAnswer::Take(const Eigen::VectorXd& phi) {
  if (!phi.allFinite()) return false;
  rows_.ComputeGaps(phi, &gaps_);
  rows_.ToForces(phi, gaps_, &f_);
  return Judge(rows_.Rho(phi, gaps_));
}

bool FrictionAnswer::TakeForces(const Eigen::VectorXd& f) {
  f_ = f;
  rows_.ToScaled(f, &phi_);
  rows_.ComputeGaps(phi_, &gaps_);
  return Judge(rows_.Rho(phi_, gaps_));
}

// Of f_; rho in double.
bool FrictionAnswer::Judge(double rho) {
  constexpr double kNear = 10;
  if (!f_.allFinite()) return false;
  bool passes = rows_.IsSurelyRight(f_, options_.tolerance);
  if (!passes && rho <= kNear * options_.tolerance) {
    const Metrics metrics = ComputeMetrics(problem_, f_);
    passes = PassesTier(metrics, options_.tolerance);
    rho = metrics.rho;
  }
  const bool has_passed = result_->status == LcpStatus::kSolved;
  if (passes == has_passed ? rho < rho_ : passes) {
    rho_ = rho;
    result_->f.swap(f_);
  }
  if (passes) result_->status = LcpStatus::kSolved;
  return passes;
}

bool FrictionAnswer::GetBest(Eigen::VectorXd* phi) const {
  if (rho_ == std::numeric_limits<double>::infinity()) return false;
  rows_.ToScaled(result_->f, phi);
  return true;
}

void FrictionAnswer::Fail(const char* detail) const {
  result_->detail = detail;
  // What rounding of sums in double hid.
  if (PassesTier(ComputeMetrics(problem_, result_->f), options_.tolerance)) {
    result_->status = LcpStatus::kSolved;
    return;
  }
  const bool is_limited = options_.max_iterations > 0 && result_->iterations >= options_.max_iterations;
  result_->status = IsLate()     ? LcpStatus::kTimeLimit
                    : is_limited ? LcpStatus::kIterationLimit
                                 : LcpStatus::kNumericalFailure;
}

}  // namespace lcpbench
