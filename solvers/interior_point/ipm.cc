#include "solvers/interior_point/ipm.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/active_set/block_pivoting.h"
#include "solvers/answers/answer_judge.h"
#include "solvers/first_order/nncg.h"
#include "solvers/lcp/residual.h"
#include "solvers/linear_algebra/cost_model.h"

namespace lcpbench {
namespace {

constexpr int kInteriorSteps = 80;        // far above the 10 to 30 that are normal
constexpr double kFirstFinish = 1e-4;     // mu from which every iterate may be the last one ...
constexpr double kFinishResidual = 1e-4;  // ... if the linear residual is this small too
constexpr double kFewWrongRows =
    0.02;  // with at most this fraction of rows wrong, pivots from the active set are tried
constexpr double kFewWrongRowsOfMany = 0.001;  // the same where sweeps mend what is local
constexpr double kNextGuess = 1e-3;            // fall of mu before they are tried again
constexpr std::int64_t kLastSweeps = 1000;  // where the interior point stagnates, while their rate promises an answer
constexpr int kMostRecentred = 3;
constexpr double kRecentredMu = 10;  // a row that blocks every step is off centre by more than that
constexpr double kLeastMu = 1e-22;   // nothing is to be learnt below
// Active sets tried from an interior iterate, as long as every one leaves at most half of the violated rows.
constexpr BlockPivoting::Rules kFromIterate = {
    .weight_factor = 0.01, .steps = 3, .try_every_set = true, .progress = 0.5, .factors = 5};
// Active sets of a warm start, in double the work of a step at most where they fail at once: none after the first set
// if that leaves more than 12 % of the rows violated, and no more once a set neither halves their number nor leaves 1
// %.
constexpr BlockPivoting::Rules kFromStart = {
    .try_every_set = true, .progress = 0.5, .most_wrong = 0.12, .few_wrong = 0.01, .factors = 8};
constexpr BlockPivoting::Rules kLastResort = {
    .weight_factor = 0.01, .steps = 12, .try_every_set = true, .factors = 300};
// Warm start: rho against the one of f = 0 from which its active set is worth a factorization, and from which the
// interior point starts from it rather than cold.
constexpr double kWorthTrying = 0.5;
// mu of a warm start, in its mean residual. What sweeps leave undone on redundant rows is smooth and small, and the
// active set behind it far from right: from a larger mu 10^5 rows of a wall need 40 steps instead of 100.
constexpr double kWarmMu = 0.1;
constexpr double kSweptMu = 40;
constexpr double kCloseEnough = 3e-2;
// A warm start whose first steps are as short as this is too close to the boundary for what has changed: its mu is
// lifted, and if that does not help either, the start is cold. (Measured with 0.5 % of
// the contacts lost and others gained: without this a start can cost several cold solves, and fail.)
constexpr int kTrialSteps = 6;
constexpr double kBlockedStep = 0.3;
constexpr double kLift = 100;
constexpr int kMostLifts = 2;
constexpr double kLeastWarmSweeps = 60;
constexpr double kWarmSweepWork = 4;  // limit of the sweeps, in factorizations

// Weight of the proximal term for pivots from an interior-point iterate: its distance from the solution is of the order
// of sqrt(mu) where rows are degenerate. The first guess of all takes the light weight: if F is right, it is exact.
constexpr double kTame = 10;
constexpr double kHeaviest = 1e-2;
double TameWeight(double mu) { return std::min(kHeaviest, kTame * std::sqrt(mu)); }

// One solve of the `ipm` backend: limits, counters and the best iterate so far, shared by its two methods; the system
// as the block that active sets are tried on.
class IpmRun final : public AnswerSink, public ActiveBlock {
 public:
  // @param test  of the system's problem
  IpmRun(ScaledSystem& system, GivenFormTest& test, const IpmOptions& own, const LcpOptions& options,
         IpmStatistics& statistics)
      : system_(system),
        test_(test),
        own_(own),
        options_(options),
        deadline_(options),
        limit_(options.max_iterations > 0 ? options.max_iterations : kDefaultLimit),
        statistics_(statistics),
        best_f_(Eigen::VectorXd::Zero(system.size())),
        candidate_(best_f_) {}

