#include "solvers/active_set/semismooth_newton.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/answers/zero_row_ray.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/active_block_choice.h"
#include "solvers/linear_algebra/scaled_vectors.h"
#include "support/input_error.h"

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

// The shift of the finish, relative to the diagonal: the correction converges like (shift / eigenvalue)^k, and rounding
// of the factor, about 1e-15, must stay small beside it.
constexpr double kFinishShift = 1e-10;
constexpr double kStartShift = 1e-8;
constexpr int kFinishSteps = 6;
// Where b is consistent with dependent rows only up to rounding r, a correction moves f by r / shift in the null space,
// which can make forces negative. If c itself is nearly right, a heavier shift is tried then.
constexpr double kGentleShift = 1e-6;
// Forces and gaps of the wrong sign that are below this part of the largest force or of b do not make a row wrong.
constexpr double kWrongSign = 1e-9;
// On the way of continuation: where more than one row in so many is wrong, exchanging them all rarely ends.
constexpr Index kPartWrong = 30;
constexpr Index kFewWrong = 30;
constexpr double kNearlySolved = 1e-3;
// rho that is good enough to stop refining, whatever the tolerance: a direct method pays next to nothing for it.
constexpr double kGoodEnough = 1e-13;
// Refining goes on while rho falls by this factor.
constexpr double kFinishProgress = 0.5;
// Forces below these parts of the largest D^1/2 f are tried as zeros where a row fails in its own units only.
constexpr double kSnapLevels[] = {1e-15, 1e-13, 1e-10};
// Rays: components below this part of the largest are rounding, and corrections into the null space.
constexpr double kRaySupport = 1e-7;
constexpr int kRayCorrections = 6;

}  // namespace

// Vectors are by row of the problem, in the units of ScaledVectors.
class SemismoothNewtonEngine {
 public:
  explicit SemismoothNewtonEngine(const SemismoothNewtonOptions& options) : options_(options) {
    for (const double weight : {options.first_weight, options.weight_factor, options.least_weight}) {
      if (!(weight >= kLeastAllowedWeight && weight <= 1)) {
        throw InputError("semismooth-newton: weights must be in [1e-10, 1]");
      }
    }
  }

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNotSymmetric(problem); }
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return blocks_.StepTime(block_, n_); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  static size_t At(Index i) { return static_cast<size_t>(i); }
  enum class End { kGoOn, kStalled, kDone, kInfeasible, kTimeLimit, kIterationLimit };

  bool Start(const Eigen::VectorXd* initial_f);
  End Factor(double shift);
  Index FindActiveSet(double eps);
  End SolveSubproblem(double eps);
  bool IsDiverging(int steps) const;
  void RestartFromCenter();
  double StepLength() const;
  double Slope(double t, double* curvature) const;
  End Finish(LcpResult* result);
  End FinishWith(double shift, LcpResult* result);
  End FinishFromStart(LcpResult* result);
  End Correct(double rho, LcpResult* result);
  Index FindWrongRows();
  void GiveForces(Eigen::VectorXd* f) const;
  bool Publish(double rho_in_double, LcpResult* result);
  bool IsAnswer(LcpResult* result);
  bool RepairTinyRows(LcpResult* result);
  End TryRay(LcpResult* result);
  double RhoInDouble();

  bool is_joint(Index p) const { return scaled_.is_joint(p); }

  SemismoothNewtonOptions options_;
  std::optional<LcpProblem> problem_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  GivenFormTest test_;
  AnswerJudge judge_;
  LcpResult judged_;  // its f is what judge_ saw
  double tolerance_ = 0;
  std::int64_t factors_ = 0, factor_limit_ = 0;
  std::optional<Deadline> deadline_;

  Index n_ = 0;
  bool continuation_ = false;  // still
  bool exact_ = false;         // u solves the latest subproblem
  ScaledVectors scaled_;
  Eigen::VectorXd c_, u_, w_;      // proximal centre, dual point, A u + b
  Eigen::VectorXd step_, step_w_;  // u' - u and A (u' - u)
  Eigen::VectorXd inverse_;        // 1 / (eps D)
  Eigen::VectorXd growth_;         // c - previous c
  Eigen::VectorXd f_, residual_;   // of the finish
  Eigen::VectorXd f_trial_;        // in the problem's units
  std::vector<char> in_F_;
  std::vector<Index> stack_;               // of TryRay; of FinishFromStart the wrong rows
  double slope_at_0_ = 0, curvature_ = 0;  // of 1/2 u.A u along the step
  double best_rho_ = std::numeric_limits<double>::infinity();
  double center_rho_ = std::numeric_limits<double>::infinity();  // of c, before its correction
};

void SemismoothNewtonSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  n_ = problem.size();
  block_ = blocks_.Analyze(problem, {.dense = n_ <= kMaxDenseRows, .bodies = n_ >= options_.continuation_rows});
  if (options_.self_check) {
    test_.Reset(problem);
    judge_.Reset(problem, blocks_.is_dense(block_));
  }
  judged_.f.setZero(n_);
  scaled_.Reset(problem);
  for (Eigen::VectorXd* v : {&c_, &u_, &w_, &step_, &step_w_, &inverse_, &growth_, &f_, &residual_, &f_trial_}) {
    v->setZero(n_);
  }
  in_F_.assign(At(n_), 0);
  stack_.reserve(At(n_));
}

