#include "solvers/active_set/bpp.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/answers/zero_row_ray.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/active_block_choice.h"
#include "solvers/linear_algebra/scaled_vectors.h"

namespace lcpbench {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A gap is rounding only up to this multiple of |D^1/2 f|_1 + |D^-1/2 b|_inf, in D^1/2.
constexpr double kNoise = 64 * kEpsilon;
// A force of the shifted problem is rounding only up to this multiple of epsilon / shift times the largest: that much a
// dependent row amplifies.
constexpr double kForceNoise = 8;
// Conjugate gradients end when the residual is rounding, or after so many steps.
constexpr int kMaxCorrections = 12;
// ... or when the residual falls by less than this.
constexpr double kSlowCorrection = 0.5;
// Curvature y.A y below this multiple of y.D y: the direction is in the null space.
constexpr double kNullCurvature = 1e-14;
constexpr int kMaxPolishes = 8;
// A warm start that leaves more than this part of the rows violated is forgotten.
constexpr double kFarStart = 0.1;
// Where blocks cycle, the shift rises to this at least, then tenfold: on all redundant families blocks settle there.
constexpr double kCyclingShift = 1e-2;
constexpr double kRaise = 10;

// Entries of a warm start enter F above this multiple of the largest D^1/2 f (an interior point leaves no zeros).
constexpr double kWarmThreshold = 1e-10;
// Of a warm start whose rho is at most this part of the one at f = 0, not only the set is of use.
constexpr double kUsefulForces = 0.05;
// A proof of infeasibility is worth while above this residual only, or above the tolerance if that is less.
constexpr double kProofTolerance = 1e-9;
// An answer within the tolerance is taken when a proximal step improves it by less than this factor.
constexpr double kWorthAnotherStep = 0.1;
// Forces up to such a part of the largest D^1/2 f may be rounding, the more so the worse A_FF is conditioned.
constexpr double kTinyForces[] = {1e-14, 1e-12, 1e-10};
constexpr int kMaxSteps = 60;
constexpr double kLeastShift = 1e-11;
constexpr double kShiftFactor = 0.3;
// The starting shift is for up to so many rows, see BppOptions::proximal. At 10^5 rows chain-of-links takes 15 steps
// instead of 30, cam-follower 5 instead of 15; other independent families at most one more.
constexpr double kShiftRows = 1e4;

// A proximal step at least this part of f / steps so far does not look like convergence.
constexpr double kDivergence = 0.25;
constexpr int kRayCorrections = 4;
constexpr double kRayShift = 1e-10;
constexpr std::int64_t kFactorisationsPerRow = 10;
constexpr std::int64_t kExtraFactorisations = 200;

}  // namespace

// Vectors are by row of the problem, in scaled units: S A S, t S b, t S^-1 f as in PermutedLcp.
class BppEngine {
 public:
  explicit BppEngine(const BppOptions& options) : options_(options) {}

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return blocks_.StepTime(block_, f_.size()); }
  bool is_dense() const { return blocks_.is_dense(block_); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  enum class End { kDone, kInfeasible, kNotMet, kSingular, kCycling, kIterationLimit, kTimeLimit };

  bool Load();
  void SetStart();
  void StartCold();
  End Run(LcpResult* result);

  // The proximal step from center_: on return active_, f_ solve the problem of A + shift D.
  End PivotBlocks();
  // The same for A itself from active_, f_, a few exchanges at most. Publishes; kDone if the answer is good enough.
  End Polish(LcpResult* result);
  void SolveActive();
  End CorrectForces();
  Index FindViolated(bool of_shifted);
  void Exchange(bool least_only);
  bool ClaimRay(LcpResult* result);
  void GiveForces(double least, Eigen::VectorXd* f) const;
  double LargestForce() const;
  bool Publish(LcpResult* result);

  // A factorisation that the deadline ends leaves f_ meaningless, which TimeIsUp() then says, and judge_ would.
  const Deadline* deadline() const { return deadline_.has_value() ? &*deadline_ : nullptr; }
  bool TimeIsUp() const { return deadline_.has_value() && deadline_->Expired(); }
  static size_t At(Index i) { return static_cast<size_t>(i); }
  double ForceRoot(Index i) const { return root_[i]; }
  double GapRoot(Index i) const { return root_[i] * unit_; }

  const BppOptions options_;
  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  AnswerJudge judge_;
  GivenFormTest product_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  bool through_bodies_ = false;
  ScaledVectors scaled_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;
  const Eigen::VectorXd* initial_f_ = nullptr;
  std::optional<Deadline> deadline_;
  std::int64_t factorisations_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t single_exchanges_ = 0;
  bool started_warm_ = false;  // and still on the way from there

  // State.
  double shift_ = 0;
  double unit_ = 1;  // A_ii of the first row that can act
  Eigen::VectorXd root_;
  std::vector<char> active_, active_shifted_;
  std::vector<Index> violated_;
  Eigen::VectorXd f_, w_, center_, shifted_;
  Eigen::VectorXd residual_, direction_, image_, preconditioned_, ray_;
};

