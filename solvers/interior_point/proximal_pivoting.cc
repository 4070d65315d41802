#include "solvers/interior_point/proximal_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr int kRefinements = 2;      // of a proximal solve; each gains about -log10(rounding / eps) digits
constexpr int kPolishSteps = 5;      // proximal-point steps on one active set
constexpr double kPolishGain = 0.5;  // rho must fall at least by this factor for another step
// Forces below these fractions of the largest are tried as zeros; each level costs one product with A.
constexpr double kSnapLevels[] = {1e-15, 1e-13, 1e-11};
constexpr int kRelaxations = 6;           // of rows that fail the componentwise measure alone
constexpr int kPatience = 5;              // block pivots without fewer wrong rows, before single pivots
constexpr double kSignRounding = 1e-15;   // signs are judged relative to the largest |f^| of the problem
constexpr double kTinyRowError = 1e-6;    // componentwise error at which a sign within rounding is worth a pivot
constexpr double kWeightFall = 0.1;       // least fall of a heavy eps per proximal step
constexpr int kOuterSteps = 12;           // moves of the proximal centre
constexpr double kGrowth = 1e4;           // a proximal step this long hints at a ray (scaled b has size 1)
constexpr double kSupport = 1e-6;         // smaller entries of a growth direction are taken for zero
constexpr int kRaySteps = 6;              // projections of a ray
constexpr double kHeavierProximal = 100;  // factor on eps when a factorisation breaks down
constexpr double kHeaviestProximal = 1e-5;

}  // namespace

void ProximalPivoting::Reserve(Index n) {
  for (Eigen::VectorXd* v :
       {&center_, &x_, &gap_, &polished_, &right_, &correction_, &theta_, &forces_, &gaps_, &ray_, &snapped_}) {
    v->setZero(n);
  }
  active_.assign(static_cast<size_t>(n), 0);
  wrong_.assign(static_cast<size_t>(n), 0);
}

bool ProximalPivoting::Factorize(IpmRun* run) {
  for (;;) {
    for (size_t i = 0; i < active_.size(); ++i) {
      theta_[static_cast<Index>(i)] = active_[i] != 0 ? weight_ : ScaledSystem::kOut;
    }
    if (run->Factorize(theta_)) return true;
    if (run->limit_hit() || weight_ * kHeavierProximal > kHeaviestProximal) return false;
    weight_ *= kHeavierProximal;
  }
}

void ProximalPivoting::ProximalGaps(IpmRun* run) {
  ScaledSystem& system = run->system();
  forces_ = system.force_unit().cwiseProduct(x_);
  system.GapsExtended(forces_, true, &gap_);
  for (Index i = 0; i < x_.size(); ++i) gap_[i] = gap_[i] / system.gap_unit()[i] + weight_ * (x_[i] - center_[i]);
}

void ProximalPivoting::SolveOnActiveSet(IpmRun* run) {
  ScaledSystem& system = run->system();
  const Index n = x_.size();
  for (Index i = 0; i < n; ++i) x_[i] = active_[static_cast<size_t>(i)] != 0 ? center_[i] : 0.0;
  for (int k = 0; k < kRefinements; ++k) {
    ProximalGaps(run);
    for (Index i = 0; i < n; ++i) right_[i] = active_[static_cast<size_t>(i)] != 0 ? -gap_[i] : 0.0;
    system.Solve(right_, &correction_);
    for (Index i = 0; i < n; ++i) {
      if (active_[static_cast<size_t>(i)] != 0) x_[i] += correction_[i];
    }
  }
  ProximalGaps(run);
}

bool ProximalPivoting::AcceptClipped(IpmRun* run) {
  ScaledSystem& system = run->system();
  for (Index i = 0; i < x_.size(); ++i) {
    if (system.unilateral(i)) polished_[i] = std::max(polished_[i], 0.0);
  }
  forces_ = system.force_unit().cwiseProduct(polished_);
  system.GapsExtended(forces_, true, &gaps_);
  if (run->Accept(forces_, gaps_)) return true;
  const double tolerance = run->options().tolerance;
  if (!(system.Rho(forces_, gaps_) <= tolerance)) return false;
  return RepairTinyRows(run);
}

