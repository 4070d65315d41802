#include "solvers/active_set/block_pivoting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "solvers/answers/answer_judge.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A gap is rounding only up to this multiple of |D^1/2 f|_1 + |D^-1/2 b|_inf, in D^1/2.
constexpr double kNoise = 64 * kEpsilon;
// A force of the proximal problem is rounding only up to this multiple of epsilon / e times the largest: that much a
// dependent row amplifies.
constexpr double kForceNoise = 8;
// Corrections end when the residual is rounding, or after so many steps, ...
constexpr int kMaxCorrections = 12;
// ... or when the residual falls by less than this.
constexpr double kSlowCorrection = 0.5;
// Curvature y.A y below this multiple of y.D y: the direction is in the null space.
constexpr double kNullCurvature = 1e-14;
constexpr int kMaxPolishes = 8;
// rho from which refinement in extended precision is tried, and how often.
constexpr double kWorthRefining = 1e-7;
constexpr int kMaxRefinements = 5;
// An estimate of rho above this times what refinement is tried from is no matter of rounding.
constexpr double kNear = 10;
// Where blocks cycle, e rises to this at least, then tenfold: on all redundant families blocks settle there.
constexpr double kCyclingWeight = 1e-2;
constexpr double kRaise = 10;
// An answer within the tolerance is taken when a proximal step improves it by less than this factor.
constexpr double kWorthAnotherStep = 0.1;
// Forces up to such a part of the largest D^1/2 f may be rounding, the more so the worse A_FF is conditioned.
constexpr double kTinyForces[] = {1e-14, 1e-12, 1e-10};
// A proximal step at least this part of f / steps so far does not look like convergence.
constexpr double kDivergence = 0.25;
// Entries of a ray below this part of its largest one are rounding of other components.
constexpr double kRaySupport = 1e-7;
constexpr int kRayCorrections = 6;
// Rays are looked at in this size, so that b does not round A y away in w = A y + b.
constexpr double kLift = 0x1p200;
constexpr double kRayWeight = 1e-10;

}  // namespace

void BlockPivoting::Reserve(Index n) {
  for (Eigen::VectorXd* v :
       {&root_, &f_, &w_, &center_, &proximal_, &residual_, &direction_, &image_, &preconditioned_, &ray_}) {
    v->setZero(n);
  }
  for (std::vector<char>* v : {&active_, &active_proximal_}) v->assign(At(n), 0);
  violated_.reserve(At(n));
}

void BlockPivoting::Reserve(const LcpProblem& problem) {
  Reserve(problem.size());
  product_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
  product_.Rho(f_);  // makes its workspace
}

void BlockPivoting::SetTask(const Task& task) {
  task_ = task;
  if (task.problem != nullptr) product_.SetB(*task.problem);
  factors_ = 0;
  single_exchanges_ = 0;
  accepted_ray_.reset();
  f_.setZero();
  const ScaledVectors& scaled = *task.scaled;
  const auto acts = std::find(scaled.can_act.begin(), scaled.can_act.end(), 1);
  unit_ = acts == scaled.can_act.end() ? 1.0 : scaled.diagonal[acts - scaled.can_act.begin()];
  root_ = (scaled.diagonal / unit_).cwiseSqrt();
}

void BlockPivoting::StartCold() {
  center_.setZero();
  f_.setZero();
  active_ = task_.scaled->can_act;
}

void BlockPivoting::StartFrom(const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  const ScaledVectors& scaled = *task_.scaled;
  center_ = f_ = f;
  for (Index i = 0; i < f.size(); ++i) {
    active_[At(i)] = scaled.acts(i) && (scaled.is_joint(i) || scaled.diagonal[i] * f[i] > w[i]) ? 1 : 0;
  }
}

BlockPivoting::End BlockPivoting::Factor(const std::vector<char>& active, double weight) {
  if (factors_ >= task_.factors) return End::kIterationLimit;
  if (TimeIsUp()) return End::kStopped;
  ++factors_;
  return task_.block->Factor(active, weight, task_.deadline) ? End::kDone : End::kStopped;
}