// f_ and w_ of the shifted problem for active_.
void BppSolver::Engine::SolveActive() {
  ++factorisations_;
  if (!block_->Factor(active_, shift_, deadline())) return;
  f_.array() = shift_ * scaled_.diagonal.array() * center_.array() - scaled_.b.array();
  block_->Solve(f_.data());
  block_->Multiply(f_.data(), w_.data());
  w_.array() += scaled_.b.array() + shift_ * scaled_.diagonal.array() * (f_ - center_).array();
}

// Fills violated_, ascending. Signs are judged relative to the rounding of forces and gaps.
Index BppSolver::Engine::FindViolated(bool of_shifted) {
  const Index n = f_.size();
  const double largest = LargestForce();
  const double size = f_.cwiseAbs().dot(root_);
  const double force_noise = of_shifted ? kForceNoise * kEpsilon / shift_ * largest : 0.0;
  violated_.clear();
  for (Index i = 0; i < n; ++i) {
    if (scaled_.is_joint(i) || !scaled_.acts(i)) continue;
    const bool violated = active_[At(i)] != 0 ? f_[i] * ForceRoot(i) < -force_noise
                                              : w_[i] < -(kNoise * size * GapRoot(i) + kNoise * std::abs(scaled_.b[i]));
    if (violated) violated_.push_back(i);
  }
  return static_cast<Index>(violated_.size());
}

void BppSolver::Engine::Exchange(bool least_only) {
  for (const Index i : violated_) {
    active_[At(i)] = active_[At(i)] == 0 ? 1 : 0;
    if (least_only) break;
  }
}

BppSolver::Engine::End BppSolver::Engine::PivotBlocks() {
  Index least = f_.size() + 1;
  int patience = options_.patience;
  for (;;) {
    if (factorisations_ >= limit_) return End::kIterationLimit;
    if (TimeIsUp()) return End::kTimeLimit;
    SolveActive();
    if (TimeIsUp()) return End::kTimeLimit;
    if (options_.end_when_singular && factorisations_ == 1 &&
        BppOptions::kDependentShare * block_->CountDependentRows() > f_.size()) {
      return End::kSingular;
    }
    const Index count = FindViolated(true);
    if (count == 0) return End::kDone;
    const bool far = least > f_.size() && static_cast<double>(count) > kFarStart * static_cast<double>(f_.size());
    if (count < least) {
      least = count;
      patience = options_.patience;
    } else {
      patience = std::max(patience - 1, 0);
    }
    if (started_warm_ && (patience == 0 || far)) {
      // The start is not as good as it should be: from all rows, as without it.
      StartCold();
      least = f_.size() + 1;
      patience = options_.patience;
      continue;
    }
    if (patience == 0 && options_.end_when_cycling) return End::kCycling;
    if (patience == 0 && shift_ < options_.largest_proximal) {
      shift_ = std::min(std::max(kCyclingShift, shift_ * kRaise), options_.largest_proximal);
      least = f_.size() + 1;
      patience = options_.patience;
    }
    if (patience == 0) ++single_exchanges_;
    Exchange(patience == 0);
  }
}

