#include "solvers/pivot_base.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Forces below this multiple of the largest D^1/2 f are looked at more closely: are they rounding only?
constexpr double kSmallForce = 1e-10;
// Entries of a warm start enter F above this multiple of the largest D^1/2 f (an interior point leaves no zeros).
constexpr double kWarmThreshold = 1e-10;
// Infeasibility is reported where the residual is above this, or above the tolerance if that is less: a proof holds at
// every tolerance, but a problem that is infeasible by rounding only shall be solved.
constexpr double kProofTolerance = 1e-9;
constexpr int kRayRefinements = 3;
// Multiply-adds between two looks at the clock (some 10 us), and what a pivot costs besides them.
constexpr Index kWorkPerClockRead = 16384;
constexpr Index kWorkPerPivot = 256;

}  // namespace

void PivotBase::Reserve(Index max_rows) {
  active_.Reserve(max_rows);
  if (max_rows > root_.size()) root_.resize(max_rows);
}

void PivotBase::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  Reserve(problem.size());
  judge_.Reset(problem, true);
}

void PivotBase::Start(const LcpOptions& options, std::int64_t pivot_limit) {
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  initial_f_ = options.initial_f;
  deadline_.reset();
  if (std::isfinite(options.time_limit_s)) deadline_.emplace(options);
  work_left_ = 0;
  pivots_ = 0;
  pivot_limit_ = options.max_iterations > 0 ? options.max_iterations : pivot_limit;
  judge_.Start(tolerance_);
}

bool PivotBase::TimeIsUp(Index work) {
  if (!deadline_.has_value()) return false;
  work_left_ -= work + kWorkPerPivot;
  if (work_left_ >= 0) return false;
  work_left_ = kWorkPerClockRead;
  return deadline_->Expired();
}

bool PivotBase::Load(double rank_tolerance) {
  rank_tolerance_ = rank_tolerance;
  if (!lcp_.Load(*problem_)) return false;
  active_.Reset();
  joints_ = 0;
  open_ = lcp_.nonzero;
  unit_ = lcp_.nonzero > 0 ? lcp_.diagonal[0] : 1.0;
  for (Index p = 0; p < lcp_.nonzero; ++p) root_[RowAt(p)] = std::sqrt(lcp_.diagonal[p] / unit_);
  return true;
}

PivotBase::End PivotBase::EnterJoints(LcpResult* result) {
  Index end = lcp_.bilateral;
  while (m() < end) {
    if (TimeIsUp(m() * m())) return End::kTimeLimit;
    const Index p = m();
    const double pivot = active_.SetDriven(p);
    if (pivot > rank_tolerance_ * active_.Direction(p)) {
      active_.EnterDriven(p, pivot);
    } else {
      lcp_.Swap(p, --end);
    }
  }
  joints_ = m();
  if (m() > 0) active_.SolveForces();
  for (Index p = m(); p < lcp_.bilateral; ++p) {
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    if (std::abs(w.value) <= kNoise * w.magnitude || lcp_.ResidualShare(p, w.value) <= proof_tolerance_) continue;
    active_.SetDriven(p);
    active_.Direction(p);
    if (ClaimRay(p, w.value < 0 ? 1 : -1, result)) return End::kInfeasible;
  }
  for (Index p = lcp_.bilateral; p > m();) lcp_.Swap(--p, --open_);
  return End::kDone;
}

PivotBase::End PivotBase::EnterWarmRows() {
  if (initial_f_ == nullptr) return End::kDone;
  const auto size = [this](Index p) { return ForceRoot(p) * lcp_.ScaledForce(p, (*initial_f_)[RowAt(p)]); };
  double largest = 0;
  for (Index p = m(); p < open_; ++p) largest = std::max(largest, size(p));
  for (Index p = m(); p < open_; ++p) {
    if (!(size(p) > kWarmThreshold * largest)) continue;
    if (TimeIsUp(m() * m())) return End::kTimeLimit;
    const double pivot = active_.SetDriven(p);
    if (pivot > rank_tolerance_ * active_.Direction(p)) active_.EnterDriven(p, pivot);
  }
  return End::kDone;
}

