#include "solvers/active_set/semismooth_newton.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/active_set/block_pivoting.h"
#include "support/array_index.h"
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
// A warm start is tried if its rho is at most this part of the one at f = 0.
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
// Weight of the factor of the finish: refinement converges like (weight / eigenvalue)^k, and rounding of the factor,
// about 1e-15, must stay small beside it. From a start, where rows change sides, a heavier one.
constexpr double kFinishWeight = 1e-10;
constexpr double kStartWeight = 1e-8;
// Where b is consistent with dependent rows only up to rounding r, a correction moves f by r / weight in the null
// space, which can make forces negative. If c itself is nearly right, a heavier weight is tried then.
constexpr double kGentleWeight = 1e-6;
constexpr double kNearlySolved = 1e-3;
// Tier from which an answer within the tolerance is taken.
constexpr double kNearlyExact = 3e-7;
// On the way of continuation: where more than one row in so many is wrong, exchanging them all rarely ends.
constexpr Index kPartWrong = 30;
// Rows of arrays that take more factors mostly need residuals in extended precision, which an LcpProblem has.
constexpr std::int64_t kFactorsOfRows = 40;
constexpr Index kFewWrong = 30;

}  // namespace

// Vectors are by row of the problem, in the units of ScaledVectors.
class SemismoothNewtonEngine final : public RowEngine {
 public:
  explicit SemismoothNewtonEngine(const SemismoothNewtonOptions& options)
      : RowEngine(std::min(EnginesBySize<SemismoothNewtonEngine>::kMostRows, options.continuation_rows - 1)),
        options_(options) {
    for (const double weight : {options.first_weight, options.weight_factor, options.least_weight}) {
      if (!(weight >= kLeastAllowedWeight && weight <= 1)) {
        throw InputError("semismooth-newton: weights must be in [1e-10, 1]");
      }
    }
  }

  static constexpr bool kSolvesByFaces = true;
  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNotSymmetric(problem); }
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return setup_.StepTime(); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  void PrepareRows(Index size);
  bool SolveFilledUp(const RowTask& task, LcpResult* result);

 private:
  using End = BlockPivoting::End;  // kNotMet: go on

  bool SolveRows(const RowTask& task, LcpResult* result) override {
    return of_rows_.Find(task.rows.rows, options_).SolveFilledUp(task, result);
  }

  void Reserve(Index rows);
  bool Start(const Eigen::VectorXd* initial_f);
  End TakeNewtonSteps(bool warm);
  Index FindActiveSet(double eps);
  End SolveSubproblem(double eps);
  bool IsDiverging(int steps) const;
  void RestartFromCenter();
  void PublishCenter();
  double StepLength() const;
  double Slope(double t, double* curvature) const;
  double RhoOf(const Eigen::VectorXd& f);
  End Finish(double weight, Index most);
  End FinishFromCenter();
  bool Expired() const { return deadline_ != nullptr && deadline_->Expired(); }
  double tier() const { return setup_.sink->tier(); }

  SemismoothNewtonOptions options_;
  PivotingSetup setup_;
  BlockPivoting& pivoting_ = setup_.pivoting;  // of which the finish and the rays are used
  const ScaledVectors& scaled_ = setup_.scaled;
  double tolerance_ = 0;
  const Deadline* deadline_ = nullptr;  // nullptr for none

  Index n_ = 0;
  bool continuation_ = false;      // still
  bool exact_ = false;             // u solves the latest subproblem
  Eigen::VectorXd c_, u_, w_;      // proximal centre, dual point, A u + b
  Eigen::VectorXd step_, step_w_;  // u' - u and A (u' - u)
  Eigen::VectorXd inverse_;        // 1 / (eps D)
  Eigen::VectorXd growth_;         // c - previous c
  std::vector<char> in_F_;
  double slope_at_0_ = 0, curvature_ = 0;  // of 1/2 u.A u along the step
  EnginesBySize<SemismoothNewtonEngine> of_rows_;
};