  ScaledSystem& system() { return system_; }
  // Weight of the proximal term.
  double proximal() const { return own_.proximal; }
  int correctors() const { return own_.correctors; }
  const LcpOptions& options() const { return options_; }
  IpmStatistics& statistics() { return statistics_; }

  // Factorizes A^ + diag(theta) if the limits allow it. False: limit_hit() or a breakdown told by system().why().
  bool Factorize(const Eigen::VectorXd& theta) {
    if (limit_hit()) return false;
    if (statistics_.factorizations >= limit_) {
      status_ = LcpStatus::kIterationLimit;
      return false;
    }
    if (NoTimeForAnother()) {
      status_ = LcpStatus::kTimeLimit;
      return false;
    }
    ++statistics_.factorizations;
    return system_.Factorize(theta);
  }
  // Seconds until the limit; false where none are left.
  bool TimeLeft(double* seconds) const {
    *seconds = options_.time_limit_s - deadline_.Elapsed();
    return *seconds > 0;
  }
  // True once a limit has stopped a factorization; limit_status() says which.
  bool limit_hit() const { return status_ != LcpStatus::kNotRun; }
  LcpStatus limit_status() const { return status_; }

  // Whether f (in the problem's units) meets the tier, in extended precision; remembers the iterate of least rho, one
  // that meets the tier before all that do not.
  bool Accept(const Eigen::VectorXd& f) {
    const double tolerance = kMargin * options_.tolerance;
    const auto rho = static_cast<double>(test_.Rho(f));
    bool meets = rho <= tolerance;
    for (Index i = 0; meets && i < f.size(); ++i) meets = test_.RowMeets(tolerance, f, i);
    return Note(f, rho, meets);
  }
  // The same for f^ in scaled variables; *w becomes the scaled gaps unless it is nullptr.
  bool AcceptScaled(const Eigen::VectorXd& scaled_f, Eigen::VectorXd* w) {
    const ScaledVectors& rows = system_.rows();
    for (Index i = 0; i < scaled_f.size(); ++i) candidate_[i] = rows.GivenForce(i, scaled_f[i]);
    const bool meets = Accept(candidate_);
    for (Index i = 0; w != nullptr && i < w->size(); ++i) {
      (*w)[i] = rows.ScaledGap(i, static_cast<double>(test_.w(i)));
    }
    return meets;
  }
  const Eigen::VectorXd& best_f() const { return best_f_; }
  double best_rho() const { return best_rho_; }
  // Whether best_f() meets the tier.
  bool accepted() const { return accepted_; }

  // AnswerSink
  Eigen::VectorXd& candidate() override { return candidate_; }
  // Accept where the candidate is near by its rho in double.
  bool Publish() override {
    const ScaledVectors& rows = system_.rows();
    scaled_.resize(candidate_.size());
    for (Index i = 0; i < candidate_.size(); ++i) scaled_[i] = rows.ScaledForce(i, candidate_[i]);
    system_.Multiply(scaled_, &product_);
    product_ += system_.b();
    latest_rho_ = rows.Rho(scaled_, product_);
    return latest_rho_ > kNear * options_.tolerance ? Note(candidate_, latest_rho_, false) : Accept(candidate_);
  }
  double rho() const override { return latest_rho_; }
  double tier() const override { return accepted_ ? best_rho_ : std::numeric_limits<double>::infinity(); }

  // ActiveBlock, of the prepared system: a factor within the limits of the run.
  void Analyze(const LcpProblem& /*problem*/) override {}
  void Load(const LcpProblem& /*problem*/, const Eigen::VectorXd& /*scale*/) override {}
  bool Factor(const std::vector<char>& active, double shift, const Deadline* /*deadline*/) override {
    out_.resize(system_.size());
    for (Index i = 0; i < out_.size(); ++i) out_[i] = active[static_cast<size_t>(i)] != 0 ? shift : ScaledSystem::kOut;
    if (!Factorize(out_)) return false;
    ++statistics_.pivots;
    return true;
  }
  void Solve(double* x) override {
    Eigen::Map<Eigen::VectorXd> values(x, out_.size());
    right_ = (out_.array() < ScaledSystem::kOut).select(values, 0.0);
    system_.Solve(right_, &right_);
    values = (out_.array() < ScaledSystem::kOut).select(right_, 0.0);
  }
  void Multiply(const double* x, double* y) const override {
    system_.Multiply(Eigen::Map<const Eigen::VectorXd>(x, out_.size()), &product_);
    std::copy(product_.begin(), product_.end(), y);
  }
  double factor_time() const override { return 0; }
  Index CountDependentRows() const override { return 0; }

