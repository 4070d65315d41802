#include "solvers/dantzig.h"

#include <algorithm>
#include <limits>

#include "solvers/dantzig_engine.h"

namespace lcpbench {
namespace {

// Rounds of driving after the first are repairs; each must improve the residual.
constexpr int kMaxRounds = 10;

}  // namespace

void DantzigSolver::Engine::Reserve(Index max_rows) {
  if (max_rows <= dw_.size()) return;
  PivotBase::Reserve(max_rows);
  dw_.setZero(max_rows);
}

// Violated rows wait for another round, the others are watched.
bool DantzigSolver::Engine::FindViolations() {
  q_ = SetViolatedApart();
  return q_ < open_;
}

PivotBase::End DantzigSolver::Engine::Run(LcpResult* result) {
  End end = EnterStart(result);
  q_ = violated_;
  if (end == End::kDone && q_ == m() && options_.order == DantzigOrder::kMostNegative) FindViolations();
  for (int round = 0; round < kMaxRounds && end == End::kDone; ++round) {
    end = DriveAll(result);
    if (end != End::kDone) break;
    if (SolveForces(round == 0 ? Leaving::kAllAndTiny : Leaving::kOneByOne) && FindViolations()) continue;
    const double tier_before = judge_.tier();
    if (Publish(result)) break;
    if (round > 0 && !(judge_.tier() < tier_before)) break;
    Refine();
    if (Publish(result)) break;
    SolveForces(Leaving::kOneByOne);
    if (!FindViolations()) break;
  }
  if (end != End::kDone) PublishUnfinished(end, result);
  return Conclude(end);
}

DantzigOptions DantzigOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("dantzig", settings);
  DantzigOptions options;
  options.rank_tolerance =
      reader.Number("rank_tolerance", options.rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  options.max_rows = static_cast<Index>(reader.Number("max_rows", static_cast<double>(options.max_rows), 1, 1e5));
  if (reader.Choice("order", "index", {"index", "most-negative"}) == "most-negative") {
    options.order = DantzigOrder::kMostNegative;
  }
  options.block_start = reader.YesOrNo("block_start", options.block_start);
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

DantzigSolver::DantzigSolver(DantzigOptions options)
    : max_rows_(options.max_rows), engine_(std::make_unique<Engine>(options)) {}
DantzigSolver::~DantzigSolver() = default;

std::string DantzigSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > max_rows_) {
    return std::to_string(problem.size()) + " rows are more than max_rows = " + std::to_string(max_rows_) +
           " of this dense solver";
  }
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric";
}

void DantzigSolver::Reserve(Index max_rows) { engine_->Reserve(max_rows); }

void DantzigSolver::DoPrepare(const LcpProblem& problem) { engine_->Prepare(problem); }

void DantzigSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(problem, options, result);
}

}  // namespace lcpbench
