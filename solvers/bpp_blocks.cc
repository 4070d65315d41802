#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/bpp_engine.h"

namespace lcpbench {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A gap is rounding only up to this multiple of |D^1/2 f|_1 + |D^-1/2 b|_inf, in D^1/2.
constexpr double kNoise = 64 * kEpsilon;
// A force of the shifted problem is rounding only up to this multiple of epsilon / shift times the largest: that much a
// dependent row amplifies.
constexpr double kForceNoise = 8;
// Conjugate gradients end when the residual is rounding, or after so many steps.
constexpr int kMaxCorrections = 12;
// ... or when the residual falls by less than this.
constexpr double kSlowCorrection = 0.5;
// Curvature y.A y below this multiple of y.D y: the direction is in the null space.
constexpr double kNullCurvature = 1e-14;
constexpr int kMaxPolishes = 8;
// A warm start that leaves more than this part of the rows violated is forgotten.
constexpr double kFarStart = 0.1;
// Where blocks cycle, the shift rises to this at least, then tenfold: on all redundant families blocks settle there.
constexpr double kCyclingShift = 1e-2;
constexpr double kRaise = 10;

}  // namespace

// f_ and w_ of the shifted problem for active_.
void BppSolver::Engine::SolveActive() {
  ++factorisations_;
  if (!block_->Factor(active_, shift_, deadline())) return;
  f_.array() = shift_ * scaled_.diagonal.array() * center_.array() - scaled_.b.array();
  block_->Solve(f_.data());
  block_->Multiply(f_.data(), w_.data());
  w_.array() += scaled_.b.array() + shift_ * scaled_.diagonal.array() * (f_ - center_).array();
}

// Fills violated_, ascending. Signs are judged relative to the rounding of forces and gaps.
Index BppSolver::Engine::FindViolated(bool of_shifted) {
  const Index n = f_.size();
  double largest = 0;
  double size = 0;
  for (Index i = 0; i < n; ++i) {
    const double force = std::abs(f_[i]) * ForceRoot(i);
    largest = std::max(largest, force);
    size += force;
  }
  const double force_noise = of_shifted ? kForceNoise * kEpsilon / shift_ * largest : 0.0;
  violated_.clear();
  for (Index i = 0; i < n; ++i) {
    if (bilateral_[At(i)] != 0 || scaled_.can_act[At(i)] == 0) continue;
    const bool violated = active_[At(i)] != 0 ? f_[i] * ForceRoot(i) < -force_noise
                                              : w_[i] < -(kNoise * size * GapRoot(i) + kNoise * std::abs(scaled_.b[i]));
    if (violated) violated_.push_back(i);
  }
  return static_cast<Index>(violated_.size());
}

void BppSolver::Engine::Exchange(bool least_only) {
  for (const Index i : violated_) {
    active_[At(i)] = active_[At(i)] == 0 ? 1 : 0;
    if (least_only) break;
  }
}

BppSolver::Engine::End BppSolver::Engine::PivotBlocks() {
  Index least = f_.size() + 1;
  int patience = options_.patience;
  for (;;) {
    if (factorisations_ >= limit_) return End::kIterationLimit;
    if (TimeIsUp()) return End::kTimeLimit;
    SolveActive();
    if (TimeIsUp()) return End::kTimeLimit;
    if (options_.end_when_singular && factorisations_ == 1 &&
        BppOptions::kDependentShare * block_->CountDependentRows() > f_.size()) {
      return End::kSingular;
    }
    const Index count = FindViolated(true);
    if (count == 0) return End::kDone;
    const bool far = least > f_.size() && static_cast<double>(count) > kFarStart * static_cast<double>(f_.size());
    if (count < least) {
      least = count;
      patience = options_.patience;
    } else {
      patience = std::max(patience - 1, 0);
    }
    if (started_warm_ && (patience == 0 || far)) {
      // The start is not as good as it should be: from all rows, as without it.
      StartCold();
      least = f_.size() + 1;
      patience = options_.patience;
      continue;
    }
    if (patience == 0 && options_.end_when_cycling) return End::kCycling;
    if (patience == 0 && shift_ < options_.largest_proximal) {
      shift_ = std::min(std::max(kCyclingShift, shift_ * kRaise), options_.largest_proximal);
      least = f_.size() + 1;
      patience = options_.patience;
    }
    if (patience == 0) ++single_exchanges_;
    Exchange(patience == 0);
  }
}

// f_F += x with A_FF x = -(A f + b)_F by conjugate gradients, preconditioned with K_FF. Leaves w_ = A f + b.
BppSolver::Engine::End BppSolver::Engine::CorrectForces() {
  const Index n = f_.size();
  block_->Multiply(f_.data(), w_.data());
  w_ += scaled_.b;
  double size = 0;
  for (Index i = 0; i < n; ++i)
    size = std::max(size, std::max(std::abs(f_[i]) * ForceRoot(i), std::abs(scaled_.b[i]) / GapRoot(i)));
  const double rounding = kEpsilon * size;
  double before = std::numeric_limits<double>::infinity();
  double slope_before = 0;
  for (int step = 0; step < kMaxCorrections; ++step) {
    double largest = 0;
    for (Index i = 0; i < n; ++i) {
      residual_[i] = active_[At(i)] != 0 ? -w_[i] : 0.0;
      if (residual_[i] != 0) largest = std::max(largest, std::abs(residual_[i]) / GapRoot(i));
    }
    if (!(largest > rounding) || !(largest < kSlowCorrection * before)) break;
    if (TimeIsUp()) return End::kTimeLimit;
    before = largest;
    preconditioned_ = residual_;
    block_->Solve(preconditioned_.data());
    const double slope = residual_.dot(preconditioned_);
    if (step == 0) {
      direction_ = preconditioned_;
    } else {
      direction_ = preconditioned_ + (slope / slope_before) * direction_;
    }
    slope_before = slope;
    block_->Multiply(direction_.data(), image_.data());
    const double curvature = direction_.dot(image_);
    const double norm2 = (scaled_.diagonal.array() * direction_.array().square()).sum();
    if (!(curvature > kNullCurvature * norm2)) break;
    const double length = slope / curvature;
    f_ += length * direction_;
    w_ += length * image_;
  }
  return End::kDone;
}

BppSolver::Engine::End BppSolver::Engine::Polish(LcpResult* result) {
  Index least = f_.size() + 1;
  for (int round = 0; round < kMaxPolishes; ++round) {
    if (CorrectForces() == End::kTimeLimit || TimeIsUp()) return End::kTimeLimit;
    if (Publish(result)) return End::kDone;
    const Index count = FindViolated(false);
    if (count == 0 && !options_.self_check) return End::kDone;
    if (count == 0 || count >= least) break;
    least = count;
    if (factorisations_ >= limit_) return End::kIterationLimit;
    if (TimeIsUp()) return End::kTimeLimit;
    Exchange(false);
    block_->Factor(active_, shift_, deadline());
    ++factorisations_;
    for (Index i = 0; i < f_.size(); ++i) {
      if (active_[At(i)] == 0) f_[i] = 0;
    }
  }
  return End::kNotMet;
}

}  // namespace lcpbench