 private:
  // Remembers it as Accept says.
  bool Note(const Eigen::VectorXd& f, double rho, bool meets) {
    if (meets == accepted_ ? rho < best_rho_ : meets) {
      best_f_ = f;
      best_rho_ = rho;
    }
    accepted_ = accepted_ || meets;
    return meets;
  }
  // A factorization cannot be interrupted, so none is begun that would end late by more than kAllowedOvershoot, if it
  // takes as long as the one before with all that followed.
  bool NoTimeForAnother() {
    const double now = deadline_.Elapsed();
    if (!std::isfinite(options_.time_limit_s)) return false;
    const double lap = last_factorization_ < 0 ? 0.0 : now - last_factorization_;
    last_factorization_ = now;
    return now >= options_.time_limit_s || now + lap > (1 + kAllowedOvershoot) * options_.time_limit_s;
  }

  static constexpr double kAllowedOvershoot = 0.1;
  static constexpr std::int64_t kDefaultLimit = 500;
  // Our residual and the verdict's differ by rounding; a claim must hold in both.
  static constexpr double kMargin = 0.9;
  // Times the tolerance: rho in double that calls for extended precision.
  static constexpr double kNear = 10;

  ScaledSystem& system_;
  GivenFormTest& test_;
  const IpmOptions& own_;
  const LcpOptions& options_;
  Deadline deadline_;
  std::int64_t limit_;
  IpmStatistics& statistics_;
  LcpStatus status_ = LcpStatus::kNotRun;
  double last_factorization_ = -1;  // when it began [s]
  Eigen::VectorXd best_f_;
  Eigen::VectorXd candidate_;
  Eigen::VectorXd scaled_;  // the latest candidate
  mutable Eigen::VectorXd product_;
  double latest_rho_ = 0;        // in double
  Eigen::VectorXd out_, right_;  // theta of the latest active set
  bool accepted_ = false;
  double best_rho_ = std::numeric_limits<double>::infinity();
};

// Of InteriorPoint.
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

// Mehrotra's predictor-corrector for  w = A f + b, f_C, w_C > 0, f_C w_C = mu, w_B = 0  in scaled variables, with
// Gondzio's centrality correctors. [Mehrotra 1992; Gondzio 1996; Wright, Primal-Dual Interior-Point Methods, ch. 10]
class InteriorPoint {
 public:
  enum class Progress {
    kGood,
    kStagnant,  // steps have become too short, or mu no longer falls
    kDiverged,  // f has left every reasonable bound: infeasible or very ill-conditioned
    kStopped,   // a limit, or no factorization
  };

  void Reserve(Index n);
  // Regularised equality solve and Mehrotra's shift (one factorization).
  Progress StartCold(IpmRun* run);
  // From f, moved onto f w = mu with f - w kept, so that no row is off centre (no factorization). [The smoothing of
  // Chen, Harker 1993 and Kanzow 1996, taken for a start]
  // @param mu_per_residual  mu in root mean squares of the natural residual of f
  void StartWarm(IpmRun* run, const Eigen::VectorXd& f, double mu_per_residual);
  // Where rows block the steps: back to the middle, f w = growth mu in every row with f - w as it is, from where
  // steps are long again.
  void Recentre(IpmRun* run, double growth);
  // One step (one factorization).
  Progress Step(IpmRun* run);

  const Eigen::VectorXd& f() const { return f_; }
  const Eigen::VectorXd& w() const { return w_; }
  double mu() const { return mu_; }
  // Part of its direction that the latest Step went, 0 to 1.
  double step() const { return step_; }
  // max |A f + b - w|.
  double residual() const { return residual_; }

 private:
  void Measure(IpmRun* run);
  void Centre(const ScaledSystem& system, double mu);
  bool FactorizeStep(IpmRun* run);
  void SolveSystem(IpmRun* run, const Eigen::VectorXd& r, Eigen::VectorXd* x);
  // A df - dw = -defects (A f + b - w) and, on the rows C, w df + f dw = products.
  void Direction(IpmRun* run, double defects, const Eigen::VectorXd& products, Eigen::VectorXd* df,
                 Eigen::VectorXd* dw);
  // The target, in mu, of those shares of `most` that leaves the least mu behind the step df + target centre_df.
  double ChooseTarget(const ScaledSystem& system, double most) const;
  double MaxStep(const ScaledSystem& system, const Eigen::VectorXd& df, const Eigen::VectorXd& dw) const;
  void CorrectCentrality(IpmRun* run, double target_mu);

