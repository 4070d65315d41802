#include "solvers/interior_point/interior_guess.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

constexpr int kPivots = 8;           // of one guess, in factorisations ...
constexpr double kHopeless = 0.12;   // ... none after the first if it leaves more than this fraction of the rows wrong,
constexpr double kProgress = 0.5;    // ... no more once one leaves more than this of the wrong rows and ...
constexpr double kFew = 0.01;        // ... more than this fraction of all
constexpr int kSolves = 5;           // on one active set, as long as each one leaves ...
constexpr double kGain = 0.25;       // ... at most this fraction of the residual
constexpr double kRounding = 1e-14;  // of the residual (scaled b has size 1): no more to be gained
constexpr double kSignRounding = 1e-13;  // signs are judged relative to the largest |f^|
constexpr double kClose = 0.5;        // of the tolerance: what double calls enough before extended precision is asked
constexpr double kNear = 10;          // times the tolerance: rho in double that calls for extended precision
constexpr double kMoreDigits = 1e-3;  // of the tolerance: a right F gives them for one more solve

}  // namespace

void InteriorGuess::Reserve(Index n) {
  for (Eigen::VectorXd* v : {&x_, &gap_, &right_, &correction_, &theta_, &forces_, &gaps_}) v->setZero(n);
  active_.assign(static_cast<size_t>(n), 0);
}

double InteriorGuess::Rho(const ScaledSystem& system) {
  for (Index i = 0; i < x_.size(); ++i) {
    forces_[i] = system.force_unit()[i] * (system.unilateral(i) ? std::max(x_[i], 0.0) : x_[i]);
    gaps_[i] = system.gap_unit()[i] * gap_[i];
  }
  return system.Rho(forces_, gaps_);
}

bool InteriorGuess::Judge(IpmRun* run, const Eigen::VectorXd& f, Eigen::VectorXd* w) {
  ScaledSystem& system = run->system();
  for (Index i = 0; i < f.size(); ++i) {
    right_[i] = system.idle(i) ? 0.0 : (system.unilateral(i) ? std::max(f[i], 0.0) : f[i]);
  }
  system.Multiply(right_, w);
  *w += system.b();
  forces_ = right_.cwiseProduct(system.force_unit());
  gaps_ = w->cwiseProduct(system.gap_unit());
  if (system.Rho(forces_, gaps_) <= kNear * run->options().tolerance) system.GapsExtended(forces_, true, &gaps_);
  return run->Accept(forces_, gaps_);
}

bool InteriorGuess::Refine(IpmRun* run) {
  ScaledSystem& system = run->system();
  const double tolerance = run->options().tolerance;
  const Index n = x_.size();
  double rho = 0;
  double before = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < n; ++i) {
    if (active_[static_cast<size_t>(i)] == 0) x_[i] = 0;
  }
  for (int k = 0;; ++k) {
    system.Multiply(x_, &gap_);
    gap_ += system.b();
    rho = Rho(system);
    if (rho <= kMoreDigits * tolerance) break;
    for (Index i = 0; i < n; ++i) right_[i] = active_[static_cast<size_t>(i)] != 0 ? -gap_[i] : 0.0;
    const double residual = MaxAbs(right_);
    if (k == kSolves || !(residual > kRounding && residual <= kGain * before)) break;
    before = residual;
    system.Solve(right_, &correction_);
    for (Index i = 0; i < n; ++i) {
      if (active_[static_cast<size_t>(i)] != 0) x_[i] += correction_[i];
    }
  }
  return rho <= kClose * tolerance && Judge(run, x_, &gap_);
}

Index InteriorGuess::Flip(const ScaledSystem& system) {
  const double rounding = kSignRounding * (1 + MaxAbs(x_));
  Index wrong = 0;
  for (Index i = 0; i < x_.size(); ++i) {
    char& active = active_[static_cast<size_t>(i)];
    if (!system.unilateral(i) || (active != 0 ? x_[i] : gap_[i]) >= -rounding) continue;
    active = active != 0 ? 0 : 1;
    ++wrong;
  }
  return wrong;
}

bool InteriorGuess::Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  ScaledSystem& system = run->system();
  const Index n = x_.size();
  for (Index i = 0; i < n; ++i) {
    active_[static_cast<size_t>(i)] = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]) ? 1 : 0;
    x_[i] = system.idle(i) ? 0.0 : f[i];
  }
  const auto rows = static_cast<double>(n);
  double fewest = kHopeless / kProgress * rows;
  for (int pivot = 0; pivot < kPivots; ++pivot) {
    for (Index i = 0; i < n; ++i) {
      theta_[i] = active_[static_cast<size_t>(i)] != 0 ? run->proximal() : ScaledSystem::kOut;
    }
    if (!run->Factorize(theta_)) return false;
    ++run->statistics().pivots;
    if (Refine(run)) return true;
    if (!x_.allFinite()) return false;
    const auto wrong = static_cast<double>(Flip(system));
    if (Judge(run, x_, &gap_)) return true;
    if (wrong == 0 || (wrong > kProgress * fewest && (pivot == 0 || wrong > kFew * rows))) return false;
    fewest = std::min(fewest, wrong);
  }
  return false;
}

}  // namespace lcpbench
