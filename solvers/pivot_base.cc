#include "solvers/pivot_base.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/zero_row_ray.h"

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
// Factors on rank_tolerance for the first attempt and the restarts.
constexpr double kAttempts[] = {1.0, 1e-2, 1e3};
constexpr std::int64_t kPivotsPerRow = 50;
constexpr std::int64_t kExtraPivots = 1000;
// Multiply-adds between two looks at the clock (some 10 us), and what a pivot costs besides them.
constexpr Index kWorkPerClockRead = 16384;
constexpr Index kWorkPerPivot = 256;

}  // namespace

void PivotBase::Reserve(Index max_rows) { active_.Reserve(max_rows); }

void PivotBase::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  Reserve(problem.size());
  judge_.Reset(problem, true);
}

void PivotBase::Start(const LcpOptions& options) {
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  initial_f_ = options.initial_f;
  deadline_.reset();
  if (std::isfinite(options.time_limit_s)) deadline_.emplace(options);
  work_left_ = 0;
  pivots_ = 0;
  pivot_limit_ = options.max_iterations > 0 ? options.max_iterations : kPivotsPerRow * problem_->size() + kExtraPivots;
  judge_.Start(tolerance_);
}

bool PivotBase::TimeIsUp(Index work) {
  if (!deadline_.has_value()) return false;
  work_left_ -= work + kWorkPerPivot;
  if (work_left_ >= 0) return false;
  work_left_ = kWorkPerClockRead;
  return deadline_->Expired();
}

bool PivotBase::Load() {
  if (!lcp_.Load(*problem_)) return false;
  active_.Reset();
  joints_ = 0;
  open_ = lcp_.nonzero;
  unit_ = lcp_.nonzero > 0 ? lcp_.diagonal[0] : 1.0;
  return true;
}

void PivotBase::Solve(const LcpOptions& options, LcpResult* result) {
  Start(options);
  End end = End::kNotMet;
  char text[160];
  for (const double factor : kAttempts) {
    if (end != End::kNotMet) break;
    rank_tolerance_ = first_rank_tolerance_ * factor;
    if (!Load()) {
      result->status = LcpStatus::kUnsupported;
      result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
      return;
    }
    result->farkas_ray = FindZeroRowRay(*problem_, proof_tolerance_ * lcp_.b_norm);
    if (result->farkas_ray.has_value()) {
      result->status = LcpStatus::kInfeasible;
      return;
    }
    end = Run(result);
    if (factor != kAttempts[0] && end == End::kDone) {
      std::snprintf(text, sizeof text, "solved after a restart with rank tolerance %.0e", rank_tolerance_);
      result->detail = text;
    }
  }
  result->iterations = pivots_;
  switch (end) {
    case End::kDone:
      result->status = LcpStatus::kSolved;
      result->farkas_ray.reset();
      break;
    case End::kInfeasible:
      result->status = LcpStatus::kInfeasible;
      break;
    case End::kIterationLimit:
      result->status = LcpStatus::kIterationLimit;
      break;
    case End::kTimeLimit:
      result->status = LcpStatus::kTimeLimit;
      break;
    case End::kStuck:
    case End::kNotMet:
      result->status = LcpStatus::kNumericalFailure;
      std::snprintf(text, sizeof text,
                    "residual %.1e above the tolerance for rank tolerances %.0e, %.0e and %.0e, and no proven ray",
                    judge_.tier(), first_rank_tolerance_, first_rank_tolerance_ * kAttempts[1],
                    first_rank_tolerance_ * kAttempts[2]);
      result->detail = text;
      break;
  }
}

PivotBase::End PivotBase::Conclude(End end) const {
  if (judge_.tier() <= (end == End::kInfeasible ? proof_tolerance_ : tolerance_)) return End::kDone;
  return end == End::kDone ? End::kNotMet : end;
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

// Whether a unilateral row of F with force f has no business there: f < 0, or f > 0 by rounding only.
PivotBase::Surplus PivotBase::FindSurplus(Index p, double largest, bool judge_by_size) const {
  const double f = lcp_.f[p];
  if (f < 0) return Surplus::kNegative;
  const double size = lcp_.diagonal[p] * f * f;
  if (size > kSmallForce * kSmallForce * largest) return Surplus::kNone;
  if (judge_by_size && size <= kNoise * kNoise * largest) return Surplus::kTiny;
  return lcp_.diagonal[p] * f > kNoise * lcp_.FreshW(p, m()).magnitude ? Surplus::kNone : Surplus::kRounding;
}

bool PivotBase::SolveForces(Leaving leaving) {
  bool dropped_by_size = false;
  for (bool again = true; again;) {
    again = false;
    const double largest = active_.SolveForces();
    Index worst = kNoRow;
    double least = kInfinity;
    for (Index p = m() - 1; p >= joints_; --p) {
      const Surplus surplus = FindSurplus(p, largest, leaving == Leaving::kAllAndTiny);
      if (surplus == Surplus::kNone) continue;
      if (leaving == Leaving::kOneByOne) {
        const double size = lcp_.f[p] * ForceRoot(p);
        if (size >= least) continue;
        least = size;
        worst = p;
        continue;
      }
      dropped_by_size = dropped_by_size || surplus == Surplus::kTiny;
      Release(p);
      again = true;
    }
    if (worst != kNoRow) {
      Release(worst);
      again = true;
    }
  }
  return dropped_by_size;
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
