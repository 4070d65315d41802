#include "solvers/semismooth_newton.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "solvers/lcp/input_error.h"
#include "solvers/semismooth_newton_engine.h"
#include "solvers/zero_row_ray.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastAllowedWeight = 1e-10;
constexpr int kMaxProximalSteps = 100;
// A subproblem that takes more steps than this is too hard for double precision: its weight is raised by kRaise, and
// does not fall below that any more.
constexpr std::int64_t kMostNewtonSteps = 60;
constexpr double kRaise = 1000;
constexpr double kHeaviestWeight = 1;
// Where the slope along the step has fallen to this part of the one at its start, the minimum is close enough. A full
// step is worth more than a slope of that size: it may end the subproblem.
constexpr double kFlatSlope = 1e-3;
constexpr int kMaxLineSteps = 50;
// A proof of infeasibility is worth while above this rho only, or above the tolerance if that is less.
constexpr double kProofTolerance = 1e-9;
// A warm start is tried if its rho is at most this part of the one at f = 0: else it is no start for this problem.
constexpr double kUsefulStart = 0.5;
// Larger problems are not tried as dense ones.
constexpr Eigen::Index kMaxDenseRows = 10000;
// Proximal steps before the first look for a ray. Feasible problems rarely need more.
constexpr int kFirstRayStep = 3;
// Continuation: how the weight follows the Newton steps that its subproblems take.
constexpr double kContinuationStart = 1;
constexpr double kContinuationEnd = 1e-8;
constexpr double kContinuationFactor = 0.1;
constexpr std::int64_t kFewSteps = 5;
constexpr std::int64_t kModerateSteps = 15;
constexpr std::int64_t kMostContinuationSteps = 200;
constexpr double kSlow = 0.7;  // of rho, from one proximal step to the next
// Rounding of w is magnified by 1 / eps: where rho rises with a weight up to this, that is why.
constexpr double kNoisyWeight = 3e-7;
// The finish is tried below this rho, and again when rho has fallen to kWorthAnother of what it was then.
constexpr double kWorthFinish = 1e-4;
constexpr double kWorthAnother = 0.1;
// A proximal step at least this part of f / steps so far does not look like convergence.
constexpr double kDivergence = 0.25;
// So many proximal steps, then the other path: problems that are unsolvable but for rounding, mostly.
constexpr int kMaxContinuationSteps = 50;

}  // namespace

void SemismoothNewtonSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  n_ = problem.size();
  block_ = blocks_.Analyze(problem, {.dense = n_ <= kMaxDenseRows, .bodies = n_ >= options_.continuation_rows});
  if (options_.self_check) {
    test_.Reset(problem);
    judge_.Reset(problem, blocks_.is_dense(block_));
  }
  judged_.f.setZero(n_);
  scaled_.Resize(n_);
  for (Eigen::VectorXd* v : {&c_, &u_, &w_, &step_, &step_w_, &inverse_, &growth_, &f_, &residual_, &f_trial_}) {
    v->setZero(n_);
  }
  for (std::vector<char>* v : {&in_F_, &bilateral_}) v->assign(At(n_), 0);
  for (const Index i : problem.bilateral_rows()) bilateral_[At(i)] = 1;
  stack_.reserve(At(n_));
}

// rho up to a factor, of forces f and w = A f + b.
double SemismoothNewtonSolver::Engine::Residual(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  double sum = 0;
  for (Index p = 0; p < n_; ++p) {
    const double d = scaled_.diagonal[p];
    const double r = is_joint(p) ? w[p] : std::min(d * f[p], w[p]);
    sum += r * r / d;
  }
  return std::sqrt(sum);
}

// True if there is a warm start that is worth trying; else c = 0.
bool SemismoothNewtonSolver::Engine::Start(const Eigen::VectorXd* initial_f) {
  c_.setZero();
  growth_.setZero();
  best_rho_ = kInfinity;
  bool warm = false;
  if (initial_f != nullptr) {
    const double cold_residual = Residual(c_, scaled_.b);
    for (Index p = 0; p < n_; ++p) {
      const double given = scaled_.ScaledForce(p, (*initial_f)[p]);
      c_[p] = is_joint(p) ? given : std::max(given, 0.0);
      if (scaled_.can_act[At(p)] == 0) c_[p] = 0;
    }
    block_->Multiply(c_.data(), w_.data());
    w_ += scaled_.b;
    warm = Residual(c_, w_) <= kUsefulStart * cold_residual;
    if (!warm) c_.setZero();
  }
  if (!warm) w_ = scaled_.b;
  u_ = c_;
  return warm;
}

SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::Factor(double shift) {
  if (factors_ >= factor_limit_) return End::kIterationLimit;
  ++factors_;
  return block_->Factor(in_F_, shift, &*deadline_) ? End::kGoOn : End::kTimeLimit;
}