bool ProximalPivoting::RepairTinyRows(IpmRun* run) {
  ScaledSystem& system = run->system();
  const Index n = x_.size();
  const double allowed = std::sqrt(run->options().tolerance);
  // Forces that should be zero are often only zero to rounding.
  const double largest = MaxAbs(polished_);
  for (const double level : kSnapLevels) {
    for (Index i = 0; i < n; ++i) snapped_[i] = std::abs(polished_[i]) <= level * largest ? 0.0 : forces_[i];
    system.GapsExtended(snapped_, true, &right_);
    if (run->Accept(snapped_, right_)) return true;
  }
  // Forces that should be a tiny positive number: relax the failing rows one by one in their own units.
  snapped_ = forces_;
  right_ = gaps_;
  for (int k = 0; k < kRelaxations; ++k) {
    for (Index i = 0; i < n; ++i) {
      if (system.idle(i) || system.BackwardErrorBound(snapped_, right_, i) <= allowed) continue;
      const double force = snapped_[i] - right_[i] / (system.root()[i] * system.root()[i]);
      snapped_[i] = system.unilateral(i) ? std::max(force, 0.0) : force;
    }
    system.GapsExtended(snapped_, true, &right_);
    if (run->Accept(snapped_, right_)) return true;
  }
  return false;
}

bool ProximalPivoting::Polish(IpmRun* run) {
  ScaledSystem& system = run->system();
  polished_ = x_;
  double rho = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kPolishSteps; ++k) {
    if (AcceptClipped(run)) return true;
    const double now = system.Rho(forces_, gaps_);
    if (!(now <= kPolishGain * rho)) return false;
    rho = now;
    for (Index i = 0; i < x_.size(); ++i) {
      right_[i] = active_[static_cast<size_t>(i)] != 0 ? -gaps_[i] / system.gap_unit()[i] : 0.0;
    }
    system.Solve(right_, &correction_);
    for (Index i = 0; i < x_.size(); ++i) {
      if (active_[static_cast<size_t>(i)] != 0) polished_[i] += correction_[i];
    }
  }
  return false;
}

void ProximalPivoting::Sharpen(IpmRun* run) {
  weight_ = run->proximal();
  center_ = polished_;
  if (!Factorize(run)) return;
  ++run->statistics().pivots;
  SolveOnActiveSet(run);
  if (x_.allFinite()) Polish(run);
}

Index ProximalPivoting::FindWrongRows(const ScaledSystem& system) {
  // First signs that are wrong beyond rounding. Only where there are none, those that rounding may have made: they
  // matter where every term of a row is tiny.
  for (const double rounding : {kSignRounding * (1 + MaxAbs(x_)), 0.0}) {
    Index count = 0;
    for (Index i = 0; i < x_.size(); ++i) {
      const auto k = static_cast<size_t>(i);
      wrong_[k] = system.unilateral(i) && (active_[k] != 0 ? x_[i] : gap_[i]) < -rounding ? 1 : 0;
      if (wrong_[k] != 0 && rounding == 0 && system.BackwardErrorBound(forces_, gaps_, i) <= kTinyRowError)
        wrong_[k] = 0;
      count += wrong_[k];
    }
    if (count > 0) return count;
  }
  return 0;
}

void ProximalPivoting::Flip(const ScaledSystem& system, bool all) {
  for (Index i = system.size() - 1; i >= 0; --i) {
    const auto k = static_cast<size_t>(i);
    if (wrong_[k] == 0) continue;
    active_[k] = active_[k] != 0 ? 0 : 1;
    if (!all) return;
  }
}

