#include "solvers/semismooth_newton.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/given_form.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "solvers/ordered_lcp.h"
#include "solvers/sparse_ldlt.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastAllowedWeight = 1e-10;
// The shift of the finish, relative to the diagonal: the correction converges like (shift / eigenvalue)^k, and rounding
// of the factor, about 1e-15, must stay small beside it.
constexpr double kFinishShift = 1e-10;
constexpr int kFinishSteps = 6;
// rho that is good enough to stop refining, whatever the tolerance: a direct method pays next to nothing for it.
constexpr double kGoodEnough = 1e-13;
// Refining goes on while rho falls by this factor.
constexpr double kFinishProgress = 0.5;
constexpr int kMaxProximalSteps = 100;
// Where the slope along the step has fallen to this part of the one at its start, the minimum is close enough. A full
// step is worth more than a slope of that size: it may end the subproblem.
constexpr double kFlatSlope = 1e-3;
constexpr int kMaxLineSteps = 50;
// A pivot of A_FF + eps D below minus this part of its diagonal is no rounding: A is not PSD.
constexpr double kNegativePivot = 1e-8;
// Forces below these parts of the largest D^1/2 f are tried as zeros where a row fails in its own units only.
constexpr double kSnapLevels[] = {1e-15, 1e-13, 1e-10};
constexpr int kTinyRowSweeps = 4;
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
  enum class End { kGoOn, kDone, kInfeasible, kTimeLimit, kIterationLimit, kNotPsd };

  bool FindZeroRowRay(LcpResult* result) const;
  void Start(const Eigen::VectorXd* initial_f);
  End Factor(double shift);
  Index FindActiveSet(double eps);
  End SolveSubproblem(double eps);
  double StepLength() const;
  double Slope(double t, double* curvature) const;
  End Finish(LcpResult* result);
  bool Publish(LcpResult* result);
  bool IsAnswer(LcpResult* result);
  bool RepairTinyRows(LcpResult* result);
  End TryRay(LcpResult* result);
  double RhoInDouble();

  bool is_joint(Index p) const { return lcp_.bilateral[At(p)] != 0; }

  SemismoothNewtonOptions options_;
  std::optional<LcpProblem> problem_;
  OrderedLcp lcp_;
  SparseLdlt factor_;
  bool fits_ = false;
  GivenFormTest test_;
  double tolerance_ = 0;
  std::int64_t factors_ = 0, factor_limit_ = 0;
  std::optional<Deadline> deadline_;

  Eigen::VectorXd c_, u_, w_;      // by position: proximal centre, dual point, A u + b
  Eigen::VectorXd step_, step_w_;  // u' - u and A (u' - u)
  Eigen::VectorXd inverse_;        // 1 / (eps D)
  Eigen::VectorXd growth_;         // c - previous c
  Eigen::VectorXd f_, residual_;   // of the finish
  Eigen::VectorXd f_trial_;        // by row, in the problem's units
  std::vector<char> in_F_;
  std::vector<Index> stack_;
  double slope_at_0_ = 0, curvature_ = 0;  // of 1/2 u.A u along the step
  double b_norm_ = 1;
  double best_rho_ = kInfinity;
};

void SemismoothNewtonSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  lcp_.Analyse(problem);
  fits_ = factor_.Analyse(lcp_);
  if (!fits_) return;
  test_.Reset(problem);
  const Index n = problem.size();
  for (Eigen::VectorXd* v : {&c_, &u_, &w_, &step_, &step_w_, &inverse_, &growth_, &f_, &residual_, &f_trial_}) {
    v->setZero(n);
  }
  in_F_.assign(At(n), 0);
  stack_.reserve(At(n));
}

// A_ii = 0 makes row i of a PSD A zero: w_i = b_i whatever f is, and +-e_i is a ray if that is wrong.
bool SemismoothNewtonSolver::Engine::FindZeroRowRay(LcpResult* result) const {
  const double proof_tolerance = std::min(tolerance_, 1e-9);
  for (Index p = 0; p < lcp_.n; ++p) {
    if (lcp_.dead[At(p)] == 0) continue;
    const Index i = lcp_.row[At(p)];
    const double b = problem_->b()[i];
    if ((b >= 0 && !is_joint(p)) || std::abs(lcp_.b[p]) <= proof_tolerance * b_norm_) continue;
    Eigen::VectorXd ray = Eigen::VectorXd::Zero(lcp_.n);
    ray[i] = b < 0 ? 1 : -1;
    if (!VerifyFarkasRay(*problem_, ray).accepted) continue;
    result->farkas_ray = std::move(ray);
    return true;
  }
  return false;
}