// f_ and w_ of the proximal problem for active_.
BlockPivoting::End BlockPivoting::SolveActive() {
  const ScaledVectors& scaled = *task_.scaled;
  if (const End end = Factor(active_, weight_); end != End::kDone) return end;
  f_.array() = weight_ * scaled.diagonal.array() * center_.array() - scaled.b.array();
  task_.block->Solve(f_.data());
  task_.block->Multiply(f_.data(), w_.data());
  w_.array() += scaled.b.array() + weight_ * scaled.diagonal.array() * (f_ - center_).array();
  return TimeIsUp() ? End::kStopped : End::kDone;
}

// Fills violated_, ascending. Signs are judged relative to the rounding of forces and gaps.
Index BlockPivoting::FindViolated(bool of_proximal) {
  const ScaledVectors& scaled = *task_.scaled;
  const double size = f_.cwiseAbs().dot(root_);
  const double force_noise = of_proximal ? kForceNoise * kEpsilon / weight_ * LargestForce() : 0.0;
  violated_.clear();
  for (Index i = 0; i < f_.size(); ++i) {
    if (scaled.is_joint(i) || !scaled.acts(i)) continue;
    const bool violated = active_[At(i)] != 0 ? f_[i] * root_[i] < -force_noise
                                              : w_[i] < -(kNoise * size * GapRoot(i) + kNoise * std::abs(scaled.b[i]));
    if (violated) violated_.push_back(i);
  }
  return static_cast<Index>(violated_.size());
}

void BlockPivoting::Exchange(bool least_only) {
  for (const Index i : violated_) {
    active_[At(i)] = active_[At(i)] == 0 ? 1 : 0;
    if (least_only) break;
  }
}

// The proximal step from center_: where it ends with kNotMet, active_, f_ solve the problem of A + weight D.
BlockPivoting::End BlockPivoting::PivotBlocks(const Rules& rules) {
  const Index n = f_.size();
  const auto rows = static_cast<double>(n);
  const auto none = static_cast<double>(n + 1);
  double least = none;
  int patience = rules.patience;
  for (;;) {
    if (factors_ - run_factors_ >= rules.factors) return End::kGaveUp;
    const bool first = factors_ == run_factors_;
    if (const End end = SolveActive(); end != End::kDone) return end;
    if (rules.end_when_singular && first && kDependentShare * task_.block->CountDependentRows() > n) {
      return End::kSingular;
    }
    const auto count = static_cast<double>(FindViolated(true));
    if (count == 0) return End::kNotMet;
    if (rules.try_every_set) {
      proximal_ = f_;
      if (const End end = CorrectForces(); end != End::kNotMet) return end;
      if (Publish() || Refine(task_.tolerance)) return End::kDone;
      f_ = proximal_;
    }
    const double most =
        least < none ? std::max(rules.progress * least, rules.few_wrong * rows) : rules.most_wrong * rows;
    if (count > most) return End::kGaveUp;
    if (count < least) {
      least = count;
      patience = rules.patience;
    } else {
      patience = std::max(patience - 1, 0);
    }
    if (patience == 0 && rules.end_when_cycling) return End::kCycling;
    if (patience == 0 && weight_ < rules.largest_weight) {
      weight_ = std::min(std::max(kCyclingWeight, weight_ * kRaise), rules.largest_weight);
      least = none;
      patience = rules.patience;
    }
    if (patience == 0) ++single_exchanges_;
    Exchange(patience == 0);
  }
}