void SemismoothNewtonEngine::Reserve(Index rows) {
  n_ = rows;
  for (Eigen::VectorXd* v : {&c_, &u_, &w_, &step_, &step_w_, &inverse_, &growth_}) v->setZero(n_);
  in_F_.assign(At(n_), 0);
}

void SemismoothNewtonEngine::Prepare(const LcpProblem& problem) {
  Reserve(problem.size());
  setup_.Prepare(problem, {.dense = n_ <= kMaxDenseRows});
}

// True if there is a warm start that is worth trying; else c = 0.
bool SemismoothNewtonEngine::Start(const Eigen::VectorXd* initial_f) {
  c_.setZero();
  growth_.setZero();
  bool warm = false;
  if (initial_f != nullptr) {
    const double cold = scaled_.Rho(c_, scaled_.b);
    scaled_.Clip(*initial_f, &c_);
    RestartFromCenter();
    warm = scaled_.Rho(c_, w_) <= kUsefulStart * cold;
    if (!warm) c_.setZero();
  }
  if (!warm) w_ = scaled_.b;
  u_ = c_;
  return warm;
}

// F of the current u. Returns how many rows changed sides.
Index SemismoothNewtonEngine::FindActiveSet(double eps) {
  Index changed = 0;
  for (Index p = 0; p < n_; ++p) {
    const bool is_in = scaled_.acts(p) && (scaled_.is_joint(p) || c_[p] * eps * scaled_.diagonal[p] - w_[p] > 0);
    changed += is_in != (in_F_[At(p)] != 0) ? 1 : 0;
    in_F_[At(p)] = is_in ? 1 : 0;
  }
  return changed;
}

// Phi'(t) along the step.
double SemismoothNewtonEngine::Slope(double t, double* curvature) const {
  double slope = slope_at_0_ + t * curvature_;
  double second = curvature_;
  for (Index p = 0; p < n_; ++p) {
    const double f = c_[p] - (w_[p] + t * step_w_[p]) * inverse_[p];
    const bool counts = scaled_.acts(p) && (f > 0 || scaled_.is_joint(p));
    slope -= counts ? f * step_w_[p] : 0;
    second += counts ? step_w_[p] * step_w_[p] * inverse_[p] : 0;
  }
  *curvature = second;
  return slope;
}

// The minimum of Phi along the step in (0, 1]: Newton's method on its increasing piecewise linear slope, kept in a
// bracket.
double SemismoothNewtonEngine::StepLength() const {
  double curvature = 0;
  double slope = Slope(1, &curvature);
  if (slope <= 0) return 1;
  double ignored = 0;
  const double flat = kFlatSlope * std::abs(Slope(0, &ignored));
  double low = 0;
  double high = 1;
  double t = 1;
  for (int k = 0; k < kMaxLineSteps && std::abs(slope) > flat && !Expired(); ++k) {
    (slope > 0 ? high : low) = t;
    const double next = t - slope / curvature;
    t = next > low && next < high ? next : 0.5 * (low + high);
    slope = Slope(t, &curvature);
  }
  return t;
}

BlockPivoting::End SemismoothNewtonEngine::SolveSubproblem(double eps) {
  for (Index p = 0; p < n_; ++p) inverse_[p] = 1 / (eps * scaled_.diagonal[p]);
  FindActiveSet(eps);
  const std::int64_t most = pivoting_.factors() + (continuation_ ? kMostContinuationSteps : kMostNewtonSteps);
  for (bool full_step = false;;) {
    if (pivoting_.factors() >= most && eps < kHeaviestWeight) return End::kCycling;
    if (const End end = pivoting_.Factor(in_F_, eps); end != End::kDone) return end;
    for (Index p = 0; p < n_; ++p) step_[p] = eps * scaled_.diagonal[p] * c_[p] - scaled_.b[p];
    setup_.block->Solve(step_.data());
    if (Expired()) return End::kStopped;
    step_ -= u_;
    setup_.block->Multiply(step_.data(), step_w_.data());
    slope_at_0_ = u_.dot(step_w_);
    curvature_ = step_.dot(step_w_);
    const double t = StepLength();
    full_step = t == 1;
    u_ += t * step_;
    w_ += t * step_w_;
    exact_ = FindActiveSet(eps) == 0 && full_step;
    if (exact_) return End::kNotMet;
    if (t * step_.cwiseAbs().maxCoeff() <= std::numeric_limits<double>::epsilon() * u_.cwiseAbs().maxCoeff()) {
      exact_ = true;
      return End::kNotMet;  // F flips over by rounding only
    }
    if (Expired()) return End::kStopped;
  }
}