// f_F += x with A_FF x = -(A f + b)_F by conjugate gradients, preconditioned with K_FF. Leaves w_ = A f + b.
BppSolver::Engine::End BppSolver::Engine::CorrectForces() {
  const Index n = f_.size();
  block_->Multiply(f_.data(), w_.data());
  w_ += scaled_.b;
  double size = 0;
  for (Index i = 0; i < n; ++i)
    size = std::max(size, std::max(std::abs(f_[i]) * ForceRoot(i), std::abs(scaled_.b[i]) / GapRoot(i)));
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
    if (TimeIsUp()) return End::kTimeLimit;
    before = largest;
    preconditioned_ = residual_;
    block_->Solve(preconditioned_.data());
    const double slope = residual_.dot(preconditioned_);
    if (step == 0) {
      direction_ = preconditioned_;
    } else {
      direction_ = preconditioned_ + (slope / slope_before) * direction_;
    }
    slope_before = slope;
    block_->Multiply(direction_.data(), image_.data());
    const double curvature = direction_.dot(image_);
    const double norm2 = (scaled_.diagonal.array() * direction_.array().square()).sum();
    if (!(curvature > kNullCurvature * norm2)) break;
    const double length = slope / curvature;
    f_ += length * direction_;
    w_ += length * image_;
  }
  return End::kDone;
}

BppSolver::Engine::End BppSolver::Engine::Polish(LcpResult* result) {
  Index least = f_.size() + 1;
  for (int round = 0; round < kMaxPolishes; ++round) {
    if (CorrectForces() == End::kTimeLimit || TimeIsUp()) return End::kTimeLimit;
    if (Publish(result)) return End::kDone;
    const Index count = FindViolated(false);
    if (count == 0 && !options_.self_check) return End::kDone;
    if (count == 0 || count >= least) break;
    least = count;
    if (factorisations_ >= limit_) return End::kIterationLimit;
    if (TimeIsUp()) return End::kTimeLimit;
    Exchange(false);
    block_->Factor(active_, shift_, deadline());
    ++factorisations_;
    for (Index i = 0; i < f_.size(); ++i) {
      if (active_[At(i)] == 0) f_[i] = 0;
    }
  }
  return End::kNotMet;
}

std::string BppSolver::Engine::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == BppOptions::Form::kDense && problem.size() > options_.max_dense_rows) {
    return std::to_string(problem.size()) + " rows are more than max_dense_rows of the dense form";
  }
  return WhyNotSymmetric(problem);
}

void BppSolver::Engine::Prepare(const LcpProblem& problem) {
  problem_ = problem;
  const Index n = problem.size();
  using Form = BppOptions::Form;
  const bool bodies_only = options_.form == Form::kBodies && ActiveBlockChoice::HasBodies(problem);
  block_ =
      blocks_.Analyze(problem, {.sparse = options_.form != Form::kDense && !bodies_only,
                                .dense = options_.form != Form::kSparse && !bodies_only && n <= options_.max_dense_rows,
                                .bodies = bodies_only || options_.form == Form::kAny});
  through_bodies_ = blocks_.is_through_bodies(block_);
  if (options_.self_check) judge_.Reset(problem, blocks_.is_dense(block_));
  product_.Reset(problem);
  for (Eigen::VectorXd* v :
       {&root_, &f_, &w_, &center_, &shifted_, &residual_, &direction_, &image_, &preconditioned_, &ray_}) {
    v->setZero(n);
  }
  scaled_.Reset(problem);
  for (std::vector<char>* v : {&active_, &active_shifted_}) v->assign(At(n), 0);
  violated_.reserve(At(n));
}

bool BppSolver::Engine::Load() {
  if (!scaled_.Load(*problem_)) return false;
  const auto acts = std::find(scaled_.can_act.begin(), scaled_.can_act.end(), 1);
  unit_ = acts == scaled_.can_act.end() ? 1.0 : scaled_.diagonal[acts - scaled_.can_act.begin()];
  root_ = (scaled_.diagonal / unit_).cwiseSqrt();
  block_->Load(*problem_, scaled_.scale);
  return true;
}

void BppSolver::Engine::StartCold() {
  center_.setZero();
  f_.setZero();
  active_ = scaled_.can_act;
  started_warm_ = false;
}

// With forces that are of use here, F is what they leave active, and they are the first centre: the step from there is
// shorter than from 0. Of other forces only the set is taken.
void BppSolver::Engine::SetStart() {
  StartCold();
  if (initial_f_ == nullptr) return;
  const double cold = scaled_.Residual(f_, scaled_.b);
  double largest = 0;
  for (Index i = 0; i < f_.size(); ++i) {
    if (!scaled_.acts(i)) continue;
    const double force = scaled_.ScaledForce(i, (*initial_f_)[i]);
    f_[i] = scaled_.is_joint(i) ? force : std::max(force, 0.0);
    if (!scaled_.is_joint(i)) largest = std::max(largest, f_[i] * ForceRoot(i));
  }
  block_->Multiply(f_.data(), w_.data());
  w_ += scaled_.b;
  started_warm_ = true;
  const bool near = scaled_.Residual(f_, w_) <= kUsefulForces * cold;
  for (Index i = 0; i < f_.size(); ++i) {
    if (scaled_.is_joint(i) || !scaled_.acts(i)) continue;
    const bool acts = near ? scaled_.diagonal[i] * f_[i] > w_[i] : f_[i] * ForceRoot(i) > kWarmThreshold * largest;
    active_[At(i)] = acts ? 1 : 0;
  }
  if (near) center_ = f_;
}