void SemismoothNewtonSolver::Engine::Start(const Eigen::VectorXd* initial_f) {
  c_.setZero();
  growth_.setZero();
  w_ = lcp_.b;
  if (initial_f != nullptr) {
    for (Index p = 0; p < lcp_.n; ++p) {
      const double given = lcp_.ScaledForce(p, (*initial_f)[lcp_.row[At(p)]]);
      c_[p] = is_joint(p) ? given : std::max(given, 0.0);
      if (lcp_.dead[At(p)] != 0) c_[p] = 0;
    }
    lcp_.Product(c_.data(), w_.data());
    w_ += lcp_.b;
  }
  u_ = c_;
  double sum = 0;
  for (Index p = 0; p < lcp_.n; ++p) sum += lcp_.b[p] * lcp_.b[p] / lcp_.diagonal[p];
  b_norm_ = sum == 0 ? 1.0 : std::sqrt(sum);
  best_rho_ = kInfinity;
}

SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::Factor(double shift) {
  if (factors_ >= factor_limit_) return End::kIterationLimit;
  ++factors_;
  if (!factor_.Factor(lcp_, shift, in_F_.data(), *deadline_)) return End::kTimeLimit;
  return factor_.least_pivot() < -kNegativePivot ? End::kNotPsd : End::kGoOn;
}

// F of the current u. Returns how many rows changed sides.
Eigen::Index SemismoothNewtonSolver::Engine::FindActiveSet(double eps) {
  Index changed = 0;
  for (Index p = 0; p < lcp_.n; ++p) {
    const bool is_in = lcp_.dead[At(p)] == 0 && (is_joint(p) || c_[p] * eps * lcp_.diagonal[p] - w_[p] > 0);
    changed += is_in != (in_F_[At(p)] != 0) ? 1 : 0;
    in_F_[At(p)] = is_in ? 1 : 0;
  }
  return changed;
}