// f_F += x with A_FF x = -(A f + b)_F by conjugate gradients, preconditioned with the factor, or by refinement on it.
// Leaves w_ = A f + b.
BlockPivoting::End BlockPivoting::CorrectForces() {
  const ScaledVectors& scaled = *task_.scaled;
  const Index n = f_.size();
  task_.block->Multiply(f_.data(), w_.data());
  w_ += scaled.b;
  double size = 0;
  for (Index i = 0; i < n; ++i)
    size = std::max(size, std::max(std::abs(f_[i]) * root_[i], std::abs(scaled.b[i]) / GapRoot(i)));
  const double rounding = kEpsilon * size;
  double before = std::numeric_limits<double>::infinity();
  double slope_before = 0;
  for (int step = 0; step < kMaxCorrections; ++step) {
    double largest = 0;
    for (Index i = 0; i < n; ++i) {
      residual_[i] = active_[At(i)] != 0 ? -w_[i] : 0.0;
      if (residual_[i] != 0) largest = std::max(largest, std::abs(residual_[i]) / GapRoot(i));
    }
    if (!(largest > rounding) || !(largest < kSlowCorrection * before)) break;
    if (TimeIsUp()) return End::kStopped;
    before = largest;
    preconditioned_ = residual_;
    task_.block->Solve(preconditioned_.data());
    const double slope = residual_.dot(preconditioned_);
    if (step == 0 || !task_.conjugate) {
      direction_ = preconditioned_;
    } else {
      direction_ = preconditioned_ + (slope / slope_before) * direction_;
    }
    slope_before = slope;
    task_.block->Multiply(direction_.data(), image_.data());
    const double curvature = direction_.dot(image_);
    const double norm2 = (scaled.diagonal.array() * direction_.array().square()).sum();
    if (!(curvature > kNullCurvature * norm2)) break;
    const double length = task_.conjugate ? slope / curvature : 1;
    f_ += length * direction_;
    w_ += length * image_;
  }
  return TimeIsUp() ? End::kStopped : End::kNotMet;
}

// Where rounding is what is left, and too much for rows whose terms are all tiny: with residuals in extended precision.
bool BlockPivoting::Refine(double tolerance) {
  if (task_.problem == nullptr || task_.conjugate || !IsNear()) return false;
  double most = kWorthRefining;
  for (int k = 0; k < kMaxRefinements && tier() > tolerance && !TimeIsUp(); ++k) {
    GiveForces(0, &ray_);
    const auto rho = static_cast<double>(product_.Rho(ray_));
    if (!(rho <= std::max(most, task_.tolerance))) return false;
    most = kSlowCorrection * rho;
    for (Index i = 0; i < f_.size(); ++i) {
      const auto w = static_cast<double>(product_.w(i));
      residual_[i] = active_[At(i)] != 0 ? -task_.scaled->ScaledGap(i, w) : 0.0;
    }
    task_.block->Solve(residual_.data());
    f_ += residual_;
    if (Publish()) return true;
  }
  return false;
}

// The problem of A itself from active_, f_, a few exchanges at most. Publishes; kDone if the answer is good enough.
BlockPivoting::End BlockPivoting::Polish(Index most, double tolerance) {
  Index least = most;
  for (int round = 0; round < kMaxPolishes; ++round) {
    if (const End end = CorrectForces(); end != End::kNotMet) return end;
    if (Publish() || Refine(tolerance)) return End::kDone;
    const Index count = FindViolated(false);
    if (count == 0 || count >= least) break;
    least = count;
    Exchange(false);
    if (const End end = Factor(active_, weight_); end != End::kDone) return end;
    for (Index i = 0; i < f_.size(); ++i) {
      if (active_[At(i)] == 0) f_[i] = 0;
    }
  }
  return End::kNotMet;
}

BlockPivoting::End BlockPivoting::Finish(const std::vector<char>& active, const Eigen::VectorXd& f, double weight,
                                         Index most) {
  weight_ = weight;
  active_ = active;
  if (const End end = Factor(active_, weight_); end != End::kDone) return end;
  for (Index i = 0; i < f.size(); ++i) f_[i] = active_[At(i)] != 0 ? f[i] : 0.0;
  return Polish(most, 0);
}

void BlockPivoting::GiveForces(double least, Eigen::VectorXd* f) const {
  const double threshold = least * LargestForce();
  for (Index i = 0; i < f_.size(); ++i) {
    const double force = task_.scaled->is_joint(i) ? std::abs(f_[i]) : f_[i];
    (*f)[i] = force * root_[i] > threshold ? task_.scaled->GivenForce(i, f_[i]) : 0.0;
  }
}

bool BlockPivoting::IsNear() const { return task_.sink->rho() <= kNear * std::max(kWorthRefining, task_.tolerance); }

// Forces that are rounding beside the largest are published as 0 if that is better: where all forces around a row
// should be 0, the row's backward error is rounding over rounding.
bool BlockPivoting::Publish() {
  AnswerSink& sink = *task_.sink;
  const auto publish = [&](double least) {
    GiveForces(least, &sink.candidate());
    return sink.Publish();
  };
  if (task_.through_bodies && publish(kEpsilon)) return true;
  if (!(task_.through_bodies && sink.tier() <= proof_tolerance()) && publish(0)) return true;
  for (const double tiny : kTinyForces) {
    if (sink.tier() <= proof_tolerance() || !IsNear() || TimeIsUp()) break;
    if (publish(tiny)) return true;
  }
  return false;
}

