#include "solvers/interior_point/interior_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lcpbench {
namespace {

constexpr double kStepToBoundary = 0.99;        // early, where accuracy of the direction is not worth the boundary
constexpr double kLateStepToBoundary = 0.9995;  // once mu is small, for superlinear convergence
constexpr double kLateMu = 1e-4;
constexpr double kShift = 1.5;         // Mehrotra's starting shift
constexpr double kPoorStep = 0.05;     // shorter steps count as stagnation, as do ...
constexpr double kPoorFall = 0.5;      // ... steps that leave more than this of a mu that is ...
constexpr double kPoorMu = 1e-10;      // ... this small already, where rounding may be what stops it ...
constexpr int kPoorSteps = 4;          // ... when this many come in a row
constexpr double kDivergence = 1e9;    // |f^| beyond this is taken for divergence (scaled b has size 1)
constexpr double kRefineAbove = 1e-3;  // residual of a linear system, in sqrt(mu), that calls for refinement
constexpr double kStartWeight = 0.1;   // of the regularised equality solve: w = -weight f
constexpr double kLeastWarmMu = 1e-12;
// Mehrotra's target mu is a guess from the affine step alone, and too cautious where rows block that step early which
// the second order lets go: smaller ones are tried as well. Measured at 10^5 redundant rows (rounded-wall): 54 steps
// become 41, and 34 with four correctors, which alone gain nothing.
constexpr std::array<double, 3> kTargetShares = {1, 0.3, 0.1};
// Gondzio's corrector: aimed-for step, box around mu, and the gain that makes a corrector worth keeping.
constexpr double kAimedStep = 0.3;
constexpr double kAimedGrowth = 1.1;
constexpr double kBoxLow = 0.1;
constexpr double kBoxHigh = 10;
constexpr double kLeastGain = 0.01;

}  // namespace

void InteriorPoint::Reserve(Index n) {
  for (Eigen::VectorXd* v : {&f_, &w_, &df_, &dw_, &affine_df_, &affine_dw_, &trial_df_, &trial_dw_, &theta_, &defect_,
                             &target_, &right_, &correction_, &product_, &centre_df_, &centre_dw_}) {
    v->setZero(n);
  }
}

InteriorPoint::Progress InteriorPoint::StartCold(IpmRun* run) {
  ScaledSystem& system = run->system();
  const Index n = system.size();
  poor_steps_ = 0;
  for (Index i = 0; i < n; ++i) theta_[i] = system.unilateral(i) ? kStartWeight : run->proximal();
  if (!run->Factorize(theta_)) return Progress::kStopped;
  for (Index i = 0; i < n; ++i) right_[i] = system.idle(i) ? 0.0 : -system.b()[i];
  system.Solve(right_, &f_);
  // (A + c I) f = -b: the gap of a unilateral row is -c f, so one of the two is positive already.
  double least_f = 0, least_w = 0;
  for (Index i = 0; i < n; ++i) {
    w_[i] = 0;
    if (system.idle(i)) f_[i] = 0;
    if (!system.unilateral(i)) continue;
    w_[i] = -kStartWeight * f_[i];
    least_f = std::min(least_f, f_[i]);
    least_w = std::min(least_w, w_[i]);
  }
  const double shift_f = -kShift * least_f;
  const double shift_w = -kShift * least_w;
  double sum_f = 0, sum_w = 0, gap = 0;
  for (Index i = 0; i < n; ++i) {
    if (!system.unilateral(i)) continue;
    f_[i] += shift_f;
    w_[i] += shift_w;
    sum_f += f_[i];
    sum_w += w_[i];
    gap += f_[i] * w_[i];
  }
  // Scaled b has size 1, so 1 stands in where the equality solve left f = w = 0 or products of 0.
  const double more_f = gap > 0 ? gap / (2 * sum_w) : 1.0;
  const double more_w = gap > 0 ? gap / (2 * sum_f) : 1.0;
  for (Index i = 0; i < n; ++i) {
    if (!system.unilateral(i)) continue;
    f_[i] += more_f;
    w_[i] += more_w;
  }
  Measure(run);
  return Progress::kGood;
}

