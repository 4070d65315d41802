#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/verify.h"
#include "solvers/semismooth_newton_engine.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
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
constexpr int kTinyRowSweeps = 4;
// Rays: components below this part of the largest are rounding, and corrections into the null space.
constexpr double kRaySupport = 1e-7;
constexpr int kRayCorrections = 6;

}  // namespace

double SemismoothNewtonSolver::Engine::RhoInDouble() {
  block_->Multiply(f_.data(), residual_.data());
  residual_ += scaled_.b;
  return Residual(f_, residual_) / (scaled_.b_norm * scaled_.b_scale);
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
    if (is_joint(p) || scaled_.can_act[At(p)] == 0) continue;
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
  if (RhoInDouble() < Residual(c_, w_) / (scaled_.b_norm * scaled_.b_scale)) {
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
  // Forces that should be a tiny positive number: the failing rows are relaxed one by one, in their own units.
  f_trial_ = result->f;
  for (int k = 0; k < kTinyRowSweeps && !deadline_->Expired(); ++k) {
    test_.Rho(f_trial_);
    for (Index p = 0; p < n_; ++p) {
      const Index i = p;
      if (scaled_.can_act[At(p)] == 0 || test_.RowMeets(tolerance_, f_trial_, i)) continue;
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
  if (!(largest > 0) || !(growth_.dot(scaled_.b) < 0)) return End::kGoOn;
  std::fill(in_F_.begin(), in_F_.end(), 0);
  stack_.assign(1, top);
  in_F_[At(top)] = 1;
  while (!stack_.empty()) {
    const Index p = stack_.back();
    stack_.pop_back();
    for (SparseMatrix::InnerIterator it(problem_->SparseA(), p); it; ++it) {
      const Index q = it.col();
      if (in_F_[At(q)] != 0 || it.value() == 0 || scaled_.can_act[At(q)] == 0) continue;
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

}  // namespace lcpbench