bool SemismoothNewtonEngine::IsDiverging(int steps) const {
  const double moved = (scaled_.diagonal.array() * growth_.array().square()).maxCoeff();
  const double size = (scaled_.diagonal.array() * c_.array().square()).maxCoeff();
  return std::sqrt(moved) * (steps + 1) >= kDivergence * std::sqrt(size);
}

void SemismoothNewtonEngine::RestartFromCenter() {
  u_ = c_;
  setup_.block->Multiply(u_.data(), w_.data());
  w_ += scaled_.b;
}

// In step_w_ remains A f + b.
double SemismoothNewtonEngine::RhoOf(const Eigen::VectorXd& f) {
  setup_.block->Multiply(f.data(), step_w_.data());
  step_w_ += scaled_.b;
  return scaled_.Rho(f, step_w_);
}

// f_F near c_F with w_F = 0.
BlockPivoting::End SemismoothNewtonEngine::Finish(double weight, Index most) {
  const End end = pivoting_.Finish(in_F_, c_, weight, most);
  // A looser answer is no reason to end: the problem may have none, and the next finish may be exact.
  return end == End::kNotMet && tier() <= std::min(tolerance_, kNearlyExact) ? End::kDone : end;
}

// The rows that a good c leaves active are mostly the right ones. Where the finish from them does not end, proximal
// steps go on from the better one of c and the latest f.
BlockPivoting::End SemismoothNewtonEngine::FinishFromCenter() {
  FindActiveSet(1);
  if (const End end = Finish(kStartWeight, continuation_ ? std::max(n_ / kPartWrong, kFewWrong) + 1 : n_ + 1);
      end != End::kNotMet) {
    return end;
  }
  for (Index p = 0; p < n_; ++p) step_[p] = scaled_.is_joint(p) ? pivoting_.f()[p] : std::max(pivoting_.f()[p], 0.0);
  const double rho = RhoOf(step_);
  if (rho < scaled_.Rho(c_, w_)) {
    c_ = u_ = step_;
    w_ = step_w_;
  }
  return End::kNotMet;
}

void SemismoothNewtonEngine::PublishCenter() {
  for (Index p = 0; p < n_; ++p) setup_.sink->candidate()[p] = scaled_.GivenForce(p, c_[p]);
  setup_.sink->Publish();
}