// Phi'(t) along the step.
double SemismoothNewtonSolver::Engine::Slope(double t, double* curvature) const {
  double slope = slope_at_0_ + t * curvature_;
  double second = curvature_;
  for (Index p = 0; p < lcp_.n; ++p) {
    const double f = c_[p] - (w_[p] + t * step_w_[p]) * inverse_[p];
    const bool counts = lcp_.dead[At(p)] == 0 && (f > 0 || is_joint(p));
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
  for (Index p = 0; p < lcp_.n; ++p) inverse_[p] = 1 / (eps * lcp_.diagonal[p]);
  FindActiveSet(eps);
  for (bool full_step = false;;) {
    const End end = Factor(eps);
    if (end != End::kGoOn) return end;
    for (Index p = 0; p < lcp_.n; ++p) step_[p] = eps * lcp_.diagonal[p] * c_[p] - lcp_.b[p];
    factor_.Solve(step_.data());
    step_ -= u_;
    lcp_.Product(step_.data(), step_w_.data());
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
  lcp_.Product(f_.data(), residual_.data());
  residual_ += lcp_.b;
  double sum = 0;
  for (Index p = 0; p < lcp_.n; ++p) {
    const double d = lcp_.diagonal[p];
    const double r = is_joint(p) || lcp_.dead[At(p)] != 0 ? (is_joint(p) ? residual_[p] : std::min(residual_[p], 0.0))
                                                          : std::min(d * f_[p], residual_[p]);
    sum += r * r / d;
  }
  return std::sqrt(sum) / b_norm_;
}

// Keeps f_ if it is the best so far. True if it is good enough to stop.
bool SemismoothNewtonSolver::Engine::Publish(LcpResult* result) {
  for (Index p = 0; p < lcp_.n; ++p) {
    const double f = lcp_.GivenForce(p, f_[p]);
    f_trial_[lcp_.row[At(p)]] = is_joint(p) ? f : std::max(f, 0.0);
  }
  const auto rho = static_cast<double>(test_.Rho(f_trial_));
  if (!(rho < best_rho_)) return false;
  best_rho_ = rho;
  result->f.swap(f_trial_);
  return rho <= kGoodEnough && test_.Meets(tolerance_, result->f);
}

// f_F near c_F with w_F = 0.
SemismoothNewtonSolver::Engine::End SemismoothNewtonSolver::Engine::Finish(LcpResult* result) {
  const End end = Factor(kFinishShift);
  if (end != End::kGoOn) return end;
  for (Index p = 0; p < lcp_.n; ++p) f_[p] = in_F_[At(p)] != 0 ? c_[p] : 0;
  double rho = RhoInDouble();
  for (int k = 0; k < kFinishSteps && rho > kGoodEnough; ++k) {
    factor_.Solve(residual_.data());
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
    for (Index p = 0; p < lcp_.n; ++p) {
      residual_[p] = static_cast<double>(test_.w(lcp_.row[At(p)])) * lcp_.b_scale * lcp_.scale[p];
    }
    factor_.Solve(residual_.data());
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
  for (Index p = 0; p < lcp_.n; ++p) largest = std::max(largest, lcp_.diagonal[p] * f_[p] * f_[p]);
  for (const double level : kSnapLevels) {
    for (Index p = 0; p < lcp_.n; ++p) {
      const bool tiny = lcp_.diagonal[p] * f_[p] * f_[p] <= level * level * largest;
      f_trial_[lcp_.row[At(p)]] = tiny ? 0.0 : result->f[lcp_.row[At(p)]];
    }
    if (!test_.Meets(tolerance_, f_trial_)) continue;
    result->f.swap(f_trial_);
    return true;
  }
  // Forces that should be a tiny positive number: the failing rows are relaxed one by one, in their own units.
  f_trial_ = result->f;
  for (int k = 0; k < kTinyRowSweeps; ++k) {
    test_.Rho(f_trial_);
    for (Index p = 0; p < lcp_.n; ++p) {
      const Index i = lcp_.row[At(p)];
      if (lcp_.dead[At(p)] != 0 || test_.RowMeets(tolerance_, f_trial_, i)) continue;
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
  if (!(largest > 0) || !(growth_.dot(lcp_.b) < 0)) return End::kGoOn;
  std::fill(in_F_.begin(), in_F_.end(), 0);
  stack_.assign(1, top);
  in_F_[At(top)] = 1;
  while (!stack_.empty()) {
    const Index p = stack_.back();
    stack_.pop_back();
    for (int k = lcp_.begin[At(p)]; k < lcp_.begin[At(p + 1)]; ++k) {
      const Index q = lcp_.column[At(k)];
      if (in_F_[At(q)] != 0 || lcp_.value[At(k)] == 0 || lcp_.dead[At(q)] != 0) continue;
      if (!(is_joint(q) ? std::abs(growth_[q]) > 0 : growth_[q] > kRaySupport * largest)) continue;
      in_F_[At(q)] = 1;
      stack_.push_back(q);
    }
  }
  for (Index p = 0; p < lcp_.n; ++p) f_[p] = in_F_[At(p)] != 0 ? growth_[p] / largest : 0;
  const End end = Factor(kFinishShift);
  if (end != End::kGoOn) return end;
  for (int k = 0; k < kRayCorrections; ++k) {
    lcp_.Product(f_.data(), residual_.data());
    factor_.Solve(residual_.data());
    f_ -= residual_;
  }
  Eigen::VectorXd ray = Eigen::VectorXd::Zero(lcp_.n);
  for (Index p = 0; p < lcp_.n; ++p) {
    const double y = is_joint(p) ? f_[p] : std::max(f_[p], 0.0);
    ray[lcp_.row[At(p)]] = y * lcp_.scale[p];
  }
  if (!ray.allFinite() || !VerifyFarkasRay(*problem_, ray).accepted) return End::kGoOn;
  result->farkas_ray = std::move(ray);
  return End::kInfeasible;
}

void SemismoothNewtonSolver::Engine::Solve(const LcpOptions& options, LcpResult* result) {
  if (!fits_) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "the factor of A has more than 2^31 entries";
    return;
  }
  tolerance_ = options.tolerance;
  deadline_.emplace(options);
  factors_ = 0;
  factor_limit_ = options.max_iterations > 0 ? options.max_iterations : kDefaultFactors;
  factor_.Forget();
  if (!lcp_.Load(*problem_)) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return;
  }
  Start(options.initial_f);
  if (FindZeroRowRay(result)) {
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
    for (Index p = 0; p < lcp_.n; ++p) {
      double next = c_[p] - w_[p] * inverse_[p];
      if (!is_joint(p)) next = std::max(next, 0.0);
      if (lcp_.dead[At(p)] != 0) next = 0;
      growth_[p] = next - c_[p];
      c_[p] = next;
    }
    end = Finish(result);
    if (end == End::kGoOn && k >= kFirstRayStep && best_rho_ > std::min(tolerance_, 1e-9)) end = TryRay(result);
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
    case End::kNotPsd:
      result->detail = "A is not positive semidefinite";
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
