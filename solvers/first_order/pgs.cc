#include "solvers/first_order/pgs.h"

#include <string>

#include "solvers/first_order/sweeps/sweep_loop.h"

namespace lcpbench {
namespace {

struct ConstantRelaxation {
  double omega;
  double Next() const { return omega; }
  void Observe(const StepSums& /*sums*/) const {}
};

}  // namespace

struct PgsSolver::Workspace : SweepWorkspace {};

PgsOptions PgsOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("pgs", settings);
  PgsOptions options;
  options.form = ReadRowForm(&reader);
  options.sweep = ReadSweepOrder(&reader);
  options.relaxation = reader.Number("relaxation", options.relaxation, 0.0, 2.0);
  options.self_check = reader.SelfCheck();
  reader.Finish();
  CheckRelaxation("pgs", "relaxation", options.relaxation);
  return options;
}

PgsSolver::PgsSolver(PgsOptions options) : options_(options), work_(std::make_unique<Workspace>()) {
  work_->test.SetSelfCheck(options.self_check);

  CheckRelaxation("pgs", "relaxation", options.relaxation);
}
PgsSolver::~PgsSolver() = default;

std::string PgsSolver::WhyUnsupported(const LcpProblem& problem) const { return WhyNoRows(problem, options_.form); }

void PgsSolver::DoPrepare(const LcpProblem& problem) { work_->Prepare(problem, options_.form, options_.sweep); }

void PgsSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  ConstantRelaxation relaxation{options_.relaxation};
  work_->Solve(problem, options_.sweep, options, kDefaultSweeps, &relaxation, result);
}

}  // namespace lcpbench