void InteriorPoint::StartWarm(IpmRun* run, const Eigen::VectorXd& f, double mu_per_residual) {
  ScaledSystem& system = run->system();
  const Index n = system.size();
  poor_steps_ = 0;
  for (Index i = 0; i < n; ++i) f_[i] = system.idle(i) ? 0.0 : f[i];
  system.Multiply(f_, &w_);
  double sum = 0;
  Index count = 0;
  for (Index i = 0; i < n; ++i) {
    w_[i] = system.unilateral(i) ? w_[i] + system.b()[i] : 0.0;
    if (!system.unilateral(i)) continue;
    const double residual = std::min(f_[i], w_[i]);
    sum += residual * residual;
    ++count;
  }
  const double mean = std::sqrt(sum / static_cast<double>(std::max<Index>(count, 1)));
  const double mu = std::max(kLeastWarmMu, mu_per_residual * mean);
  Centre(system, mu);
  Measure(run);
}

void InteriorPoint::Recentre(IpmRun* run, double growth) {
  poor_steps_ = 0;
  Centre(run->system(), growth * mu_);
  Measure(run);
}

// f w = mu in every row, and f - w as it was, whose sign is the active set.
void InteriorPoint::Centre(const ScaledSystem& system, double mu) {
  for (Index i = 0; i < f_.size(); ++i) {
    if (!system.unilateral(i)) continue;
    const double difference = f_[i] - w_[i];
    const double root = std::sqrt(difference * difference + 4 * mu);
    const double larger = (std::abs(difference) + root) / 2;
    f_[i] = difference > 0 ? larger : mu / larger;
    w_[i] = difference > 0 ? mu / larger : larger;
  }
}

void InteriorPoint::Measure(IpmRun* run) {
  const ScaledSystem& system = run->system();
  system.Multiply(f_, &defect_);
  mu_ = 0;
  residual_ = 0;
  contacts_ = 0;
  for (Index i = 0; i < f_.size(); ++i) {
    if (system.idle(i)) {
      defect_[i] = 0;
      continue;
    }
    defect_[i] += system.b()[i] - w_[i];
    residual_ = std::max(residual_, std::abs(defect_[i]));
    if (!system.unilateral(i)) continue;
    mu_ += f_[i] * w_[i];
    ++contacts_;
  }
  if (contacts_ > 0) mu_ /= contacts_;
}

bool InteriorPoint::FactorizeStep(IpmRun* run) {
  const ScaledSystem& system = run->system();
  for (Index i = 0; i < f_.size(); ++i) {
    // Without the cap, quotients of a row that has left would overflow into its neighbours as NaN.
    theta_[i] = system.unilateral(i) ? std::min(w_[i] / f_[i], ScaledSystem::kOut) : 0.0;
    right_[i] = theta_[i] + run->proximal();
  }
  return run->Factorize(right_);
}

void InteriorPoint::SolveSystem(IpmRun* run, const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  ScaledSystem& system = run->system();
  system.Solve(r, x);
  if (!refine_) return;
  system.Multiply(*x, &product_);
  for (Index i = 0; i < f_.size(); ++i) {
    product_[i] = system.idle(i) ? 0.0 : r[i] - product_[i] - theta_[i] * (*x)[i];
  }
  // The first solve of a step tells whether the others need this as well.
  refine_ = product_.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() > kRefineAbove * std::sqrt(mu_);
  if (!refine_) return;
  system.Solve(product_, &correction_);
  *x += correction_;
}

void InteriorPoint::Direction(IpmRun* run, double defects, const Eigen::VectorXd& products, Eigen::VectorXd* df,
                              Eigen::VectorXd* dw) {
  const ScaledSystem& system = run->system();
  for (Index i = 0; i < f_.size(); ++i) {
    right_[i] = -defects * defect_[i];
    if (system.unilateral(i)) right_[i] += products[i] / f_[i];
  }
  SolveSystem(run, right_, df);
  for (Index i = 0; i < f_.size(); ++i) {
    if (system.idle(i)) (*df)[i] = 0;
    (*dw)[i] = system.unilateral(i) ? (products[i] - w_[i] * (*df)[i]) / f_[i] : 0.0;
  }
}

// The steps to the boundary and the mu behind them of all shares in one pass over the rows: mu along a step is a
// quadratic whose coefficients are sums over the rows.
double InteriorPoint::ChooseTarget(const ScaledSystem& system, double most) const {
  std::array<double, kTargetShares.size()> inverse{}, slope{}, curvature{};
  double now = 0;
  for (Index i = 0; i < f_.size(); ++i) {
    if (!system.unilateral(i)) continue;
    const double per_f = 1 / f_[i];
    const double per_w = 1 / w_[i];
    now += f_[i] * w_[i];
    for (std::size_t k = 0; k < kTargetShares.size(); ++k) {
      const double share = most * kTargetShares[k];
      const double df = df_[i] + share * centre_df_[i];
      const double dw = dw_[i] + share * centre_dw_[i];
      inverse[k] = std::max({inverse[k], -df * per_f, -dw * per_w});
      slope[k] += f_[i] * dw + w_[i] * df;
      curvature[k] += df * dw;
    }
  }
  double best = most;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kTargetShares.size(); ++k) {
    const double step = std::min(1.0, kStepToBoundary / inverse[k]);
    const double after = now + step * (slope[k] + step * curvature[k]);
    if (!(after < least)) continue;
    least = after;
    best = most * kTargetShares[k];
  }
  return best;
}