// True if there is a warm start that is worth trying; else c = 0.
bool SemismoothNewtonSolver::Engine::Start(const Eigen::VectorXd* initial_f) {
  c_.setZero();
  growth_.setZero();
  best_rho_ = kInfinity;
  bool warm = false;
  if (initial_f != nullptr) {
    const double cold_residual = scaled_.Residual(c_, scaled_.b);
    for (Index p = 0; p < n_; ++p) {
      const double given = scaled_.ScaledForce(p, (*initial_f)[p]);
      c_[p] = is_joint(p) ? given : std::max(given, 0.0);
      if (!scaled_.acts(p)) c_[p] = 0;
    }
    block_->Multiply(c_.data(), w_.data());
    w_ += scaled_.b;
    warm = scaled_.Residual(c_, w_) <= kUsefulStart * cold_residual;
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
    const bool is_in = scaled_.acts(p) && (is_joint(p) || c_[p] * eps * scaled_.diagonal[p] - w_[p] > 0);
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
    const bool counts = scaled_.acts(p) && (f > 0 || is_joint(p));
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
                  : continuation_            ? SemismoothNewtonSolver::kContinuationFactors
                                             : SemismoothNewtonSolver::kDefaultFactors;
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
      if (!scaled_.acts(p)) next = 0;
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
    const double rho = scaled_.Residual(c_, w_) / (scaled_.b_norm * scaled_.b_scale);
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
  if (end == End::kDone || ((end == End::kStalled || end == End::kGoOn) && IsAnswer(result))) {
    result->status = LcpStatus::kSolved;
  } else if (end == End::kInfeasible) {
    result->status = LcpStatus::kInfeasible;
  } else if (end == End::kTimeLimit || end == End::kIterationLimit) {
    result->status = end == End::kTimeLimit ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
  } else {
    char text[96];
    std::snprintf(text, sizeof text, "rho %.1e after %d proximal steps, and no proven ray", best_rho_,
                  kMaxProximalSteps);
    result->detail = text;
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

double SemismoothNewtonSolver::StepTime() const { return engine_->StepTime(); }

double SemismoothNewtonSolver::Engine::RhoInDouble() {
  block_->Multiply(f_.data(), residual_.data());
  residual_ += scaled_.b;
  return scaled_.Residual(f_, residual_) / (scaled_.b_norm * scaled_.b_scale);
}

void SemismoothNewtonSolver::Engine::GiveForces(Eigen::VectorXd* f) const {
  for (Index p = 0; p < n_; ++p) {
    const double given = scaled_.GivenForce(p, f_[p]);
    (*f)[p] = is_joint(p) ? given : std::max(given, 0.0);
  }
}

// Keeps f_ if it is the best so far. Without self-check by `rho`, which it has in double. True if it is good enough to
// stop. What is good enough in double, rounding included, is far below any tolerance; only what is not is looked at in
// extended precision.
bool SemismoothNewtonSolver::Engine::Publish(double rho_in_double, LcpResult* result) {
  if (deadline_->Expired()) return false;
  if (!options_.self_check) {
    if (!(rho_in_double < best_rho_)) return false;
    best_rho_ = rho_in_double;
    GiveForces(&result->f);
    return best_rho_ <= kGoodEnough;
  }
  GiveForces(&judge_.candidate());
  judge_.Start(tolerance_);
  const bool good_enough = judge_.Publish(&judged_);  // the first candidate is the best, if it is a number
  if (!(judge_.tier() < kInfinity)) return false;
  if (good_enough) {
    best_rho_ = judge_.tier();
    result->f.swap(judged_.f);
    return true;
  }
  if (deadline_->Expired()) return false;
  const auto rho = static_cast<double>(test_.Rho(judged_.f));
  if (!(rho < best_rho_)) return false;
  best_rho_ = rho;
  result->f.swap(judged_.f);
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
  center_rho_ = RhoInDouble();
  return Correct(center_rho_, result);
}

// With a factor of the active block, f_ of that rho and its residual_: refines and publishes.
SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::Correct(double rho, LcpResult* result) {
  for (int k = 0; k < kFinishSteps && rho > kGoodEnough; ++k) {
    block_->Solve(residual_.data());
    f_ -= residual_;
    const double before = rho;
    rho = RhoInDouble();
    if (k > 0 && !(rho <= kFinishProgress * before)) break;
    if (deadline_->Expired()) return End::kTimeLimit;
  }
  if (Publish(rho, result)) return End::kDone;
  if (!options_.self_check) return IsAnswer(result) ? End::kDone : End::kGoOn;
  // Once more with the residual of the given form in extended precision, if rounding is what is left.
  if (best_rho_ > std::sqrt(kGoodEnough)) return End::kGoOn;
  for (int k = 0; k < kFinishSteps; ++k) {
    const double before = best_rho_;
    for (Index p = 0; p < n_; ++p) {
      residual_[p] = static_cast<double>(test_.w(p)) * scaled_.b_scale * scaled_.scale[p];
    }
    if (deadline_->Expired()) return End::kTimeLimit;
    block_->Solve(residual_.data());
    f_ -= residual_;
    if (Publish(rho, result)) return End::kDone;
    if (!(best_rho_ <= kFinishProgress * before)) break;
  }
  return IsAnswer(result) || RepairTinyRows(result) ? End::kDone : End::kGoOn;
}

// Rows of F with f_ < 0 and rows outside with residual_ < 0, more than rounding might be, into stack_.
Eigen::Index SemismoothNewtonSolver::Engine::FindWrongRows() {
  double force = 0;
  double gap = 0;
  for (Index p = 0; p < n_; ++p) {
    force = std::max(force, scaled_.diagonal[p] * f_[p] * f_[p]);
    gap = std::max(gap, scaled_.b[p] * scaled_.b[p] / scaled_.diagonal[p]);
  }
  stack_.clear();
  for (Index p = 0; p < n_; ++p) {
    if (is_joint(p) || !scaled_.acts(p)) continue;
    const double d = scaled_.diagonal[p];
    const double x = in_F_[At(p)] != 0 ? f_[p] : residual_[p];
    const double size = in_F_[At(p)] != 0 ? d * x * x / force : x * x / (d * gap);
    if (x < 0 && size > kWrongSign * kWrongSign) stack_.push_back(p);
  }
  return static_cast<Index>(stack_.size());
}

// The rows that the start leaves active are mostly the right ones: f is corrected for them, and wrong rows change sides
// while their number falls. Where that does not end, proximal steps go on from the better one of the start and the
// latest f.
SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::FinishFromStart(LcpResult* result) {
  FindActiveSet(1);
  for (Index p = 0; p < n_; ++p) f_[p] = in_F_[At(p)] != 0 ? c_[p] : 0;
  for (Index least = continuation_ ? std::max(n_ / kPartWrong, kFewWrong) + 1 : n_ + 1;;) {
    const End end = Factor(kStartShift);
    if (end != End::kGoOn) return end;
    RhoInDouble();
    block_->Solve(residual_.data());
    f_ -= residual_;
    const double rho = RhoInDouble();
    const Index wrong = FindWrongRows();
    if (wrong == 0) {
      const End corrected = Correct(rho, result);
      if (corrected != End::kGoOn) return corrected;
      break;
    }
    if (wrong >= least) break;
    least = wrong;
    for (const Index p : stack_) {
      in_F_[At(p)] = in_F_[At(p)] == 0 ? 1 : 0;
      if (in_F_[At(p)] == 0) f_[p] = 0;
    }
  }
  for (Index p = 0; p < n_; ++p) {
    if (!is_joint(p)) f_[p] = std::max(f_[p], 0.0);
  }
  if (RhoInDouble() < scaled_.Residual(c_, w_) / (scaled_.b_norm * scaled_.b_scale)) {
    c_ = f_;
    u_ = f_;
    w_ = residual_;
  }
  return End::kGoOn;
}

bool SemismoothNewtonSolver::Engine::IsAnswer(LcpResult* result) {
  return best_rho_ <= tolerance_ && (!options_.self_check || test_.Meets(tolerance_, result->f));
}

// For an f that meets rho but not the componentwise measure, which then fails in rows where all terms are tiny.
bool SemismoothNewtonSolver::Engine::RepairTinyRows(LcpResult* result) {
  if (!(best_rho_ <= tolerance_)) return false;
  // Forces that should be zero are often only zero to rounding.
  double largest = 0;
  for (Index p = 0; p < n_; ++p) largest = std::max(largest, scaled_.diagonal[p] * f_[p] * f_[p]);
  for (const double level : kSnapLevels) {
    if (deadline_->Expired()) return false;
    for (Index p = 0; p < n_; ++p) {
      const bool tiny = scaled_.diagonal[p] * f_[p] * f_[p] <= level * level * largest;
      f_trial_[p] = tiny ? 0.0 : result->f[p];
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
  if (!(largest > 0) || !(growth_.dot(scaled_.b) < 0)) return End::kGoOn;
  std::fill(in_F_.begin(), in_F_.end(), 0);
  stack_.assign(1, top);
  in_F_[At(top)] = 1;
  while (!stack_.empty()) {
    const Index p = stack_.back();
    stack_.pop_back();
    for (SparseMatrix::InnerIterator it(problem_->SparseA(), p); it; ++it) {
      const Index q = it.col();
      if (in_F_[At(q)] != 0 || it.value() == 0 || !scaled_.acts(q)) continue;
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
    ray[p] = y * scaled_.scale[p];
  }
  if (!ray.allFinite() || !VerifyFarkasRay(*problem_, ray).accepted) return End::kGoOn;
  result->farkas_ray = std::move(ray);
  return End::kInfeasible;
}

template class EngineSolver<SemismoothNewtonOptions, SemismoothNewtonEngine>;

}  // namespace lcpbench