// A y is not quite 0 while the steps still change: it is made so by a few corrections with a factor of (almost) A
// itself and residuals in extended precision. AcceptedRay, which allocates, is asked only where the verifier's rule is
// met.
bool BlockPivoting::FindRay(const Eigen::VectorXd& direction) {
  if (task_.problem == nullptr) return false;
  const ScaledVectors& scaled = *task_.scaled;
  const LcpProblem& problem = *task_.problem;
  const Index n = f_.size();
  const Eigen::VectorXd& b = problem.b();
  const double size = direction.cwiseAbs().maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return false;
  direction_ = kLift * (direction / size);  // so that small whole ratios, which are frequent, are exact
  for (Index i = 0; i < n; ++i) {
    const bool acts = scaled.acts(i) && (scaled.is_joint(i) ? direction_[i] != 0 : direction_[i] > kRaySupport * kLift);
    active_[At(i)] = acts ? 1 : 0;
  }
  for (int pass = 0; pass <= kRayCorrections; ++pass) {
    for (Index i = 0; i < n; ++i) ray_[i] = active_[At(i)] != 0 ? direction_[i] * scaled.scale[i] : 0.0;
    product_.Rho(ray_);  // w = A y + b
    long double b_dot_y = 0;
    long double b_size = 0;
    long double largest = 0;
    for (Index i = 0; i < n; ++i) {
      const long double root = scaled.acts(i) ? std::sqrt(problem.DiagonalA()[i]) : 1.0;
      b_dot_y += static_cast<long double>(b[i]) * ray_[i];
      b_size += std::abs(b[i]) / root;
      largest = std::max(largest, std::abs(product_.w(i) - b[i]) / root);
      residual_[i] = static_cast<double>(product_.w(i) - b[i]) * scaled.scale[i];
      if (!scaled.is_joint(i)) ray_[i] = std::max(ray_[i], 0.0);
    }
    if (-b_dot_y >= FarkasVerdict::kRayThreshold * largest * b_size) {
      accepted_ray_ = AcceptedRay(problem, ray_ / kLift);
      if (accepted_ray_.has_value()) return true;
    }
    if (pass == 0 && !task_.block->Factor(active_, kRayWeight, task_.deadline)) return false;
    task_.block->Solve(residual_.data());
    direction_ -= residual_;
  }
  return false;
}

BlockPivoting::End BlockPivoting::TakeProximalSteps(const Rules& rules) {
  weight_ = std::max(rules.weight, kLeastWeight);
  run_factors_ = factors_;
  for (int step = 0; step < rules.steps; ++step) {
    if (const End end = PivotBlocks(rules); end != End::kNotMet) return end;
    proximal_ = f_;
    active_proximal_ = active_;
    const double before = tier();
    if (const End end = Polish(f_.size() + 1, task_.tolerance); end != End::kNotMet) return end;
    if (tier() <= proof_tolerance() && tier() > kWorthAnotherStep * before) return End::kDone;
    double moved = 0;
    double size = 0;
    for (Index i = 0; i < f_.size(); ++i) {
      moved = std::max(moved, std::abs(proximal_[i] - center_[i]) * root_[i]);
      size = std::max(size, std::abs(proximal_[i]) * root_[i]);
    }
    if (step > 0 && tier() > proof_tolerance() && moved * (step + 1) >= kDivergence * size) {
      direction_ = proximal_ - center_;
      if (FindRay(direction_)) return End::kInfeasible;
    }
    center_ = proximal_;
    active_ = active_proximal_;
    weight_ = std::max(weight_ * rules.weight_factor, kLeastWeight);
  }
  return End::kNotMet;
}

void PivotingSetup::Prepare(const LcpProblem& problem, ActiveBlockChoice::Allowed allowed) {
  block = blocks.Analyze(problem, allowed);
  answer.Reset(problem, blocks.is_dense(block));
  pivoting.Reserve(problem);
  scaled.Reset(problem);
}