double InteriorPoint::MaxStep(const ScaledSystem& system, const Eigen::VectorXd& df, const Eigen::VectorXd& dw) const {
  double inverse = 0;
  for (Index i = 0; i < f_.size(); ++i) {
    if (!system.unilateral(i)) continue;
    inverse = std::max({inverse, -df[i] / f_[i], -dw[i] / w_[i]});
  }
  return inverse > 0 ? 1 / inverse : 2.0;
}

void InteriorPoint::CorrectCentrality(IpmRun* run, double target_mu) {
  const ScaledSystem& system = run->system();
  double step = std::min(1.0, MaxStep(system, df_, dw_));
  for (int k = 0; k < run->correctors() && step < 1.0 - kLeastGain; ++k) {
    const double aimed = std::min(1.0, kAimedGrowth * step + kAimedStep);
    for (Index i = 0; i < f_.size(); ++i) {
      if (!system.unilateral(i)) continue;
      const double product = (f_[i] + aimed * df_[i]) * (w_[i] + aimed * dw_[i]);
      const double clipped = std::clamp(product, kBoxLow * target_mu, kBoxHigh * target_mu);
      trial_dw_[i] = target_[i] + std::max(clipped - product, -kBoxHigh * target_mu);
    }
    target_.swap(trial_dw_);  // trial_dw_ keeps the old target until the corrector has proved itself
    affine_dw_ = trial_dw_;
    Direction(run, 1, target_, &trial_df_, &trial_dw_);
    const double improved = std::min(1.0, MaxStep(system, trial_df_, trial_dw_));
    if (!(improved >= step + kLeastGain)) {
      target_ = affine_dw_;
      return;
    }
    df_.swap(trial_df_);
    dw_.swap(trial_dw_);
    step = improved;
  }
}

InteriorPoint::Progress InteriorPoint::Step(IpmRun* run) {
  const ScaledSystem& system = run->system();
  const Index n = f_.size();
  if (!FactorizeStep(run)) return Progress::kStopped;
  ++run->statistics().interior_steps;
  refine_ = true;

  for (Index i = 0; i < n; ++i) target_[i] = -f_[i] * w_[i];
  Direction(run, 1, target_, &affine_df_, &affine_dw_);
  const double affine_step = std::min(1.0, MaxStep(system, affine_df_, affine_dw_));
  double affine_mu = 0;
  for (Index i = 0; i < n; ++i) {
    if (!system.unilateral(i)) continue;
    affine_mu += (f_[i] + affine_step * affine_df_[i]) * (w_[i] + affine_step * affine_dw_[i]);
  }
  affine_mu /= contacts_;
  const double ratio = affine_mu / mu_;
  for (Index i = 0; i < n; ++i) trial_dw_[i] = -affine_df_[i] * affine_dw_[i];
  target_ += trial_dw_;
  Direction(run, 0, trial_dw_, &df_, &dw_);
  df_ += affine_df_;
  dw_ += affine_dw_;
  trial_dw_.setConstant(mu_);
  Direction(run, 0, trial_dw_, &centre_df_, &centre_dw_);
  const double share = ChooseTarget(system, ratio * ratio * ratio);
  df_ += share * centre_df_;
  dw_ += share * centre_dw_;
  target_.array() += share * mu_;
  CorrectCentrality(run, share * mu_);

  const double boundary = mu_ < kLateMu ? kLateStepToBoundary : kStepToBoundary;
  const double step = step_ = std::min(1.0, boundary * MaxStep(system, df_, dw_));
  if (!std::isfinite(step) || !df_.allFinite()) return Progress::kStagnant;
  const double mu_before = mu_;
  f_ += step * df_;
  w_ += step * dw_;
  Measure(run);
  if (!(f_.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < kDivergence)) return Progress::kDiverged;
  poor_steps_ = step < kPoorStep || (mu_ < kPoorMu && mu_ > kPoorFall * mu_before) ? poor_steps_ + 1 : 0;
  return poor_steps_ >= kPoorSteps ? Progress::kStagnant : Progress::kGood;
}

}  // namespace lcpbench