BlockPivoting::End SemismoothNewtonEngine::TakeNewtonSteps(bool warm) {
  End end = warm ? FinishFromCenter() : End::kNotMet;
  double eps = continuation_ ? kContinuationStart : options_.first_weight;
  double least_weight = continuation_ ? kContinuationEnd : options_.least_weight;
  double rho_before = kInfinity;
  double finished_rho = kWorthFinish / kWorthAnother;
  for (int k = 0; k < kMaxProximalSteps && end == End::kNotMet; ++k) {
    if (continuation_ && k == kMaxContinuationSteps) {
      continuation_ = false;
      eps = options_.first_weight;
      least_weight = options_.least_weight;
    }
    const std::int64_t before = pivoting_.factors();
    end = SolveSubproblem(eps);
    if (end == End::kCycling) {
      eps = least_weight = std::min(kHeaviestWeight, eps * (continuation_ ? 1 / kContinuationFactor : kRaise));
      RestartFromCenter();
      end = End::kNotMet;
      continue;
    }
    if (end != End::kNotMet) break;
    for (Index p = 0; p < n_; ++p) {
      // The two are the same where u solves the subproblem, but w / eps magnifies the rounding of w.
      double next = exact_ && continuation_ ? u_[p] : c_[p] - w_[p] * inverse_[p];
      if (!scaled_.is_joint(p)) next = std::max(next, 0.0);
      if (!scaled_.acts(p)) next = 0;
      growth_[p] = next - c_[p];
      c_[p] = next;
    }
    const auto shows_a_ray = [&] {
      return k >= kFirstRayStep && tier() > std::min(tolerance_, BlockPivoting::kProofTolerance) &&
             (!continuation_ || IsDiverging(k)) && growth_.dot(scaled_.b) < 0 && pivoting_.FindRay(growth_);
    };
    if (!continuation_) {
      end = Finish(kFinishWeight, 0);
      if (end == End::kNotMet && RhoOf(c_) <= kNearlySolved) end = Finish(kGentleWeight, 0);
      if (end == End::kNotMet && shows_a_ray()) return End::kInfeasible;
      eps = std::max(least_weight, eps * options_.weight_factor);
      continue;
    }
    const std::int64_t steps = pivoting_.factors() - before;
    RestartFromCenter();
    const double rho = scaled_.Rho(c_, w_);
    if (rho < tier()) PublishCenter();
    if (rho <= tolerance_ || rho <= kWorthAnother * finished_rho) {
      finished_rho = rho;
      end = FinishFromCenter();
    }
    if (end == End::kNotMet && shows_a_ray()) return End::kInfeasible;
    const bool is_slow = steps <= kModerateSteps && rho > kSlow * rho_before;
    if (rho >= rho_before && eps <= kNoisyWeight) {
      eps = least_weight = eps / kContinuationFactor;
    } else if (steps <= kFewSteps || is_slow) {
      eps = std::max(least_weight, eps * kContinuationFactor);
    }
    rho_before = rho;
  }
  return end;
}

void SemismoothNewtonEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  tolerance_ = options.tolerance;
  std::optional<Deadline> deadline;
  if (Deadline::IsNeeded(options)) deadline.emplace(options);
  deadline_ = deadline.has_value() ? &*deadline : nullptr;
  continuation_ = n_ >= options_.continuation_rows;
  const std::int64_t factors =
      continuation_ ? SemismoothNewtonSolver::kContinuationFactors : SemismoothNewtonSolver::kDefaultFactors;
  if (!setup_.Load(problem, options, deadline_, factors, /*conjugate=*/false, result)) return;
  const End end = TakeNewtonSteps(Start(options.initial_f));
  if (tier() == kInfinity) PublishCenter();
  setup_.Conclude(end, tolerance_, result);
}

void SemismoothNewtonEngine::PrepareRows(Index size) {
  Reserve(size);
  setup_.PrepareRows(size);
}

bool SemismoothNewtonEngine::SolveFilledUp(const RowTask& task, LcpResult* result) {
  tolerance_ = task.options.tolerance;
  deadline_ = task.deadline;
  if (!setup_.LoadRows(task, kFactorsOfRows, /*conjugate=*/false)) return false;
  TakeNewtonSteps(Start(task.options.initial_f));
  return setup_.ConcludeRows(task, result);
}

void SemismoothNewtonOptions::Read(SettingsReader* reader) {
  first_weight = reader->Number("first_weight", first_weight, kLeastAllowedWeight, 1);
  weight_factor = reader->Number("weight_factor", weight_factor, kLeastAllowedWeight, 1);
  least_weight = reader->Number("least_weight", least_weight, kLeastAllowedWeight, 1);
  continuation_rows =
      static_cast<Index>(reader->Number("continuation_rows", static_cast<double>(continuation_rows), 1, 1e9));
}

double SemismoothNewtonSolver::StepTime() const { return engine_->StepTime(); }

template class EngineSolver<SemismoothNewtonOptions, SemismoothNewtonEngine>;

}  // namespace lcpbench
