#include "solvers/lemke.h"

#include <limits>

#include "solvers/lemke_engine.h"

namespace lcpbench {
namespace {

// Paths after the first are repairs; each must improve the residual.
constexpr int kMaxPaths = 10;

}  // namespace

void LemkeSolver::Engine::Reserve(Index max_rows) {
  if (max_rows <= rate_.size()) return;
  PivotBase::Reserve(max_rows);
  for (Eigen::VectorXd* v : {&cover_, &perturbation_, &rate_, &y_, &first_order_, &work_}) v->setZero(max_rows);
  ties_.reserve(static_cast<size_t>(max_rows));
}

PivotBase::End LemkeSolver::Engine::Run(LcpResult* result) {
  End end = EnterStart(result);
  const Index in_play = open_;
  for (int path = 0; path < kMaxPaths && end == End::kDone; ++path) {
    open_ = in_play;
    const double violation = ComputeGaps();
    if (path > 0 && violation == 0) break;
    if (violation > 0) end = FollowPath(violation, result);
    if (end != End::kDone) break;
    SolveForces(path == 0 ? Leaving::kAll : Leaving::kOneByOne);
    const double tier_before = judge_.tier();
    if (Publish(result)) break;
    if (path > 0 && !(judge_.tier() < tier_before)) break;
    Refine();
    if (Publish(result)) break;
    SolveForces(Leaving::kOneByOne);
  }
  if (end != End::kDone) PublishUnfinished(end, result);
  return Conclude(end);
}

LemkeOptions LemkeOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("lemke", settings);
  LemkeOptions options;
  options.rank_tolerance =
      reader.Number("rank_tolerance", options.rank_tolerance, std::numeric_limits<double>::epsilon(), 1e-3);
  options.max_rows = static_cast<Index>(reader.Number("max_rows", static_cast<double>(options.max_rows), 1, 1e5));
  options.block_start = reader.YesOrNo("block_start", options.block_start);
  options.self_check = reader.SelfCheck();
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

void LemkeSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  engine_->Solve(problem, options, result);
}

}  // namespace lcpbench