  Eigen::VectorXd f_, w_, df_, dw_, affine_df_, affine_dw_, trial_df_, trial_dw_;
  Eigen::VectorXd centre_df_, centre_dw_;  // the direction of products mu
  Eigen::VectorXd theta_, defect_, right_, correction_, product_;
  Eigen::VectorXd target_;  // w df + f dw of the direction df_, dw_
  double step_ = 0;
  double mu_ = 0;
  double residual_ = 0;
  int contacts_ = 0;
  int poor_steps_ = 0;
  bool refine_ = false;  // whether the present factor needs a refinement after every solve
};

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

// Limits of InteriorFinish.
constexpr int kRefinements = 8;       // as long as each one leaves ...
constexpr double kRefineGain = 0.25;  // ... at most this fraction of rho
constexpr double kClose = 0.5;        // of the tolerance: what double calls enough before extended precision is asked
constexpr double kMoreDigits = 1e-3;  // of the tolerance: a right F gives them for a solve or two
constexpr double kWithinReach = 100;  // times the tolerance: rho from which sweeps are tried, ...
constexpr double kTryAgain = 0.4;     // ... again where rho has fallen to this fraction
constexpr std::int64_t kSweeps = 60;
constexpr double kNear = 5;  // times the tolerance: rho from which ...
constexpr std::int64_t kSweepsWhereNear = 300;
constexpr double kWorthSweeps = 1e6;  // flop; below, going on is as cheap, and exact

// Turns an interior iterate into an answer without another factorization. An interior point that has found mu leaves a
// residual of sqrt(mu) in every row where f and w both vanish, so that going on to mu = 1e-18 would take it twice as
// long as finding the active set. Two ways out, of which each costs less than one step:
//
// - Where the active set F = {f > w} is right, w_F = 0 is solved by iterative refinement on the factor of the latest
//   step: A + diag(w / f) is nearly A_FF on F and decouples the other rows. A wrong F shows after one solve.
// - Where it is nearly right, what is wrong is local, and sweeps of nonsmooth conjugate gradients mend it: one digit
//   in some 50 sweeps where redundant contacts leave many rows with f = w = 0. [nncg.h]
class InteriorFinish {
 public:
  // Set-up for a problem; the sweeps' own set-up waits until they are first needed.
  // @param factor_work  of one factorization [flop]: sweeps are for where that is much
  void Reserve(Index n, double factor_work);
  // To be called at the beginning of a solve.
  void Restart() { least_tried_ = std::numeric_limits<double>::infinity(); }

  // @param f, w  an interior iterate, scaled, after a step whose factor is the system's latest
  // @returns whether run->best_f() meets the tier now
  bool Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    return Polish(run, f, w) || (may_sweep_ && Sweep(run, f));
  }
  // Rows whose side the latest Try found to be wrong after one solve, as a fraction of all: how far F is from right.
  double wrong_rows() const { return wrong_rows_; }
  bool may_sweep() const { return may_sweep_; }
  // From run->best_f(), for as long as the rate of convergence promises the tier within `iterations`.
  // @returns as Try
  bool SweepFromBest(IpmRun* run, std::int64_t iterations) {
    const Eigen::VectorXd start = run->best_f();
    return Sweeps(run, start, kClose * run->options().tolerance, iterations);
  }

 private:
  bool Polish(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  bool Sweep(IpmRun* run, const Eigen::VectorXd& f);
  double Rho(const ScaledSystem& system, const Eigen::VectorXd& f);
  bool Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations);