// Forces up to `least` are 0.
void BppSolver::Engine::GiveForces(double least, Eigen::VectorXd* f) const {
  for (Index i = 0; i < f->size(); ++i) {
    const double force = scaled_.is_joint(i) ? std::abs(f_[i]) : f_[i];
    const bool acts = force * ForceRoot(i) > least;
    (*f)[i] = acts ? scaled_.GivenForce(i, f_[i]) : 0.0;
  }
}

double BppSolver::Engine::LargestForce() const { return f_.cwiseAbs().cwiseProduct(root_).maxCoeff(); }

// Forces that are rounding beside the largest are published as 0 if that is better: where all forces around a row
// should be 0, the row's backward error is rounding over rounding.
bool BppSolver::Engine::Publish(LcpResult* result) {
  const auto publish = [&](double least) {
    GiveForces(least, &judge_.candidate());
    return judge_.Publish(result);
  };
  const double largest = LargestForce();
  if (!options_.self_check) {
    GiveForces(through_bodies_ ? std::numeric_limits<double>::epsilon() * largest : 0, &result->f);
    return false;
  }
  // Through the bodies, rows that touch a body under load have forces of rounding where those by A are 0.
  if (through_bodies_ && publish(std::numeric_limits<double>::epsilon() * largest)) return true;
  if (!(through_bodies_ && judge_.tier() <= proof_tolerance_) && publish(0)) return true;
  for (const double tiny : kTinyForces) {
    if (judge_.tier() <= proof_tolerance_ || TimeIsUp()) break;
    publish(tiny * largest);
  }
  return judge_.tier() <= AnswerJudge::kGoodEnough;
}

// The step from center_ to shifted_ as a ray y. A y is not quite 0 while the steps still change: it is made so by a few
// corrections with a factor of (almost) A itself and residuals in extended precision. VerifyFarkasRay, which allocates,
// is asked only where its rule is met.
bool BppSolver::Engine::ClaimRay(LcpResult* result) {
  const Index n = f_.size();
  const Eigen::VectorXd& b = problem_->b();
  direction_ = shifted_ - center_;
  for (int pass = 0; pass <= kRayCorrections; ++pass) {
    for (Index i = 0; i < n; ++i) {
      const bool acts = scaled_.acts(i) && (scaled_.is_joint(i) || direction_[i] > 0);
      ray_[i] = acts ? direction_[i] * scaled_.scale[i] : 0.0;
    }
    product_.Rho(ray_);  // w = A y + b
    long double b_dot_y = 0;
    long double b_size = 0;
    long double largest = 0;
    for (Index i = 0; i < n; ++i) {
      const long double root = scaled_.acts(i) ? std::sqrt(problem_->DiagonalA()[i]) : 1.0;
      b_dot_y += static_cast<long double>(b[i]) * ray_[i];
      b_size += std::abs(b[i]) / root;
      largest = std::max(largest, std::abs(product_.w(i) - b[i]) / root);
    }
    if (!(b_dot_y < 0)) return false;
    if (-b_dot_y >= FarkasVerdict::kRayThreshold * largest * b_size && VerifyFarkasRay(*problem_, ray_).accepted) {
      result->farkas_ray = ray_;
      return true;
    }
    if (pass == 0) block_->Factor(active_shifted_, kRayShift, deadline());
    for (Index i = 0; i < n; ++i) residual_[i] = static_cast<double>(product_.w(i) - b[i]) * scaled_.scale[i];
    block_->Solve(residual_.data());
    direction_ -= residual_;
  }
  return false;
}

