#include "solvers/semismooth_newton.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/active_block_choice.h"
#include "solvers/given_form.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "solvers/power_of_two.h"
#include "solvers/zero_row_ray.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastAllowedWeight = 1e-10;
// The shift of the finish, relative to the diagonal: the correction converges like (shift / eigenvalue)^k, and rounding
// of the factor, about 1e-15, must stay small beside it.
constexpr double kFinishShift = 1e-10;
constexpr int kFinishSteps = 6;
// Where b is consistent with dependent rows only up to rounding r, a correction moves f by r / shift in the null space,
// which can make forces negative. If c itself is nearly right, a heavier shift is tried then.
constexpr double kGentleShift = 1e-6;
constexpr double kNearlySolved = 1e-3;
// rho that is good enough to stop refining, whatever the tolerance: a direct method pays next to nothing for it.
constexpr double kGoodEnough = 1e-13;
// Refining goes on while rho falls by this factor.
constexpr double kFinishProgress = 0.5;
constexpr int kMaxProximalSteps = 100;
// Where the slope along the step has fallen to this part of the one at its start, the minimum is close enough. A full
// step is worth more than a slope of that size: it may end the subproblem.
constexpr double kFlatSlope = 1e-3;
constexpr int kMaxLineSteps = 50;
// Forces below these parts of the largest D^1/2 f are tried as zeros where a row fails in its own units only.
constexpr double kSnapLevels[] = {1e-15, 1e-13, 1e-10};
constexpr int kTinyRowSweeps = 4;
// A proof of infeasibility is worth while above this rho only, or above the tolerance if that is less.
constexpr double kProofTolerance = 1e-9;
// Larger problems are not tried as dense ones.
constexpr Eigen::Index kMaxDenseRows = 10000;
// Rays: components below this part of the largest are rounding, and corrections into the null space.
constexpr double kRaySupport = 1e-7;
constexpr int kRayCorrections = 6;
// Proximal steps before the first look for a ray. Feasible problems rarely need more.
constexpr int kFirstRayStep = 3;

size_t At(Eigen::Index i) { return static_cast<size_t>(i); }

}  // namespace

class SemismoothNewtonSolver::Engine {
 public:
  explicit Engine(SemismoothNewtonOptions options) : options_(options) {}

  void Prepare(const LcpProblem& problem);
  void Solve(const LcpOptions& options, LcpResult* result);

 private:
  enum class End { kGoOn, kDone, kInfeasible, kTimeLimit, kIterationLimit };

  bool Load();
  void Start(const Eigen::VectorXd* initial_f);
  End Factor(double shift);
  Index FindActiveSet(double eps);
  End SolveSubproblem(double eps);
  double StepLength() const;
  double Slope(double t, double* curvature) const;
  End Finish(LcpResult* result);
  End FinishWith(double shift, LcpResult* result);
  bool Publish(LcpResult* result);
  bool IsAnswer(LcpResult* result);
  bool RepairTinyRows(LcpResult* result);
  End TryRay(LcpResult* result);
  double RhoInDouble();

  bool is_joint(Index p) const { return bilateral_[At(p)] != 0; }

  SemismoothNewtonOptions options_;
  std::optional<LcpProblem> problem_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  GivenFormTest test_;
  double tolerance_ = 0;
  std::int64_t factors_ = 0, factor_limit_ = 0;
  std::optional<Deadline> deadline_;

  Index n_ = 0;
  double b_scale_ = 1;
  Eigen::VectorXd diagonal_, b_, scale_;   // scaled: S A S, t S b, t S^-1 f
  std::vector<char> can_act_, bilateral_;  // can_act_: A_ii > 0
  Eigen::VectorXd c_, u_, w_;              // proximal centre, dual point, A u + b
  Eigen::VectorXd step_, step_w_;          // u' - u and A (u' - u)
  Eigen::VectorXd inverse_;                // 1 / (eps D)
  Eigen::VectorXd growth_;                 // c - previous c
  Eigen::VectorXd f_, residual_;           // of the finish
  Eigen::VectorXd f_trial_;                // in the problem's units
  std::vector<char> in_F_;
  std::vector<Index> stack_;
  double slope_at_0_ = 0, curvature_ = 0;  // of 1/2 u.A u along the step
  double b_norm_ = 1;
  double best_rho_ = kInfinity;
  double center_rho_ = kInfinity;  // of c, before its correction
};

void SemismoothNewtonSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  n_ = problem.size();
  block_ = blocks_.Analyze(problem, true, n_ <= kMaxDenseRows);
  test_.Reset(problem);
  for (Eigen::VectorXd* v :
       {&diagonal_, &b_, &scale_, &c_, &u_, &w_, &step_, &step_w_, &inverse_, &growth_, &f_, &residual_, &f_trial_}) {
    v->setZero(n_);
  }
  for (std::vector<char>* v : {&in_F_, &can_act_, &bilateral_}) v->assign(At(n_), 0);
  for (const Index i : problem.bilateral_rows()) bilateral_[At(i)] = 1;
  stack_.reserve(At(n_));
}

// Powers of two S_ii that bring A_ii into [1, 4) and t that brings the largest |b_i| into [1, 2). False if an A_ii < 0.
bool SemismoothNewtonSolver::Engine::Load() {
  const Eigen::VectorXd& d = problem_->DiagonalA();
  const Eigen::VectorXd& b = problem_->b();
  double largest = 0;
  for (Index p = 0; p < n_; ++p) {
    if (d[p] < 0) return false;
    const bool can_act = d[p] > 0;
    can_act_[At(p)] = can_act ? 1 : 0;
    scale_[p] = can_act ? ScaleOfDiagonal(d[p]) : 1.0;
    diagonal_[p] = can_act ? (d[p] * scale_[p]) * scale_[p] : 1.0;
    b_[p] = can_act ? b[p] * scale_[p] : 0.0;  // a zero row is judged by FindZeroRowRay alone
    largest = std::max(largest, std::abs(b_[p]));
  }
  b_scale_ = ScaleOfLargest(largest);
  b_ *= b_scale_;
  double sum = 0;
  for (Index p = 0; p < n_; ++p) sum += b_[p] * b_[p] / diagonal_[p];
  b_norm_ = sum == 0 ? 1.0 : std::sqrt(sum);
  block_->Load(*problem_, scale_);
  return true;
}

void SemismoothNewtonSolver::Engine::Start(const Eigen::VectorXd* initial_f) {
  c_.setZero();
  growth_.setZero();
  w_ = b_;
  if (initial_f != nullptr) {
    for (Index p = 0; p < n_; ++p) {
      const double given = (*initial_f)[p] * b_scale_ / scale_[p];
      c_[p] = is_joint(p) ? given : std::max(given, 0.0);
      if (can_act_[At(p)] == 0) c_[p] = 0;
    }
    block_->Multiply(c_.data(), w_.data());
    w_ += b_;
  }
  u_ = c_;
  best_rho_ = kInfinity;
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
    const bool is_in = can_act_[At(p)] != 0 && (is_joint(p) || c_[p] * eps * diagonal_[p] - w_[p] > 0);
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
    const bool counts = can_act_[At(p)] != 0 && (f > 0 || is_joint(p));
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
  for (int k = 0; k < kMaxLineSteps && std::abs(slope) > flat; ++k) {
    (slope > 0 ? high : low) = t;
    const double next = t - slope / curvature;
    t = next > low && next < high ? next : 0.5 * (low + high);
    slope = Slope(t, &curvature);
  }
  return t;
}

SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::SolveSubproblem(double eps) {
  for (Index p = 0; p < n_; ++p) inverse_[p] = 1 / (eps * diagonal_[p]);
  FindActiveSet(eps);
  for (bool full_step = false;;) {
    const End end = Factor(eps);
    if (end != End::kGoOn) return end;
    for (Index p = 0; p < n_; ++p) step_[p] = eps * diagonal_[p] * c_[p] - b_[p];
    block_->Solve(step_.data());
    step_ -= u_;
    block_->Multiply(step_.data(), step_w_.data());
    slope_at_0_ = u_.dot(step_w_);
    curvature_ = step_.dot(step_w_);
    const double t = StepLength();
    full_step = t == 1;
    u_ += t * step_;
    w_ += t * step_w_;
    if (FindActiveSet(eps) == 0 && full_step) return End::kGoOn;
    if (t * step_.cwiseAbs().maxCoeff() <= std::numeric_limits<double>::epsilon() * u_.cwiseAbs().maxCoeff()) {
      return End::kGoOn;  // F flips over by rounding only
    }
    if (deadline_->Expired()) return End::kTimeLimit;
  }
}

