#include "solvers/active_set/bpp.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "solvers/active_set/block_pivoting.h"
#include "solvers/active_set/semismooth_newton.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/rows/fixed_size_bpp.h"

namespace lcpbench {
namespace {

// A warm start that leaves more than this part of the rows violated is forgotten.
constexpr double kFarStart = 0.1;
// Entries of a warm start enter F above this multiple of the largest D^1/2 f (an interior point leaves no zeros).
constexpr double kWarmThreshold = 1e-10;
// The forces of a warm start are used, not its active set only, if its rho is at most this part of the one at f = 0.
constexpr double kUsefulForces = 0.05;
// The starting weight is for up to so many rows, see BppOptions::proximal. At 10^5 rows chain-of-links takes 15 steps
// instead of 30, cam-follower 5 instead of 15; other independent families at most one more.
constexpr double kWeightRows = 1e4;
constexpr std::int64_t kFactorizationsPerRow = 10;
constexpr std::int64_t kExtraFactorizations = 200;

}  // namespace

class BppEngine final : public RowEngine {
 public:
  explicit BppEngine(const BppOptions& options) : RowEngine(MostRows(options)), options_(options) {}
  static constexpr bool kSolvesByFaces = true;

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return setup_.StepTime(); }
  bool is_dense() const { return setup_.blocks.is_dense(setup_.block); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  void PrepareRows(Index size);
  bool SolveFilledUp(const RowTask& task, LcpResult* result);

 private:
  using End = BlockPivoting::End;

  // Rows are solved with a dense block and by blocks alone, unless the caller asks for something else.
  static Index MostRows(const BppOptions& options) {
    const bool may_be_dense = options.form != BppOptions::Form::kSparse;
    const Index most = std::min(EnginesBySize<BppEngine>::kMostRows, options.continuation_rows - 1);
    return may_be_dense ? std::min(options.max_dense_rows, most) : 0;
  }
  bool SolveRows(const RowTask& task, LcpResult* result) override {
    return of_rows_.Find(task.rows.rows, options_).SolveFilledUp(task, result);
  }

  void TellSingleExchanges(LcpResult* result) const;
  bool SolveFewRows(const RowTask& task, LcpResult* result);
  void StartWarm(const Eigen::VectorXd& initial_f);
  End Pivot(const Eigen::VectorXd* initial_f, Index n);
  void Continue(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline, LcpResult* result);

  const BppOptions options_;
  PivotingSetup setup_;
  Eigen::VectorXd f_, w_;  // of a warm start
  FixedSizeBpp few_;
  EnginesBySize<BppEngine> of_rows_;
  std::optional<SemismoothNewtonSolver> newton_;  // once it has been asked
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
  setup_.Prepare(problem, {.sparse = options_.form != Form::kDense,
                           .dense = options_.form != Form::kSparse && n <= options_.max_dense_rows});
  for (Eigen::VectorXd* v : {&f_, &w_}) v->setZero(n);
}

// With forces that are of use here, F is what they leave active, and they are the first centre: the step from there is
// shorter than from 0. Of other forces only the set is taken.
void BppEngine::StartWarm(const Eigen::VectorXd& initial_f) {
  const ScaledVectors& scaled = setup_.scaled;
  f_.setZero();
  const double cold = scaled.Rho(f_, scaled.b);
  scaled.Clip(initial_f, &f_);
  setup_.block->Multiply(f_.data(), w_.data());
  w_ += scaled.b;
  if (scaled.Rho(f_, w_) <= kUsefulForces * cold) return setup_.pivoting.StartFrom(f_, w_);
  setup_.pivoting.StartCold();
  const auto size = [&](Index i) { return scaled.is_joint(i) ? 0.0 : f_[i] * std::sqrt(scaled.diagonal[i]); };
  double largest = 0;
  for (Index i = 0; i < f_.size(); ++i) largest = std::max(largest, size(i));
  for (Index i = 0; i < f_.size(); ++i) {
    if (scaled.is_joint(i) || !scaled.acts(i)) continue;
    setup_.pivoting.active()[static_cast<size_t>(i)] = size(i) > kWarmThreshold * largest ? 1 : 0;
  }
}

BlockPivoting::End BppEngine::Pivot(const Eigen::VectorXd* initial_f, Index n) {
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
    const End end = setup_.pivoting.TakeProximalSteps(warm);
    if (end != End::kGaveUp && end != End::kCycling) return end;
    rules.end_when_singular = false;
  }
  // From all rows, where the start is not as good as it should be.
  rules.end_when_cycling = options_.end_when_cycling || n >= options_.continuation_rows;
  setup_.pivoting.StartCold();
  return setup_.pivoting.TakeProximalSteps(rules);
}

void BppEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  std::optional<Deadline> deadline;
  if (Deadline::IsNeeded(options)) deadline.emplace(options);
  const std::int64_t factors = kFactorizationsPerRow * problem.size() + kExtraFactorizations;
  const Deadline* limit = deadline.has_value() ? &*deadline : nullptr;
  if (!setup_.Load(problem, options, limit, factors, /*conjugate=*/true, result)) return;
  setup_.Conclude(Pivot(options.initial_f, problem.size()), options.tolerance, result);
  TellSingleExchanges(result);
  const bool continues = problem.size() >= options_.continuation_rows;
  if (continues && result->status == LcpStatus::kNumericalFailure) Continue(problem, options, limit, result);
}

void BppEngine::Continue(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline,
                         LcpResult* result) {
  if (!newton_) newton_.emplace(SemismoothNewtonOptions{.continuation_rows = options_.continuation_rows});
  if (deadline == nullptr || !deadline->Expired()) newton_->Prepare(problem);
  const std::int64_t done = result->iterations;
  LcpOptions rest = options;
  if (deadline != nullptr) rest.time_limit_s = deadline->Remaining();
  if (options.max_iterations > 0) rest.max_iterations -= done;
  if (options.max_iterations > 0 && rest.max_iterations <= 0) {
    result->status = LcpStatus::kIterationLimit;
  } else if (rest.time_limit_s <= 0) {
    result->status = LcpStatus::kTimeLimit;
  } else {
    newton_->Solve(problem, rest, result);
    result->iterations += done;
  }
}

void BppEngine::PrepareRows(Index size) {
  setup_.PrepareRows(size);
  for (Eigen::VectorXd* v : {&f_, &w_}) v->setZero(size);
}

// By the same method in registers, without the proximal loop; not where the caller asks for something particular.
bool BppEngine::SolveFewRows(const RowTask& task, LcpResult* result) {
  static const BppOptions kUsual;
  const bool is_usual = options_.proximal == kUsual.proximal && options_.largest_proximal == kUsual.largest_proximal &&
                        options_.patience == kUsual.patience && !options_.end_when_singular &&
                        !options_.end_when_cycling && task.options.initial_f == nullptr;
  if (!is_usual || task.rows.rows > FixedSizeBpp::kMostRows) return false;
  const double tolerance = std::min(task.options.tolerance, BlockPivoting::kProofTolerance);
  double rho = 0;
  if (!few_.Solve(task.rows, task.all, tolerance, tableau::kMargin * std::sqrt(tolerance), result->f.data(), task.w,
                  &rho)) {
    return false;
  }
  result->iterations = 1;
  result->status = LcpStatus::kSolved;
  return true;
}

bool BppEngine::SolveFilledUp(const RowTask& task, LcpResult* result) {
  if (SolveFewRows(task, result)) return true;
  const Index n = task.rows.rows;
  if (!setup_.LoadRows(task, kFactorizationsPerRow * n + kExtraFactorizations, /*conjugate=*/true)) return false;
  Pivot(task.options.initial_f, n);
  if (!setup_.ConcludeRows(task, result)) return false;
  TellSingleExchanges(result);
  return true;
}

void BppEngine::TellSingleExchanges(LcpResult* result) const {
  if (const std::int64_t single = setup_.pivoting.single_exchanges(); single > 0) {
    result->detail += (result->detail.empty() ? "" : "; ") + std::to_string(single) + " single exchanges";
  }
}

void BppOptions::Read(SettingsReader* reader) {
  const std::string chosen = reader->Choice("form", "auto", {"auto", "dense", "sparse"});
  if (chosen == "dense") form = Form::kDense;
  if (chosen == "sparse") form = Form::kSparse;
  constexpr double kLeast = BlockPivoting::kLeastWeight;
  proximal = reader->Number("proximal", proximal, kLeast, 1e-2);
  largest_proximal = reader->Number("largest_proximal", largest_proximal, kLeast, 100);
  patience = static_cast<int>(reader->Number("patience", patience, 1, 100));
  end_when_singular = reader->YesOrNo("end_when_singular", end_when_singular);
  end_when_cycling = reader->YesOrNo("end_when_cycling", end_when_cycling);
  max_dense_rows = static_cast<Index>(reader->Number("max_dense_rows", static_cast<double>(max_dense_rows), 1, 1e5));
  if (continuation_rows == BppOptions().continuation_rows) return;
  continuation_rows =
      static_cast<Index>(reader->Number("continuation_rows", static_cast<double>(continuation_rows), 1, 1e9));
}

double BppSolver::StepTime() const { return engine_->StepTime(); }
bool BppSolver::is_dense() const { return engine_->is_dense(); }

template class EngineSolver<BppOptions, BppEngine>;

}  // namespace lcpbench
