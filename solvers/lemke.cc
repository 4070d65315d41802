#include "solvers/lemke.h"

#include <cstdint>
#include <cstdio>
#include <limits>

#include "solvers/lemke_engine.h"
#include "solvers/zero_row_ray.h"

namespace lcpbench {
namespace {

// Paths after the first are repairs; each must improve the residual.
constexpr int kMaxPaths = 10;
// Factors on rank_tolerance for the first attempt and the restarts.
constexpr double kAttempts[] = {1.0, 1e-2, 1e3};
constexpr std::int64_t kPivotsPerRow = 50;
constexpr std::int64_t kExtraPivots = 1000;

}  // namespace

void LemkeSolver::Engine::Reserve(Index max_rows) {
  if (max_rows <= rate_.size()) return;
  PivotBase::Reserve(max_rows);
  for (Eigen::VectorXd* v : {&cover_, &perturbation_, &rate_, &y_, &first_order_, &work_}) v->setZero(max_rows);
  ties_.reserve(static_cast<size_t>(max_rows));
}

void LemkeSolver::Engine::Prepare(const LcpProblem& problem) {
  Reserve(problem.size());
  PivotBase::Prepare(problem);
}

PivotBase::End LemkeSolver::Engine::Run(LcpResult* result) {
  End end = EnterJoints(result);
  if (end == End::kDone) end = EnterWarmRows();
  const Index in_play = open_;
  SolveForces(true);
  for (int path = 0; path < kMaxPaths && end == End::kDone; ++path) {
    open_ = in_play;
    const double violation = ComputeGaps();
    if (path > 0 && violation == 0) break;
    if (violation > 0) end = FollowPath(violation, result);
    if (end != End::kDone) break;
    SolveForces(path == 0);
    const double tier_before = judge_.tier();
    if (Publish(result)) break;
    if (path > 0 && !(judge_.tier() < tier_before)) break;
    Refine();
    if (Publish(result)) break;
    SolveForces(false);
  }
  if (end != End::kDone) Publish(result);
  if (judge_.tier() <= (end == End::kInfeasible ? proof_tolerance_ : tolerance_)) return End::kDone;
  return end == End::kDone ? End::kNotMet : end;
}

void LemkeSolver::Engine::Solve(const LcpOptions& options, LcpResult* result) {
  Start(options, kPivotsPerRow * problem_->size() + kExtraPivots);
  End end = End::kNotMet;
  char text[160];
  for (const double factor : kAttempts) {
    if (end != End::kNotMet) break;
    if (!Load(options_.rank_tolerance * factor)) {
      result->status = LcpStatus::kUnsupported;
      result->detail = "A has a negative diagonal entry, so it is not positive semidefinite";
      return;
    }
    result->farkas_ray = FindZeroRowRay(*problem_, proof_tolerance_ * lcp_.b_norm);
    if (result->farkas_ray.has_value()) {
      result->status = LcpStatus::kInfeasible;
      return;
    }
    end = Run(result);
    if (factor != kAttempts[0] && end == End::kDone) {
      std::snprintf(text, sizeof text, "solved after a restart with rank tolerance %.0e", rank_tolerance_);
      result->detail = text;
    }
  }
  result->iterations = pivots_;
  switch (end) {
    case End::kDone:
      result->status = LcpStatus::kSolved;
      result->farkas_ray.reset();
      break;
    case End::kInfeasible:
      result->status = LcpStatus::kInfeasible;
      break;
    case End::kIterationLimit:
      result->status = LcpStatus::kIterationLimit;
      break;
    case End::kTimeLimit:
      result->status = LcpStatus::kTimeLimit;
      break;
    case End::kNotMet:
      result->status = LcpStatus::kNumericalFailure;
      std::snprintf(text, sizeof text,
                    "residual %.1e above the tolerance for rank tolerances %.0e, %.0e and %.0e, and no proven ray",
                    judge_.tier(), options_.rank_tolerance, options_.rank_tolerance * kAttempts[1],
                    options_.rank_tolerance * kAttempts[2]);
      result->detail = text;
      break;
  }
}

LemkeOptions LemkeOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("lemke", settings);
  LemkeOptions options;
  options.rank_tolerance =
      reader.Number("rank_tolerance", options.rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  options.max_rows = static_cast<Index>(reader.Number("max_rows", static_cast<double>(options.max_rows), 1, 1e5));
  reader.Finish();
  return options;
}

LemkeSolver::LemkeSolver(LemkeOptions options)
    : max_rows_(options.max_rows), engine_(std::make_unique<Engine>(options)) {}
LemkeSolver::~LemkeSolver() = default;

std::string LemkeSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > max_rows_) {
    return std::to_string(problem.size()) + " rows are more than max_rows = " + std::to_string(max_rows_) +
           " of this dense solver";
  }
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

void LemkeSolver::Reserve(Index max_rows) { engine_->Reserve(max_rows); }

void LemkeSolver::DoPrepare(const LcpProblem& problem) { engine_->Prepare(problem); }

void LemkeSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(options, result);
}

}  // namespace lcpbench