double SemismoothNewtonSolver::Engine::RhoInDouble() {
  block_->Multiply(f_.data(), residual_.data());
  residual_ += b_;
  double sum = 0;
  for (Index p = 0; p < n_; ++p) {
    const double d = diagonal_[p];
    const double r = is_joint(p) || can_act_[At(p)] == 0 ? (is_joint(p) ? residual_[p] : std::min(residual_[p], 0.0))
                                                         : std::min(d * f_[p], residual_[p]);
    sum += r * r / d;
  }
  return std::sqrt(sum) / b_norm_;
}

// Keeps f_ if it is the best so far. True if it is good enough to stop.
bool SemismoothNewtonSolver::Engine::Publish(LcpResult* result) {
  for (Index p = 0; p < n_; ++p) {
    const double f = f_[p] * (scale_[p] / b_scale_);
    f_trial_[p] = is_joint(p) ? f : std::max(f, 0.0);
  }
  const auto rho = static_cast<double>(test_.Rho(f_trial_));
  if (!(rho < best_rho_)) return false;
  best_rho_ = rho;
  result->f.swap(f_trial_);
  if (!(rho <= kGoodEnough)) return false;
  for (Index p = 0; p < n_; ++p) {
    if (!test_.RowMeets(tolerance_, result->f, p)) return false;
  }
  return true;
}

// f_F near c_F with w_F = 0.
SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::Finish(LcpResult* result) {
  const End end = FinishWith(kFinishShift, result);
  if (end != End::kGoOn || !(center_rho_ <= kNearlySolved)) return end;
  return FinishWith(kGentleShift, result);
}

SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::FinishWith(double shift, LcpResult* result) {
  const End end = Factor(shift);
  if (end != End::kGoOn) return end;
  for (Index p = 0; p < n_; ++p) f_[p] = in_F_[At(p)] != 0 ? c_[p] : 0;
  double rho = RhoInDouble();
  center_rho_ = rho;
  for (int k = 0; k < kFinishSteps && rho > kGoodEnough; ++k) {
    block_->Solve(residual_.data());
    f_ -= residual_;
    const double before = rho;
    rho = RhoInDouble();
    if (k > 0 && !(rho <= kFinishProgress * before)) break;
  }
  if (Publish(result)) return End::kDone;
  // Once more with the residual of the given form in extended precision, if rounding is what is left.
  if (best_rho_ > std::sqrt(kGoodEnough)) return End::kGoOn;
  for (int k = 0; k < kFinishSteps; ++k) {
    const double before = best_rho_;
    for (Index p = 0; p < n_; ++p) {
      residual_[p] = static_cast<double>(test_.w(p)) * b_scale_ * scale_[p];
    }
    block_->Solve(residual_.data());
    f_ -= residual_;
    if (Publish(result)) return End::kDone;
    if (!(best_rho_ <= kFinishProgress * before)) break;
  }
  return IsAnswer(result) || RepairTinyRows(result) ? End::kDone : End::kGoOn;
}

bool SemismoothNewtonSolver::Engine::IsAnswer(LcpResult* result) {
  return best_rho_ <= tolerance_ && test_.Meets(tolerance_, result->f);
}

// For an f that meets rho but not the componentwise measure, which then fails in rows where all terms are tiny.
bool SemismoothNewtonSolver::Engine::RepairTinyRows(LcpResult* result) {
  if (!(best_rho_ <= tolerance_)) return false;
  // Forces that should be zero are often only zero to rounding.
  double largest = 0;
  for (Index p = 0; p < n_; ++p) largest = std::max(largest, diagonal_[p] * f_[p] * f_[p]);
  for (const double level : kSnapLevels) {
    for (Index p = 0; p < n_; ++p) {
      const bool tiny = diagonal_[p] * f_[p] * f_[p] <= level * level * largest;
      f_trial_[p] = tiny ? 0.0 : result->f[p];
    }
    if (!test_.Meets(tolerance_, f_trial_)) continue;
    result->f.swap(f_trial_);
    return true;
  }
  // Forces that should be a tiny positive number: the failing rows are relaxed one by one, in their own units.
  f_trial_ = result->f;
  for (int k = 0; k < kTinyRowSweeps; ++k) {
    test_.Rho(f_trial_);
    for (Index p = 0; p < n_; ++p) {
      const Index i = p;
      if (can_act_[At(p)] == 0 || test_.RowMeets(tolerance_, f_trial_, i)) continue;
      const double f = f_trial_[i] - static_cast<double>(test_.w(i)) / problem_->DiagonalA()[i];
      f_trial_[i] = is_joint(p) ? f : std::max(f, 0.0);
    }
    if (!test_.Meets(tolerance_, f_trial_)) continue;
    result->f.swap(f_trial_);
    return true;
  }
  return false;
}