  Eigen::VectorXd x_, gap_, right_, correction_;
  NncgSolver sweeps_{NncgOptions{.end_when_hopeless = true}};
  double wrong_rows_ = 1;
  bool may_sweep_ = false;
  double least_tried_ = 0;  // rho of the last iterate that the sweeps were given
};

void InteriorFinish::Reserve(Index n, double factor_work) {
  may_sweep_ = factor_work > kWorthSweeps;
  for (Eigen::VectorXd* v : {&x_, &gap_, &right_, &correction_}) v->setZero(n);
  Restart();
}

double InteriorFinish::Rho(const ScaledSystem& system, const Eigen::VectorXd& f) {
  system.Multiply(f, &gap_);
  gap_ += system.b();
  return system.rows().Rho(f, gap_);
}

bool InteriorFinish::Polish(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  ScaledSystem& system = run->system();
  const Index n = f.size();
  const double tolerance = run->options().tolerance;
  for (Index i = 0; i < n; ++i) {
    const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
    x_[i] = active ? f[i] : 0.0;
  }
  wrong_rows_ = 1;
  double rho = Rho(system, x_);
  bool accepted = false;
  for (int k = 0; k < kRefinements; ++k) {
    if (rho <= kClose * tolerance && run->AcceptScaled(x_, nullptr)) accepted = true;
    if (accepted && rho <= kMoreDigits * tolerance) return true;
    for (Index i = 0; i < n; ++i) {
      const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
      right_[i] = active ? -gap_[i] : 0.0;
    }
    system.Solve(right_, &correction_);
    Index wrong = 0;
    for (Index i = 0; i < n; ++i) {
      if (right_[i] == 0) continue;
      x_[i] += correction_[i];
      if (!system.unilateral(i) || x_[i] >= 0) continue;
      x_[i] = 0;
      ++wrong;
    }
    const double now = Rho(system, x_);
    if (k == 0) {
      for (Index i = 0; i < n; ++i) wrong += system.unilateral(i) && f[i] <= w[i] && gap_[i] < 0 ? 1 : 0;
      wrong_rows_ = static_cast<double>(wrong) / static_cast<double>(n);
    }
    if (!(now <= kRefineGain * rho) && (accepted || !(now <= kClose * tolerance))) break;
    rho = now;
  }
  // Where steps are cheap a better answer than this one is worth a few more.
  return accepted && may_sweep_;
}

bool InteriorFinish::Sweep(IpmRun* run, const Eigen::VectorXd& f) {
  ScaledSystem& system = run->system();
  const double tolerance = run->options().tolerance;
  const double rho = Rho(system, f);
  if (!(rho <= kWithinReach * tolerance) || rho > kTryAgain * least_tried_) return false;
  least_tried_ = rho;
  Eigen::VectorXd start(f.size());
  for (Index i = 0; i < f.size(); ++i) start[i] = system.rows().GivenForce(i, f[i]);
  return Sweeps(run, start, kClose * tolerance, rho <= kNear * tolerance ? kSweepsWhereNear : kSweeps);
}

bool InteriorFinish::Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations) {
  const LcpProblem& problem = run->system().problem();
  sweeps_.Prepare(problem);  // before the time that is left is measured
  LcpOptions options = run->options();
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  options.initial_f = &start;
  if (!run->TimeLeft(&options.time_limit_s)) return false;
  LcpResult result;
  sweeps_.Solve(problem, options, &result);
  return run->Accept(result.f);
}

}  // namespace

void IpmOptions::Read(SettingsReader* reader) {
  const std::string chosen = reader->Choice("space", "auto", {"auto", "contact", "body"});
  space = chosen == "contact" ? Space::kContact : chosen == "body" ? Space::kBody : Space::kAutomatic;
  proximal = reader->Number("proximal", proximal, 1e-13, 1e-6);
  correctors = static_cast<int>(reader->Number("correctors", correctors, 0, 10));
}

class IpmEngine {
 public:
  using WarmStart = IpmSolver::WarmStart;

