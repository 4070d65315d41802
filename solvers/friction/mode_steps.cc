#include "solvers/friction/mode_steps.h"

#include <algorithm>
#include <cmath>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// A step of length t must reduce |r| by this part of t.
constexpr double kDecrease = 1e-3;
constexpr double kShortestStep = 0x1p-7;
// eps falls after a full step that reduces |r| to this part, and grows by the inverse where steps fail.
constexpr double kGoodStep = 0.1;
constexpr double kLeastEps = 1e-12, kMostEps = 0.1;
constexpr int kMostFailures = 8;
// rho above which the modes are wrong, rather than their solution inexact.
constexpr double kWorthRefining = 1e-4;
// Answers are refined to this part of the tolerance.
constexpr double kFineEnough = 1e-4;
// Sweeps at a time: more after so many failures; and in all.
constexpr int kPatience = 3, kMostSweepsAtOnce = 400, kMostSweeps = 2000;
// Sweeps between two looks at the answer.
constexpr int kSweepsPerCheck = 5;

}  // namespace

void ModeSteps::Reserve(Index max_rows) {
  factor_.Reserve(max_rows);
  for (std::vector<RangeSide>* const sides : {&sides_, &tried_}) sides->reserve(static_cast<size_t>(max_rows));
  for (PaddedVector* const numbers : {&gaps_, &next_, &trial_, &center_, &start_}) {
    numbers->Lengthen(max_rows);
  }
}

// The solution of sides_, as next_ with gaps_. Whether it passes.
bool ModeSteps::TryModes(const ContactRows& rows, const PaddedVector& center, double eps, FrictionAnswer* answer) {
  ++answer->iterations();
  if (!factor_.Solve(rows, sides_, center, eps, &next_)) return false;
  rows.ComputeGaps(next_, &gaps_);
  double rho = rows.Rho(next_, gaps_);
  if (rho > kFineEnough * answer->tolerance() && rho < kWorthRefining) {
    factor_.Refine(rows, &next_);
    rows.ComputeGaps(next_, &gaps_);
    rho = rows.Rho(next_, gaps_);
  }
  return rho <= answer->tolerance() && answer->Take(next_, gaps_);
}

bool ModeSteps::Sweep(const ContactRows& rows, int count, PaddedVector* phi, FrictionAnswer* answer) {
  if (!sweeps_are_ready_) sweeps_.Prepare(answer->problem());
  sweeps_are_ready_ = true;
  f_.resize(rows.size());
  rows.ComputeGaps(*phi, &gaps_);
  rows.ToForces(*phi, gaps_, &f_);
  sweeps_.Start(answer->problem(), &f_);
  for (int k = 0; k < count && !answer->IsOver(); ++k) {
    const double change = sweeps_.Sweep(1);
    ++answer->iterations();
    if (!std::isfinite(change)) return false;
    if ((k + 1) % kSweepsPerCheck != 0 && k + 1 < count) continue;
    sweeps_.GetForces(&f_);
    rows.ToScaled(f_, phi);
    rows.ComputeGaps(*phi, &gaps_);
    if (rows.Rho(*phi, gaps_) <= answer->tolerance() && answer->Take(*phi)) return true;
  }
  return false;
}

// trial_ at t of the way from phi to next_.
void ModeSteps::SetTrial(Index n, double t, const PaddedVector& phi) {
  trial_.Lengthen(n);
  trial_.head(n) = phi.head(n) + t * (next_.head(n) - phi.head(n));
}

// From *phi towards next_: the longest of t = 1, 1/2, ... that reduces |r| enough; then gaps_ are those of *phi. *next:
// rho there.
bool ModeSteps::TryStep(const ContactRows& rows, double rho, PaddedVector* phi, double* next) {
  for (double t = 1; t >= kShortestStep; t /= 2) {
    SetTrial(rows.size(), t, *phi);
    rows.ComputeGaps(trial_, &gaps_);
    *next = rows.Rho(trial_, gaps_);
    if (!(*next <= (1 - kDecrease * t) * rho)) continue;
    phi->swap(trial_);
    return true;
  }
  return false;
}

// One more solve of the modes of an answer, of which eps may have left part of the error. True.
bool ModeSteps::TakeLastStep(const ContactRows& rows, const PaddedVector& phi, FrictionAnswer* answer) {
  if (answer->rho() <= kFineEnough * answer->tolerance()) return true;
  rows.ComputeGaps(phi, &gaps_);
  rows.FindSides(phi, gaps_, &sides_);
  ++answer->iterations();
  if (factor_.Solve(rows, sides_, phi, kLeastEps, &trial_)) answer->Take(trial_);
  return true;
}

bool ModeSteps::Warm(const ContactRows& rows, int steps, FrictionAnswer* answer) {
  rows.ToScaled(*answer->options().initial_f, &start_);
  return answer->Take(start_) || TakeDampedSteps(rows, {.steps = steps, .eps = 1e-10}, &start_, answer);
}

// Contacts whose normal gap at rest is rounding beside the largest load, as between bodies that fall together.
void ModeSteps::CloseUnloaded(const ContactRows& rows) {
  constexpr double kUnloaded = 1e-9;
  const double most = kUnloaded * rows.b().lpNorm<Eigen::Infinity>();
  const auto is_unloaded = [&](Index normal) { return std::abs(rows.b()[normal]) <= most; };
  for (const Index i : rows.laws().normals) {
    if (is_unloaded(i)) sides_[At(i)] = RangeSide::kInside;
  }
  for (const FrictionRow& row : rows.laws().friction) {
    if (is_unloaded(row.normal) && CanStick(row)) sides_[At(row.row)] = RangeSide::kInside;
  }
}