void PivotBase::SolveForces(bool at_once) {
  for (bool again = true; again;) {
    again = false;
    const double largest = active_.SolveForces();
    Index worst = kNoRow;
    double least = kInfinity;
    for (Index p = m() - 1; p >= joints_; --p) {
      const double size = lcp_.f[p] * ForceRoot(p);
      if (!at_once && size >= least) continue;
      if (lcp_.f[p] >= 0) {
        if (lcp_.diagonal[p] * lcp_.f[p] * lcp_.f[p] > kSmallForce * kSmallForce * largest) continue;
        if (lcp_.diagonal[p] * lcp_.f[p] > kNoise * lcp_.FreshW(p, m()).magnitude) continue;
      }
      if (at_once) {
        Release(p);
        again = true;
      } else {
        least = size;
        worst = p;
      }
    }
    if (worst != kNoRow) {
      Release(worst);
      again = true;
    }
  }
}

void PivotBase::Release(Index p) {
  lcp_.f[p] = 0;
  lcp_.w[p] = 0;
  active_.Leave(p);
}

double PivotBase::ComputeGaps() {
  double worst = 0;
  for (Index p = 0; p < m(); ++p) lcp_.w[p] = 0;
  for (Index p = m(); p < open_; ++p) {
    const PermutedLcp::Sum w = lcp_.FreshW(p, m());
    lcp_.f[p] = 0;
    lcp_.w[p] = w.value;
    if (std::abs(w.value) <= kNoise * w.magnitude) {
      lcp_.w[p] = 0;
    } else if (w.value < 0) {
      worst = std::max(worst, -w.value / GapRoot(p));
    }
  }
  return worst;
}

bool PivotBase::Publish(LcpResult* result) {
  Eigen::VectorXd& f = judge_.candidate();
  f.setZero();
  for (Index p = 0; p < lcp_.nonzero; ++p) f[RowAt(p)] = lcp_.GivenForce(p);
  return judge_.Publish(result);
}

void PivotBase::Refine() {
  for (Index p = 0; p < m(); ++p) lcp_.w[p] = lcp_.ScaledW(p, judge_.w()[RowAt(p)]);
  active_.CorrectForces();
  for (Index p = joints_; p < m(); ++p) lcp_.f[p] = std::max(lcp_.f[p], 0.0);
}

bool PivotBase::ClaimRay(Index d, double sign, LcpResult* result) {
  const auto count = static_cast<size_t>(m());
  std::vector<long double> y(active_.df(), active_.df() + m());
  std::vector<long double> residual(count);
  std::vector<double> correction(count);
  Eigen::VectorXd ray(lcp_.n);
  for (int pass = 0;; ++pass) {
    ray.setZero();
    const auto set = [&](Index p, double value) { ray[RowAt(p)] = sign * value * lcp_.scale[RowAt(p)]; };
    for (Index p = 0; p < m(); ++p) {
      const auto value = static_cast<double>(y[static_cast<size_t>(p)]);
      set(p, p < joints_ ? value : std::max(value, 0.0));
    }
    set(d, 1);
    if (VerifyFarkasRay(*problem_, ray).accepted) {
      result->farkas_ray = std::move(ray);
      return true;
    }
    if (pass == kRayRefinements) return false;
    std::copy(lcp_.column(d), lcp_.column(d) + m(), residual.begin());
    for (size_t j = 0; j < count; ++j) {
      const double* c = lcp_.column(static_cast<Index>(j));
      for (size_t p = 0; p < count; ++p) residual[p] += c[p] * y[j];
    }
    correction.assign(residual.begin(), residual.end());
    active_.SolveSystem(correction.data());
    for (size_t p = 0; p < count; ++p) y[p] -= correction[p];
  }
}

}  // namespace lcpbench