ProximalPivoting::Outcome ProximalPivoting::Run(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w,
                                                const Budget& budget, double weight) {
  ScaledSystem& system = run->system();
  const Index n = system.size();
  weight_ = std::max(run->proximal(), weight);
  for (Index i = 0; i < n; ++i) {
    active_[static_cast<size_t>(i)] = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]) ? 1 : 0;
    center_[i] = system.idle(i) ? 0.0 : f[i];
  }
  const auto rows = static_cast<double>(n);
  Index fewest = n + 1;
  int patience = kPatience;
  int outer = 0;
  bool factorized = false;
  for (int pivot = 0; pivot < budget.pivots;) {
    if (!factorized) {
      if (!Factorize(run)) return run->limit_hit() ? Outcome::kStopped : Outcome::kGaveUp;
      ++run->statistics().pivots;
      ++pivot;
      factorized = true;
    }
    SolveOnActiveSet(run);
    if (!x_.allFinite()) return Outcome::kGaveUp;
    if (Polish(run)) {
      if (weight_ > run->proximal()) Sharpen(run);
      return Outcome::kSolved;
    }
    const Index wrong = FindWrongRows(system);
    if (wrong == 0) {
      // The proximal problem is solved: move its centre, on the same factor.
      right_ = x_ - center_;
      const double growth = MaxAbs(right_);
      center_ = x_;
      if (growth > kGrowth) {
        snapped_ = right_;
        if (TryRay(run, snapped_)) return Outcome::kInfeasible;
        if (run->limit_hit()) return Outcome::kStopped;
        factorized = false;
      }
      if (++outer >= kOuterSteps) return Outcome::kGaveUp;
      if (weight_ > run->proximal()) {
        // What is left of the residual is eps (x - c); an eps of its size keeps later steps as tame, and faster.
        weight_ = std::clamp(weight_ * growth, run->proximal(), kWeightFall * weight_);
        factorized = false;
      }
      fewest = n + 1;
      patience = kPatience;
      continue;
    }
    const double most =
        pivot == 1 && fewest > n ? budget.most_wrong * rows : budget.progress * static_cast<double>(fewest);
    if (static_cast<double>(wrong) > std::max(most, pivot > 1 ? budget.few_wrong * rows : 0.0)) return Outcome::kGaveUp;
    if (wrong < fewest) {
      fewest = wrong;
      patience = kPatience;
    } else {
      --patience;
    }
    Flip(system, patience > 0);
    factorized = false;
  }
  return Outcome::kGaveUp;
}

bool ProximalPivoting::TryRay(IpmRun* run, const Eigen::VectorXd& direction) {
  ScaledSystem& system = run->system();
  const Index n = system.size();
  const double size = MaxAbs(direction);
  if (!(size > 0) || !std::isfinite(size)) return false;
  Index largest = 0;
  while (std::abs(direction[largest]) < size) ++largest;
  const int component = system.component(largest);
  for (Index i = 0; i < n; ++i) {
    polished_[i] = 0;
    theta_[i] = ScaledSystem::kOut;
    if (system.idle(i) || system.component(i) != component) continue;
    const double y = direction[i] / size;
    if (system.unilateral(i) && y < kSupport) continue;
    polished_[i] = y;
    theta_[i] = run->proximal();
  }
  if (!run->Factorize(theta_)) return false;
  for (int k = 0; k < kRaySteps; ++k) {
    ray_ = system.force_unit().cwiseProduct(polished_);
    system.GapsExtended(ray_, false, &gaps_);
    if (VerifyFarkasRay(system.problem(), ray_).accepted) return true;
    for (Index i = 0; i < n; ++i) {
      right_[i] = theta_[i] < ScaledSystem::kOut ? -gaps_[i] / system.gap_unit()[i] : 0.0;
    }
    system.Solve(right_, &correction_);
    for (Index i = 0; i < n; ++i) {
      if (theta_[i] == ScaledSystem::kOut) continue;
      polished_[i] += correction_[i];
      if (system.unilateral(i)) polished_[i] = std::max(polished_[i], 0.0);
    }
  }
  return false;
}

}  // namespace lcpbench