// F of the current u. Returns how many rows changed sides.
Eigen::Index SemismoothNewtonSolver::Engine::FindActiveSet(double eps) {
  Index changed = 0;
  for (Index p = 0; p < n_; ++p) {
    const bool is_in = scaled_.can_act[At(p)] != 0 && (is_joint(p) || c_[p] * eps * scaled_.diagonal[p] - w_[p] > 0);
    changed += is_in != (in_F_[At(p)] != 0) ? 1 : 0;
    in_F_[At(p)] = is_in ? 1 : 0;
  }
  return changed;
}

// Phi'(t) along the step.
double SemismoothNewtonSolver::Engine::Slope(double t, double* curvature) const {
  double slope = slope_at_0_ + t * curvature_;
  double second = curvature_;
  for (Index p = 0; p < n_; ++p) {
    const double f = c_[p] - (w_[p] + t * step_w_[p]) * inverse_[p];
    const bool counts = scaled_.can_act[At(p)] != 0 && (f > 0 || is_joint(p));
    slope -= counts ? f * step_w_[p] : 0;
    second += counts ? step_w_[p] * step_w_[p] * inverse_[p] : 0;
  }
  *curvature = second;
  return slope;
}

// The minimum of Phi along the step in (0, 1]: Newton's method on its increasing piecewise linear slope, kept in a
// bracket.
double SemismoothNewtonSolver::Engine::StepLength() const {
  double curvature = 0;
  double slope = Slope(1, &curvature);
  if (slope <= 0) return 1;
  double ignored = 0;
  const double flat = kFlatSlope * std::abs(Slope(0, &ignored));
  double low = 0;
  double high = 1;
  double t = 1;
  for (int k = 0; k < kMaxLineSteps && std::abs(slope) > flat && !deadline_->Expired(); ++k) {
    (slope > 0 ? high : low) = t;
    const double next = t - slope / curvature;
    t = next > low && next < high ? next : 0.5 * (low + high);
    slope = Slope(t, &curvature);
  }
  return t;
}

SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::SolveSubproblem(double eps) {
  for (Index p = 0; p < n_; ++p) inverse_[p] = 1 / (eps * scaled_.diagonal[p]);
  FindActiveSet(eps);
  const std::int64_t most = factors_ + (continuation_ ? kMostContinuationSteps : kMostNewtonSteps);
  for (bool full_step = false;;) {
    if (factors_ >= most && eps < kHeaviestWeight) return End::kStalled;
    const End end = Factor(eps);
    if (end != End::kGoOn) return end;
    for (Index p = 0; p < n_; ++p) step_[p] = eps * scaled_.diagonal[p] * c_[p] - scaled_.b[p];
    block_->Solve(step_.data());
    if (deadline_->Expired()) return End::kTimeLimit;
    step_ -= u_;
    block_->Multiply(step_.data(), step_w_.data());
    slope_at_0_ = u_.dot(step_w_);
    curvature_ = step_.dot(step_w_);
    const double t = StepLength();
    full_step = t == 1;
    u_ += t * step_;
    w_ += t * step_w_;
    exact_ = FindActiveSet(eps) == 0 && full_step;
    if (exact_) return End::kGoOn;
    if (t * step_.cwiseAbs().maxCoeff() <= std::numeric_limits<double>::epsilon() * u_.cwiseAbs().maxCoeff()) {
      exact_ = true;
      return End::kGoOn;  // F flips over by rounding only
    }
    if (deadline_->Expired()) return End::kTimeLimit;
  }
}

bool SemismoothNewtonSolver::Engine::IsDiverging(int steps) const {
  if (best_rho_ <= std::min(tolerance_, kProofTolerance)) return false;
  const double moved = (scaled_.diagonal.array() * growth_.array().square()).maxCoeff();
  const double size = (scaled_.diagonal.array() * c_.array().square()).maxCoeff();
  return std::sqrt(moved) * (steps + 1) >= kDivergence * std::sqrt(size);
}

void SemismoothNewtonSolver::Engine::RestartFromCenter() {
  u_ = c_;
  block_->Multiply(u_.data(), w_.data());
  w_ += scaled_.b;
}