bool PivotingSetup::Load(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline,
                         std::int64_t factors, bool conjugate, LcpResult* result) {
  if (!scaled.Load(problem)) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return false;
  }
  const double proof_tolerance = std::min(options.tolerance, BlockPivoting::kProofTolerance);
  result->farkas_ray = FindZeroRowRay(problem, proof_tolerance * scaled.b_norm);
  if (result->farkas_ray.has_value()) {
    result->status = LcpStatus::kInfeasible;
    return false;
  }
  block->Load(problem, scaled.scale);
  answer.Start(problem, options.tolerance, result);
  const std::int64_t most = options.max_iterations > 0 ? options.max_iterations : factors;
  pivoting.SetTask({&problem, &scaled, block, sink, deadline, most, options.tolerance, conjugate});
  return true;
}

void RowSink::Start(const RowTask& task) {
  task_ = &task;
  tier_ = rho_ = std::numeric_limits<double>::infinity();
}

bool RowSink::Publish() {
  const auto passes = [this](double tolerance) {
    return task_->judge.Passes(task_->rows, task_->all, tolerance, f_.data(), task_->w, &rho_);
  };
  const double tolerance = task_->options.tolerance;
  const double enough = std::min(tolerance, BlockPivoting::kProofTolerance);
  const bool is_enough = passes(enough);
  const bool meets = is_enough || (enough < tolerance && rho_ <= tolerance && passes(tolerance));
  // The judge says only that backward errors are within its limit, not how large they are.
  const double tier = is_enough ? rho_ : std::max(rho_, tableau::kMargin * tableau::kMargin * tolerance);
  if (meets && tier < tier_) {
    tier_ = tier;
    best_.swap(f_);
  }
  return is_enough;
}

void PivotingSetup::PrepareRows(Index size) {
  block = &block_of_rows;
  sink = &row_answer;
  block_of_rows.Reserve(size);
  pivoting.Reserve(size);
  scaled.Reset(size);
  row_answer.Reserve(size);
  for (Eigen::VectorXd* v : {&given_diagonal, &given_b}) v->setZero(size);
}

bool PivotingSetup::LoadRows(const RowTask& task, std::int64_t factors, bool conjugate) {
  const StepRows& rows = task.rows;
  block_of_rows.Assemble(rows);
  given_diagonal.setZero();
  given_b.setZero();
  std::fill(scaled.bilateral.begin(), scaled.bilateral.end(), 0);
  for (Index i = 0; i < rows.rows; ++i) {
    given_diagonal[i] = block_of_rows.given_diagonal(i);
    if (!(given_diagonal[i] > 0)) return false;
    given_b[i] = rows.b[i];
    scaled.bilateral[At(i)] = rows.bilateral != nullptr && rows.bilateral[i] != 0 ? 1 : 0;
  }
  scaled.Load(given_diagonal, given_b);
  block_of_rows.Scale(scaled.scale);
  row_answer.Start(task);
  pivoting.SetTask({nullptr, &scaled, block, sink, task.deadline, factors, task.options.tolerance, conjugate});
  return true;
}

bool PivotingSetup::ConcludeRows(const RowTask& task, LcpResult* result) {
  if (!(row_answer.tier() <= task.options.tolerance)) return false;
  result->f = row_answer.best().head(task.rows.rows);
  result->iterations = pivoting.factors();
  result->status = LcpStatus::kSolved;
  return true;
}

void PivotingSetup::Conclude(BlockPivoting::End end, double tolerance, LcpResult* result) {
  using End = BlockPivoting::End;
  result->iterations = pivoting.factors();
  if (end == End::kInfeasible) {
    result->status = LcpStatus::kInfeasible;
    result->farkas_ray = std::move(pivoting.ray());
  } else if (answer.tier() <= tolerance) {
    result->status = LcpStatus::kSolved;
  } else if (end == End::kIterationLimit || end == End::kStopped) {
    result->status = end == End::kStopped ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
  } else {
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "tier %.1e after all proximal steps, and no proven ray", answer.tier());
    result->detail = end == End::kSingular ? "A is singular" : end == End::kCycling ? "blocks cycle" : text.data();
  }
}

}  // namespace lcpbench
