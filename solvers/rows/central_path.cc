#include "solvers/rows/central_path.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {
namespace {

// Rounds, each with one factorization.
constexpr int kMostSteps = 30;
// Part of the way to the bounds that a step goes at most.
constexpr double kPartOfStep = 0.995;
// Least x and z at the start, in mean |x| + |b|.
constexpr double kStart = 0.03;

}  // namespace

void CentralPath::Reserve(Index max_rows) {
  if (gaps_.size() >= max_rows) return;
  all_.assign(static_cast<std::size_t>(max_rows), 1);
  for (auto* v : {&gaps_, &slack_, &corrector_, &direction_, &shift_}) v->resize(max_rows);
}

// x and z above 0, by x and its gaps.
void CentralPath::Start(Point* x) {
  const Index n = scaled_->size;
  double size = 0;
  for (Index i = 0; i < n; ++i) size += std::abs(x->f[i]) + std::abs(scaled_->b[i]);
  rows_->MakeImage(n, x);
  rows_->ResidualSquares(0, n, *x, &gaps_);
  const double least = kStart * size / static_cast<double>(n);
  for (Index i = 0; i < n; ++i) {
    slack_[i] = scaled_->IsFree(i) ? 0 : std::max(gaps_[i], least);
    if (!scaled_->IsFree(i)) x->f[i] = std::max(x->f[i], least);
  }
}

// The part of the way along `change` of x, and of z with it, on which x and z stay positive on contacts; at most 1.
double CentralPath::StepLength(const double* x, const double* change) const {
  double most = 1;
  for (Index i = 0; i < scaled_->size; ++i) {
    if (scaled_->IsFree(i)) continue;
    if (change[i] < 0) most = std::min(most, -x[i] / change[i]);
    const double dz = SlackChange(i, x, change);
    if (dz < 0) most = std::min(most, -slack_[i] / dz);
  }
  return most;
}

// One step of x and z, where x.z / contacts is mu.
void CentralPath::Step(double mu, double contacts, double* x) {
  const Index n = scaled_->size;
  double* const dx = direction_.data();
  corrector_.head(n).setZero();
  factor_->Factorize(all_.data(), ProfileFactor::kShift, shift_.data());
  direction_.head(n) = -gaps_.head(n);
  factor_->Solve(dx);
  const double affine = StepLength(x, dx);
  double mu_affine = 0;
  for (Index i = 0; i < n; ++i) {
    if (!scaled_->IsFree(i)) mu_affine += (x[i] + affine * dx[i]) * (slack_[i] + affine * SlackChange(i, x, dx));
  }
  mu_affine /= contacts;
  const double ratio = mu_affine / mu;
  const double target = ratio * ratio * ratio * mu;
  for (Index i = 0; i < n; ++i) {
    if (!scaled_->IsFree(i)) corrector_[i] = (target - dx[i] * SlackChange(i, x, dx)) / x[i];
    dx[i] = corrector_[i] - gaps_[i];
  }
  factor_->Solve(dx);
  const double length = std::min(1.0, kPartOfStep * StepLength(x, dx));
  for (Index i = 0; i < n; ++i) {
    if (!scaled_->IsFree(i)) slack_[i] += length * SlackChange(i, x, dx);
    x[i] += length * dx[i];
  }
}

std::int64_t CentralPath::Follow(const ScaledProblem& scaled, const RowKernel& rows, double enough,
                                 const Deadline* deadline, ProfileFactor* factor, Point* x) {
  scaled_ = &scaled;
  rows_ = &rows;
  factor_ = factor;
  const Index n = scaled.size;
  Start(x);
  std::int64_t steps = 0;
  for (; steps < kMostSteps && (deadline == nullptr || !deadline->Expired()); ++steps) {
    rows.MakeImage(n, x);
    const double residual = std::sqrt(rows.ResidualSquares(0, n, *x, &gaps_));
    double mu = 0;
    double contacts = 0;
    for (Index i = 0; i < n; ++i) {
      const bool is_joint = scaled.IsFree(i);
      shift_[i] = is_joint ? 0 : slack_[i] / x->f[i];
      mu += is_joint ? 0 : x->f[i] * slack_[i];
      contacts += is_joint ? 0 : 1;
    }
    mu /= contacts;
    if (residual <= enough || !(mu > 0)) break;
    Step(mu, contacts, x->f.data());
  }
  rows.MakeImage(n, x);
  return steps;
}

}  // namespace lcpbench