BppSolver::Engine::End BppSolver::Engine::Run(LcpResult* result) {
  SetStart();
  const double larger = std::max(1.0, static_cast<double>(problem_->size()) / kShiftRows);
  shift_ = std::max(options_.proximal / (larger * larger), kLeastShift);
  for (int step = 0; step < kMaxSteps; ++step) {
    End end = PivotBlocks();
    if (end != End::kDone) return end;
    shifted_ = f_;
    active_shifted_ = active_;
    const double tier_before = judge_.tier();
    end = Polish(result);
    if (end != End::kNotMet) return end;
    if (judge_.tier() <= proof_tolerance_ && judge_.tier() > kWorthAnotherStep * tier_before) return End::kDone;
    double moved = 0;
    double size = 0;
    for (Index i = 0; i < f_.size(); ++i) {
      moved = std::max(moved, std::abs(shifted_[i] - center_[i]) * ForceRoot(i));
      size = std::max(size, std::abs(shifted_[i]) * ForceRoot(i));
    }
    if (step > 0 && judge_.tier() > proof_tolerance_ && moved * (step + 1) >= kDivergence * size && ClaimRay(result)) {
      return End::kInfeasible;
    }
    center_ = shifted_;
    active_ = active_shifted_;
    shift_ = std::max(shift_ * kShiftFactor, kLeastShift);
  }
  return End::kNotMet;
}

void BppSolver::Engine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  problem_ = problem;
  if (options_.self_check) judge_.SetB(problem);
  product_.SetB(problem);
  tolerance_ = options.tolerance;
  proof_tolerance_ = std::min(tolerance_, kProofTolerance);
  initial_f_ = options.initial_f;
  deadline_.reset();
  if (std::isfinite(options.time_limit_s)) deadline_.emplace(options);
  factorisations_ = 0;
  single_exchanges_ = 0;
  limit_ = options.max_iterations > 0 ? options.max_iterations
                                      : kFactorisationsPerRow * problem_->size() + kExtraFactorisations;
  judge_.Start(tolerance_);
  if (!Load()) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return;
  }
  result->farkas_ray = FindZeroRowRay(*problem_, proof_tolerance_ * scaled_.b_norm);
  if (result->farkas_ray.has_value()) {
    result->status = LcpStatus::kInfeasible;
    return;
  }
  const End end = Run(result);
  result->iterations = factorisations_;
  if (end == End::kInfeasible) {
    result->status = LcpStatus::kInfeasible;
  } else if (options_.self_check ? judge_.tier() <= tolerance_ : end == End::kDone) {
    result->status = LcpStatus::kSolved;
  } else if (end == End::kIterationLimit || end == End::kTimeLimit) {
    result->status = end == End::kTimeLimit ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
  } else if (end == End::kSingular || end == End::kCycling) {
    result->detail = end == End::kSingular ? "A is singular" : "blocks cycle";
  } else {
    char text[160];
    std::snprintf(text, sizeof text, "residual %.1e above the tolerance after %d proximal steps, and no proven ray",
                  judge_.tier(), kMaxSteps);
    result->detail = text;
  }
  if (single_exchanges_ > 0) {
    result->detail += (result->detail.empty() ? "" : "; ") + std::to_string(single_exchanges_) + " single exchanges";
  }
}

BppOptions BppOptions::FromSettings(const Settings& settings, const char* key) {
  SettingsReader reader(key, settings);
  BppOptions options;
  const std::string form = reader.Choice("form", "auto", {"auto", "dense", "sparse", "bodies"});
  if (form == "dense") options.form = Form::kDense;
  if (form == "sparse") options.form = Form::kSparse;
  if (form == "bodies") options.form = Form::kBodies;
  options.proximal = reader.Number("proximal", options.proximal, kLeastShift, 1e-2);
  options.largest_proximal = reader.Number("largest_proximal", options.largest_proximal, kLeastShift, 100);
  options.patience = static_cast<int>(reader.Number("patience", options.patience, 1, 100));
  options.end_when_singular = reader.YesOrNo("end_when_singular", options.end_when_singular);
  options.end_when_cycling = reader.YesOrNo("end_when_cycling", options.end_when_cycling);
  options.self_check = reader.SelfCheck();
  options.max_dense_rows =
      static_cast<Index>(reader.Number("max_dense_rows", static_cast<double>(options.max_dense_rows), 1, 1e5));
  reader.Finish();
  return options;
}

double BppSolver::StepTime() const { return engine_->StepTime(); }
bool BppSolver::is_dense() const { return engine_->is_dense(); }

template class EngineSolver<BppOptions, BppEngine>;

}  // namespace lcpbench