  explicit IpmEngine(const IpmOptions& options) : options_(options) {}
  static constexpr bool kSolvesByFaces = true;

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem) {
    statistics_ = {};
    system_.Prepare(problem, options_.space);
    interior_.Reserve(problem.size());
    finish_.Reserve(problem.size(), system_.flops());
    warm_sweeps_ = static_cast<std::int64_t>(
        std::max(kLeastWarmSweeps,
                 kWarmSweepWork * CostModel::SweepsPerFactorization(problem, system_.flops(), system_.fill())));
    pivoting_.Reserve(problem);
    test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
    statistics_.analyses = system_.analyses();
    statistics_.body_space = system_.in_body_space();
    statistics_.fill = system_.fill();
    statistics_.factor_flops = system_.flops();
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    system_.SetB(problem);
    statistics_.factorizations = statistics_.interior_steps = statistics_.pivots = 0;
    test_.SetB(problem);
    IpmRun run(system_, test_, options_, options, statistics_);
    BlockPivoting::Task task;
    task.problem = &problem;
    task.scaled = &system_.rows();
    task.block = &run;
    task.sink = &run;
    task.factors = std::numeric_limits<std::int64_t>::max();  // limits are the run's
    task.tolerance = options.tolerance;
    task.through_bodies = system_.in_body_space();
    pivoting_.SetTask(task);
    result->status = SolveWithin(&run, result);
    if (run.accepted()) result->status = LcpStatus::kSolved;
    result->iterations = statistics_.factorizations;
    if (result->status == LcpStatus::kInfeasible && !result->farkas_ray.has_value()) {
      result->farkas_ray = std::move(pivoting_.ray());
    }
    result->f = run.best_f();
  }

  const IpmStatistics& statistics() const { return statistics_; }
  void UseWarmStart(WarmStart use) { use_ = use; }

 private:
  using End = BlockPivoting::End;
  using Progress = InteriorPoint::Progress;

  LcpStatus SolveWithin(IpmRun* run, LcpResult* result) {
    const LcpProblem& problem = system_.problem();
    const Index n = problem.size();
    result->farkas_ray = FindZeroRowRay(problem, 0);
    if (result->farkas_ray.has_value()) return LcpStatus::kInfeasible;

    bool live = false;
    bool contacts = false;
    for (Index i = 0; i < n; ++i) {
      live = live || !system_.idle(i);
      contacts = contacts || system_.unilateral(i);
    }
    if (run->Accept(Eigen::VectorXd::Zero(n))) return LcpStatus::kSolved;
    if (!live) {
      result->detail = "a row with A_ii = 0 has a gap acceleration that no force can change";
      return LcpStatus::kNumericalFailure;
    }
    Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd w = f;
    if (!contacts) return Finish(run, f, w, 0.0, result);

    finish_.Restart();
    bool warm = false;
    if (run->options().initial_f != nullptr) {
      const double rho_of_zero = run->best_rho();
      if (TryStart(run, rho_of_zero)) return LcpStatus::kSolved;
      if (run->limit_hit()) return Ended(run, End::kStopped, result);
      if (use_ == WarmStart::kGuessOnly) return LcpStatus::kIterationLimit;
      warm = run->best_rho() <= kCloseEnough * rho_of_zero;
    }
    if (warm) {
      system_.rows().Clip(run->best_f(), &f);
      interior_.StartWarm(run, f, use_ == WarmStart::kAfterSweeps ? kSweptMu : kWarmMu);
    } else if (interior_.StartCold(run) == Progress::kStopped) {
      return Ended(run, run->limit_hit() ? End::kStopped : End::kGaveUp, result);
    }

    double guess_below = kFirstFinish;
    int guesses = 0;
    int recentred = 0;
    int lifted = 0;
    const double few_wrong = finish_.may_sweep() ? kFewWrongRowsOfMany : kFewWrongRows;
    Progress progress = Progress::kGood;
    for (int k = 0; k < kInteriorSteps && progress == Progress::kGood && interior_.mu() > kLeastMu; ++k) {
      progress = interior_.Step(run);
      const bool stagnant = progress == Progress::kStagnant;
      // What sweeps have left is worth its short steps: they are as short from elsewhere.
      const bool doubtful = warm && use_ != WarmStart::kAfterSweeps;
      const bool blocked =
          progress == Progress::kGood && doubtful && k < kTrialSteps && interior_.step() < kBlockedStep;
      if (stagnant && recentred++ < kMostRecentred) {
        interior_.Recentre(run, kRecentredMu);
        progress = Progress::kGood;
        continue;
      }
      if (blocked && lifted++ < kMostLifts) {
        interior_.Recentre(run, kLift);
        k = -1;
        continue;
      }
      if (blocked || (stagnant && doubtful)) {
        warm = false;
        progress = interior_.StartCold(run);
        k = -1;
        recentred = guesses = 0;
        guess_below = kFirstFinish;
        continue;
      }
      if (progress != Progress::kGood) break;
      if (interior_.mu() > kFirstFinish || interior_.residual() > kFinishResidual) continue;
      if (finish_.Try(run, interior_.f(), interior_.w())) return LcpStatus::kSolved;
      if (interior_.mu() > guess_below || finish_.wrong_rows() > few_wrong) continue;
      guess_below = kNextGuess * interior_.mu();
      const double weight = guesses++ == 0 ? 0.0 : TameWeight(interior_.mu());
      const End end = TryActiveSets(interior_.f(), interior_.w(), kFromIterate, weight);
      if (run->limit_hit() || end == End::kDone || end == End::kInfeasible) return Ended(run, end, result);
    }
    return FinishFrom(progress, run, result);
  }

  // After the last interior step.
  LcpStatus FinishFrom(Progress progress, IpmRun* run, LcpResult* result) {
    if (run->limit_hit()) {
      Remember(run);
      return Ended(run, End::kStopped, result);
    }
    if (progress == Progress::kDiverged) {
      if (pivoting_.FindRay(interior_.f())) return Ended(run, End::kInfeasible, result);
      const Eigen::VectorXd w = interior_.w() - interior_.f();  // keeps F = {f > w} while c = 0
      return Finish(run, Eigen::VectorXd::Zero(w.size()), w, 0.0, result);
    }
    if (finish_.may_sweep()) {
      Remember(run);
      if (finish_.SweepFromBest(run, kLastSweeps)) return LcpStatus::kSolved;
    }
    return Finish(run, interior_.f(), interior_.w(), TameWeight(interior_.mu()), result);
  }

  // All of a warm start that comes before the interior point; what it finds is run->best_f(). True if that is it.
  bool TryStart(IpmRun* run, double rho_of_zero) {
    Eigen::VectorXd f(system_.size()), w(system_.size());
    system_.rows().Clip(*run->options().initial_f, &f);
    if (run->AcceptScaled(f, &w)) return true;
    if (!(run->best_rho() <= kWorthTrying * rho_of_zero)) return false;
    if (TryActiveSets(f, w, kFromStart, 0) == End::kDone) return true;
    if (run->limit_hit() || use_ != WarmStart::kFull) return false;
    return finish_.SweepFromBest(run, warm_sweeps_);
  }

  End TryActiveSets(const Eigen::VectorXd& f, const Eigen::VectorXd& w, BlockPivoting::Rules rules, double weight) {
    rules.weight = std::max(rules.weight, weight);
    pivoting_.StartFrom(f, w);
    return pivoting_.TakeProximalSteps(rules);
  }

  LcpStatus Finish(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w, double weight, LcpResult* result) {
    return Ended(run, TryActiveSets(f, w, kLastResort, weight), result);
  }

  LcpStatus Ended(IpmRun* run, End end, LcpResult* result) {
    if (run->accepted()) return LcpStatus::kSolved;
    if (end == End::kInfeasible) return LcpStatus::kInfeasible;
    if (run->limit_hit()) return run->limit_status();
    result->detail = "the active-set method ended above the tolerance";
    if (!system_.why().empty()) result->detail += "; " + system_.why();
    return LcpStatus::kNumericalFailure;
  }

  void Remember(IpmRun* run) { run->AcceptScaled(interior_.f(), nullptr); }

  IpmOptions options_;
  WarmStart use_ = WarmStart::kFull;
  std::int64_t warm_sweeps_ = 0;
  IpmStatistics statistics_;
  ScaledSystem system_;
  InteriorPoint interior_;
  InteriorFinish finish_;
  BlockPivoting pivoting_;
  GivenFormTest test_;
};

std::string IpmEngine::WhyUnsupported(const LcpProblem& problem) const {
  if (!problem.IsNumericallySymmetric()) return WhyNotSymmetric(problem);
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  for (Index i = 0; i < problem.size(); ++i) {
    if (diagonal[i] > 0) continue;
    const std::string row = std::to_string(i);
    if (diagonal[i] < 0) return "A is not positive semidefinite: its diagonal entry " + row + " is negative";
    if (problem.has_factors()) continue;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
      if (it.value() != 0) return "A is not positive semidefinite: row " + row + " is nonzero beside a zero diagonal";
    }
  }
  return {};
}

const IpmStatistics& IpmSolver::statistics() const { return engine_->statistics(); }

void IpmSolver::UseWarmStart(WarmStart use) { engine_->UseWarmStart(use); }

template class EngineSolver<IpmOptions, IpmEngine>;

}  // namespace lcpbench
