#include "solvers/active_set/bpp.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>

#include "solvers/active_set/block_pivoting.h"
#include "solvers/answers/zero_row_ray.h"
#include "solvers/linear_algebra/active_block_choice.h"

namespace lcpbench {
namespace {

// A warm start that leaves more than this part of the rows violated is forgotten.
constexpr double kFarStart = 0.1;
// Entries of a warm start enter F above this multiple of the largest D^1/2 f (an interior point leaves no zeros).
constexpr double kWarmThreshold = 1e-10;
// Of a warm start whose rho is at most this part of the one at f = 0, not only the set is of use.
constexpr double kUsefulForces = 0.05;
// The starting weight is for up to so many rows, see BppOptions::proximal. At 10^5 rows chain-of-links takes 15 steps
// instead of 30, cam-follower 5 instead of 15; other independent families at most one more.
constexpr double kWeightRows = 1e4;
constexpr std::int64_t kFactorizationsPerRow = 10;
constexpr std::int64_t kExtraFactorizations = 200;

}  // namespace

class BppEngine {
 public:
  explicit BppEngine(const BppOptions& options) : options_(options) {}

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return blocks_.StepTime(block_, f_.size()); }
  bool is_dense() const { return blocks_.is_dense(block_); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  using End = BlockPivoting::End;

  void StartWarm(const Eigen::VectorXd& initial_f);
  End Run(const Eigen::VectorXd* initial_f, Index n);

  const BppOptions options_;
  JudgedAnswer answer_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  ScaledVectors scaled_;
  BlockPivoting pivoting_;
  Eigen::VectorXd f_, w_;  // of a warm start
};

std::string BppEngine::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == BppOptions::Form::kDense && problem.size() > options_.max_dense_rows) {
    return std::to_string(problem.size()) + " rows are more than max_dense_rows of the dense form";
  }
  return WhyNotSymmetric(problem);
}

void BppEngine::Prepare(const LcpProblem& problem) {
  const Index n = problem.size();
  using Form = BppOptions::Form;
  const bool bodies_only = options_.form == Form::kBodies && ActiveBlockChoice::HasBodies(problem);
  block_ =
      blocks_.Analyze(problem, {.sparse = options_.form != Form::kDense && !bodies_only,
                                .dense = options_.form != Form::kSparse && !bodies_only && n <= options_.max_dense_rows,
                                .bodies = bodies_only || options_.form == Form::kAny});
  if (options_.self_check) answer_.Reset(problem, is_dense());
  pivoting_.Reserve(problem);
  scaled_.Reset(problem);
  for (Eigen::VectorXd* v : {&f_, &w_}) v->setZero(n);
}

// With forces that are of use here, F is what they leave active, and they are the first centre: the step from there is
// shorter than from 0. Of other forces only the set is taken.
void BppEngine::StartWarm(const Eigen::VectorXd& initial_f) {
  f_.setZero();
  const double cold = scaled_.Rho(f_, scaled_.b);
  scaled_.Clip(initial_f, &f_);
  block_->Multiply(f_.data(), w_.data());
  w_ += scaled_.b;
  if (scaled_.Rho(f_, w_) <= kUsefulForces * cold) return pivoting_.StartFrom(f_, w_);
  pivoting_.StartCold();
  const auto size = [&](Index i) { return scaled_.is_joint(i) ? 0.0 : f_[i] * std::sqrt(scaled_.diagonal[i]); };
  double largest = 0;
  for (Index i = 0; i < f_.size(); ++i) largest = std::max(largest, size(i));
  for (Index i = 0; i < f_.size(); ++i) {
    if (scaled_.is_joint(i) || !scaled_.acts(i)) continue;
    pivoting_.active()[static_cast<size_t>(i)] = size(i) > kWarmThreshold * largest ? 1 : 0;
  }
}