// Where the problem has no solution, c grows along a ray y: A y = 0, y_C >= 0, b.y < 0. Its largest connected part is
// corrected into the null space of A and put to the proof.
SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::TryRay(LcpResult* result) {
  Index top = 0;
  double largest = growth_.cwiseAbs().maxCoeff(&top);
  if (!(largest > 0) || !(growth_.dot(b_) < 0)) return End::kGoOn;
  std::fill(in_F_.begin(), in_F_.end(), 0);
  stack_.assign(1, top);
  in_F_[At(top)] = 1;
  while (!stack_.empty()) {
    const Index p = stack_.back();
    stack_.pop_back();
    for (SparseMatrix::InnerIterator it(problem_->SparseA(), p); it; ++it) {
      const Index q = it.col();
      if (in_F_[At(q)] != 0 || it.value() == 0 || can_act_[At(q)] == 0) continue;
      if (!(is_joint(q) ? std::abs(growth_[q]) > 0 : growth_[q] > kRaySupport * largest)) continue;
      in_F_[At(q)] = 1;
      stack_.push_back(q);
    }
  }
  for (Index p = 0; p < n_; ++p) f_[p] = in_F_[At(p)] != 0 ? growth_[p] / largest : 0;
  const End end = Factor(kFinishShift);
  if (end != End::kGoOn) return end;
  for (int k = 0; k < kRayCorrections; ++k) {
    block_->Multiply(f_.data(), residual_.data());
    block_->Solve(residual_.data());
    f_ -= residual_;
  }
  Eigen::VectorXd ray = Eigen::VectorXd::Zero(n_);
  for (Index p = 0; p < n_; ++p) {
    const double y = is_joint(p) ? f_[p] : std::max(f_[p], 0.0);
    ray[p] = y * scale_[p];
  }
  if (!ray.allFinite() || !VerifyFarkasRay(*problem_, ray).accepted) return End::kGoOn;
  result->farkas_ray = std::move(ray);
  return End::kInfeasible;
}

void SemismoothNewtonSolver::Engine::Solve(const LcpOptions& options, LcpResult* result) {
  tolerance_ = options.tolerance;
  deadline_.emplace(options);
  factors_ = 0;
  factor_limit_ = options.max_iterations > 0 ? options.max_iterations : kDefaultFactors;
  if (!Load()) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return;
  }
  Start(options.initial_f);
  if (auto ray = FindZeroRowRay(*problem_, std::min(tolerance_, kProofTolerance) * b_norm_ / b_scale_)) {
    result->farkas_ray = std::move(ray);
    result->status = LcpStatus::kInfeasible;
    return;
  }
  End end = End::kGoOn;
  double eps = options_.first_weight;
  if (options.initial_f != nullptr) {
    FindActiveSet(eps);
    end = Finish(result);
  }
  for (int k = 0; k < kMaxProximalSteps && end == End::kGoOn; ++k) {
    end = SolveSubproblem(eps);
    if (end != End::kGoOn) break;
    for (Index p = 0; p < n_; ++p) {
      double next = c_[p] - w_[p] * inverse_[p];
      if (!is_joint(p)) next = std::max(next, 0.0);
      if (can_act_[At(p)] == 0) next = 0;
      growth_[p] = next - c_[p];
      c_[p] = next;
    }
    end = Finish(result);
    if (end == End::kGoOn && k >= kFirstRayStep && best_rho_ > std::min(tolerance_, kProofTolerance))
      end = TryRay(result);
    eps = std::max(options_.least_weight, eps * options_.weight_factor);
  }
  if (best_rho_ == kInfinity) {
    f_ = c_;
    Publish(result);
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

SemismoothNewtonOptions SemismoothNewtonOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("semismooth-newton", settings);
  SemismoothNewtonOptions options;
  options.first_weight = reader.Number("first_weight", options.first_weight, kLeastAllowedWeight, 1);
  options.weight_factor = reader.Number("weight_factor", options.weight_factor, kLeastAllowedWeight, 1);
  options.least_weight = reader.Number("least_weight", options.least_weight, kLeastAllowedWeight, 1);
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

void SemismoothNewtonSolver::DoPrepare(const LcpProblem& problem) { engine_->Prepare(problem); }

void SemismoothNewtonSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(options, result);
}

}  // namespace lcpbench