bool ModeSteps::TakeFullSteps(const ContactRows& rows, int steps, PaddedVector* phi, FrictionAnswer* answer) {
  constexpr double kEps = 1e-13;
  rows.ComputeGaps(*phi, &gaps_);
  for (int k = 0; k < steps && !answer->IsOver(); ++k) {
    rows.FindSides(*phi, gaps_, &sides_);
    if (k == 0) CloseUnloaded(rows);
    if (k > 0 && sides_ == tried_) return false;
    if (TryModes(rows, *phi, kEps, answer)) return true;
    if (!next_.head(rows.size()).allFinite()) return false;
    phi->swap(next_);
    tried_.swap(sides_);
  }
  return false;
}

// The digits of a code to the base 4: a contact is open, sticks, or slips in either direction.
bool ModeSteps::TryAll(const ContactRows& rows, FrictionAnswer* answer) {
  constexpr unsigned kOpen = 0, kStick = 1, kDown = 3;
  const Laws laws = rows.laws();
  if (!laws.bounded.empty()) return false;
  const size_t all = size_t{1} << (2 * laws.normals.size());
  center_.Lengthen(rows.size());
  center_.head(rows.size()).setZero();
  sides_.assign(At(rows.size()), RangeSide::kLower);
  for (const Index i : laws.joints) sides_[At(i)] = RangeSide::kInside;
  for (size_t code = 0; code < all && !answer->IsOver(); ++code) {
    bool is_new = true;
    for (size_t k = 0; k < laws.normals.size(); ++k) {
      const unsigned mode = (code >> (2 * k)) % 4;
      const Index normal = laws.normals[k];
      sides_[At(normal)] = mode == kOpen ? RangeSide::kLower : RangeSide::kInside;
      bool can_stick = false;
      for (const FrictionRow& row : rows.FrictionOf(normal)) {
        if (!CanStick(row)) continue;
        can_stick = true;
        sides_[At(row.row)] = mode == kStick  ? RangeSide::kInside
                              : mode == kDown ? RangeSide::kUpper
                                              : RangeSide::kLower;
      }
      is_new = is_new && (can_stick || mode <= kStick);
    }
    if (is_new && TryModes(rows, center_, 0, answer)) return true;
  }
  return false;
}

bool ModeSteps::TakeDampedSteps(const ContactRows& rows, const Limits& limits, PaddedVector* phi,
                                FrictionAnswer* answer) {
  double eps = limits.eps;
  int failures = 0, sweeps = limits.sweeps, all_sweeps = 0;
  rows.ComputeGaps(*phi, &gaps_);
  double rho = rows.Rho(*phi, gaps_);
  for (int step = 0; step < limits.steps && !answer->IsOver(); ++step) {
    rows.FindSides(*phi, gaps_, &sides_);
    ++answer->iterations();
    double next = rho;
    const bool is_regular = factor_.Solve(rows, sides_, *phi, eps, &next_);
    if (is_regular && eps <= limits.eps) factor_.Refine(rows, &next_);
    if (!is_regular) eps = std::max(100 * eps, 1e-10);
    // What passes need not have a smaller |r|: at rounding only the backward error may still be wrong.
    if (is_regular && rho <= answer->tolerance() && answer->Take(next_)) return TakeLastStep(rows, next_, answer);
    if (is_regular && TryStep(rows, rho, phi, &next)) {
      failures = 0;
      if (next < kGoodStep * rho) eps = std::max(kGoodStep * eps, kLeastEps);
      rho = next;
    } else if (limits.sweeps > 0) {
      all_sweeps += sweeps;
      if (all_sweeps > kMostSweeps) break;
      if (Sweep(rows, sweeps, phi, answer)) return true;
      rows.ComputeGaps(*phi, &gaps_);
      rho = rows.Rho(*phi, gaps_);
      if (!std::isfinite(rho)) return false;
      eps = limits.eps;
      if (++failures > kPatience) sweeps = std::min(2 * sweeps, kMostSweepsAtOnce);
    } else {
      if (++failures > kMostFailures) break;
      eps = std::min(eps / kGoodStep, kMostEps);
      rows.ComputeGaps(*phi, &gaps_);
    }
    if (rho <= answer->tolerance() && answer->Take(*phi, gaps_)) return TakeLastStep(rows, *phi, answer);
  }
  if (rho < answer->rho()) answer->Take(*phi);
  return false;
}

bool ModeSteps::Polish(const ContactRows& rows, const PaddedVector& phi, FrictionAnswer* answer) {
  constexpr int kSolves = 4;
  for (const double eps : {1e-8, 1e-10, 1e-6}) {
    trial_.Lengthen(rows.size());
    trial_.head(rows.size()) = phi.head(rows.size());
    for (int k = 0; k < kSolves && !answer->IsLate(); ++k) {
      rows.ComputeGaps(trial_, &gaps_);
      rows.FindSides(trial_, gaps_, &sides_);
      ++answer->iterations();
      if (!factor_.Solve(rows, sides_, trial_, eps, &next_)) break;
      trial_.swap(next_);
      if (answer->Take(trial_)) return true;
    }
  }
  return false;
}

}  // namespace lcpbench