BlockPivoting::End BppEngine::Run(const Eigen::VectorXd* initial_f, Index n) {
  const double larger = std::max(1.0, static_cast<double>(n) / kWeightRows);
  BlockPivoting::Rules rules;
  rules.weight = options_.proximal / (larger * larger);
  rules.largest_weight = options_.largest_proximal;
  rules.patience = options_.patience;
  rules.end_when_singular = options_.end_when_singular;
  if (initial_f != nullptr) {
    BlockPivoting::Rules warm = rules;
    warm.most_wrong = kFarStart;
    warm.end_when_cycling = true;
    StartWarm(*initial_f);
    const End end = pivoting_.Run(warm);
    if (end != End::kGaveUp && end != End::kCycling) return end;
    rules.end_when_singular = false;
  }
  // From all rows, where the start is not as good as it should be.
  rules.end_when_cycling = options_.end_when_cycling;
  pivoting_.StartCold();
  return pivoting_.Run(rules);
}

void BppEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  std::optional<Deadline> deadline;
  if (std::isfinite(options.time_limit_s)) deadline.emplace(options);
  if (!scaled_.Load(problem)) {
    result->status = LcpStatus::kUnsupported;
    result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
    return;
  }
  const double proof_tolerance = std::min(options.tolerance, BlockPivoting::kProofTolerance);
  result->farkas_ray = FindZeroRowRay(problem, proof_tolerance * scaled_.b_norm);
  if (result->farkas_ray.has_value()) {
    result->status = LcpStatus::kInfeasible;
    return;
  }
  block_->Load(problem, scaled_.scale);
  if (options_.self_check) answer_.Start(problem, options.tolerance, result);
  BlockPivoting::Task task;
  task.problem = &problem;
  task.scaled = &scaled_;
  task.block = block_;
  task.sink = options_.self_check ? &answer_ : nullptr;
  task.deadline = deadline.has_value() ? &*deadline : nullptr;
  task.factors = options.max_iterations > 0 ? options.max_iterations
                                            : kFactorizationsPerRow * problem.size() + kExtraFactorizations;
  task.tolerance = options.tolerance;
  task.conjugate = true;
  task.through_bodies = blocks_.is_through_bodies(block_);
  pivoting_.Begin(task);
  const End end = Run(options.initial_f, problem.size());
  if (!options_.self_check) {
    pivoting_.GiveForces(task.through_bodies ? std::numeric_limits<double>::epsilon() : 0, &result->f);
  }
  result->iterations = pivoting_.factors();
  if (end == End::kInfeasible) {
    result->status = LcpStatus::kInfeasible;
    result->farkas_ray = std::move(pivoting_.ray());
  } else if (options_.self_check ? answer_.tier() <= options.tolerance : end == End::kDone) {
    result->status = LcpStatus::kSolved;
  } else if (end == End::kIterationLimit || end == End::kStopped) {
    result->status = end == End::kStopped ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
  } else if (end == End::kSingular || end == End::kCycling) {
    result->detail = end == End::kSingular ? "A is singular" : "blocks cycle";
  } else {
    char text[128];
    std::snprintf(text, sizeof text, "residual %.1e above the tolerance after all proximal steps, and no proven ray",
                  answer_.tier());
    result->detail = text;
  }
  if (const std::int64_t single = pivoting_.single_exchanges(); single > 0) {
    result->detail += (result->detail.empty() ? "" : "; ") + std::to_string(single) + " single exchanges";
  }
}

BppOptions BppOptions::FromSettings(const Settings& settings, const char* key) {
  SettingsReader reader(key, settings);
  BppOptions options;
  const std::string form = reader.Choice("form", "auto", {"auto", "dense", "sparse", "bodies"});
  if (form == "dense") options.form = Form::kDense;
  if (form == "sparse") options.form = Form::kSparse;
  if (form == "bodies") options.form = Form::kBodies;
  constexpr double kLeast = BlockPivoting::kLeastWeight;
  options.proximal = reader.Number("proximal", options.proximal, kLeast, 1e-2);
  options.largest_proximal = reader.Number("largest_proximal", options.largest_proximal, kLeast, 100);
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
