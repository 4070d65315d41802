#include "solvers/friction/friction_answer.h"

#include "solvers/lcp/verify.h"

namespace lcpbench {

bool FrictionAnswer::Take(const PaddedVector& phi) {
  rows_.ComputeGaps(phi, &room_.gaps);
  return Take(phi, room_.gaps);
}

bool FrictionAnswer::Take(const PaddedVector& phi, const PaddedVector& gaps) {
  if (!phi.head(rows_.size()).allFinite()) return false;
  rows_.ToForces(phi, gaps, &room_.f);
  return Judge();
}

bool FrictionAnswer::TakeForces(const Eigen::VectorXd& f) {
  const Index n = rows_.size();
  room_.f.Lengthen(n);
  room_.f.head(n) = f.head(n);
  return Judge();
}

// Judges room_.f.
bool FrictionAnswer::Judge() {
  const auto f = room_.f.head(rows_.size());
  if (!f.allFinite()) return false;
  double rho = 0;
  const auto known = rows_.Judge(room_.f, options_.tolerance, &rho);
  bool passes = known == LawSums<double>::Known::kRight;
  if (known == LawSums<double>::Known::kUnclear && problem_ != nullptr) {
    const Metrics metrics = ComputeMetrics(*problem_, f);
    passes = PassesTier(metrics, options_.tolerance);
    rho = metrics.rho;
  }
  const bool has_passed = result_->status == LcpStatus::kSolved;
  if (passes == has_passed ? rho < rho_ : passes) {
    rho_ = rho;
    result_->f.head(rows_.size()) = f;
  }
  if (passes) result_->status = LcpStatus::kSolved;
  return passes;
}

bool FrictionAnswer::GetBest(PaddedVector* phi) const {
  if (rho_ == std::numeric_limits<double>::infinity()) return false;
  rows_.ToScaled(result_->f, phi);
  return true;
}

void FrictionAnswer::Fail(const char* detail) const {
  result_->detail = detail;
  // What rounding of sums in double hid.
  if (PassesTier(ComputeMetrics(*problem_, result_->f), options_.tolerance)) {
    result_->status = LcpStatus::kSolved;
    return;
  }
  const bool is_limited = options_.max_iterations > 0 && result_->iterations >= options_.max_iterations;
  result_->status = IsLate()     ? LcpStatus::kTimeLimit
                    : is_limited ? LcpStatus::kIterationLimit
                                 : LcpStatus::kNumericalFailure;
}

}  // namespace lcpbench