void SemismoothNewtonSolver::Engine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  problem_ = problem;
  if (options_.self_check) {
    test_.SetB(problem);
    judge_.SetB(problem);
  }
  tolerance_ = options.tolerance;
  deadline_.emplace(options);
  factors_ = 0;
  continuation_ = n_ >= options_.continuation_rows;
  factor_limit_ = options.max_iterations > 0 ? options.max_iterations
                  : continuation_            ? kContinuationFactors
                                             : kDefaultFactors;
  if (!scaled_.Load(*problem_)) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return;
  }
  block_->Load(*problem_, scaled_.scale);
  const bool warm = Start(options.initial_f);
  if (auto ray = FindZeroRowRay(*problem_, std::min(tolerance_, kProofTolerance) * scaled_.b_norm)) {
    result->farkas_ray = std::move(ray);
    result->status = LcpStatus::kInfeasible;
    return;
  }
  End end = End::kGoOn;
  double eps = continuation_ ? kContinuationStart : options_.first_weight;
  double least_weight = continuation_ ? kContinuationEnd : options_.least_weight;
  double rho_before = kInfinity;
  double finished_rho = kWorthFinish / kWorthAnother;
  if (warm) end = FinishFromStart(result);
  for (int k = 0; k < kMaxProximalSteps && end == End::kGoOn; ++k) {
    if (continuation_ && k == kMaxContinuationSteps) {
      continuation_ = false;
      eps = options_.first_weight;
      least_weight = options_.least_weight;
    }
    const std::int64_t before = factors_;
    end = SolveSubproblem(eps);
    if (end == End::kStalled) {
      eps = least_weight = std::min(kHeaviestWeight, eps * (continuation_ ? 1 / kContinuationFactor : kRaise));
      RestartFromCenter();
      end = End::kGoOn;
      continue;
    }
    if (end != End::kGoOn) break;
    for (Index p = 0; p < n_; ++p) {
      // The two are the same where u solves the subproblem, but w / eps magnifies the rounding of w.
      double next = exact_ && continuation_ ? u_[p] : c_[p] - w_[p] * inverse_[p];
      if (!is_joint(p)) next = std::max(next, 0.0);
      if (scaled_.can_act[At(p)] == 0) next = 0;
      growth_[p] = next - c_[p];
      c_[p] = next;
    }
    if (!continuation_) {
      end = Finish(result);
      if (end == End::kGoOn && k >= kFirstRayStep && best_rho_ > std::min(tolerance_, kProofTolerance))
        end = TryRay(result);
      eps = std::max(least_weight, eps * options_.weight_factor);
      continue;
    }
    const std::int64_t steps = factors_ - before;
    RestartFromCenter();
    const double rho = Residual(c_, w_) / (scaled_.b_norm * scaled_.b_scale);
    if (rho < best_rho_) {
      f_ = c_;
      Publish(rho, result);
    }
    const bool is_answer = IsAnswer(result);
    if (is_answer || rho <= kWorthAnother * finished_rho) {
      finished_rho = rho;
      end = FinishFromStart(result);
    }
    if (end == End::kGoOn && is_answer) end = End::kDone;
    if (end == End::kGoOn && k >= kFirstRayStep && IsDiverging(k)) end = TryRay(result);
    const bool is_slow = steps <= kModerateSteps && rho > kSlow * rho_before;
    if (rho >= rho_before && eps <= kNoisyWeight) {
      eps = least_weight = eps / kContinuationFactor;
    } else if (steps <= kFewSteps || is_slow) {
      eps = std::max(least_weight, eps * kContinuationFactor);
    }
    rho_before = rho;
  }
  if (best_rho_ == kInfinity) {
    f_ = c_;
    if (end == End::kTimeLimit) {
      for (Index p = 0; p < n_; ++p) result->f[p] = scaled_.GivenForce(p, c_[p]);
    } else {
      Publish(RhoInDouble(), result);
    }
  }
  result->iterations = factors_;
  switch (end) {
    case End::kDone:
      result->status = LcpStatus::kSolved;
      break;
    case End::kInfeasible:
      result->status = LcpStatus::kInfeasible;
      break;
    case End::kTimeLimit:
      result->status = LcpStatus::kTimeLimit;
      break;
    case End::kIterationLimit:
      result->status = LcpStatus::kIterationLimit;
      break;
    case End::kStalled:
    case End::kGoOn: {
      if (IsAnswer(result)) {
        result->status = LcpStatus::kSolved;
        break;
      }
      char text[96];
      std::snprintf(text, sizeof text, "rho %.1e after %d proximal steps, and no proven ray", best_rho_,
                    kMaxProximalSteps);
      result->detail = text;
      break;
    }
  }
}

SemismoothNewtonOptions SemismoothNewtonOptions::FromSettings(const Settings& settings, const char* key) {
  SettingsReader reader(key, settings);
  SemismoothNewtonOptions options;
  options.first_weight = reader.Number("first_weight", options.first_weight, kLeastAllowedWeight, 1);
  options.weight_factor = reader.Number("weight_factor", options.weight_factor, kLeastAllowedWeight, 1);
  options.least_weight = reader.Number("least_weight", options.least_weight, kLeastAllowedWeight, 1);
  options.self_check = reader.SelfCheck();
  options.continuation_rows =
      static_cast<Index>(reader.Number("continuation_rows", static_cast<double>(options.continuation_rows), 1, 1e9));
  reader.Finish();
  return options;
}

SemismoothNewtonSolver::SemismoothNewtonSolver(SemismoothNewtonOptions options)
    : engine_(std::make_unique<Engine>(options)) {
  for (const double weight : {options.first_weight, options.weight_factor, options.least_weight}) {
    if (!(weight >= kLeastAllowedWeight && weight <= 1)) {
      throw InputError("semismooth-newton: weights must be in [1e-10, 1]");
    }
  }
}
SemismoothNewtonSolver::~SemismoothNewtonSolver() = default;

std::string SemismoothNewtonSolver::WhyUnsupported(const LcpProblem& problem) const {
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

double SemismoothNewtonSolver::StepTime() const { return engine_->StepTime(); }

void SemismoothNewtonSolver::DoPrepare(const LcpProblem& problem) { engine_->Prepare(problem); }

void SemismoothNewtonSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(problem, options, result);
}

}  // namespace lcpbench
