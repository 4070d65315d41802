#include "solvers/pgs.h"

#include <string>

#include "solvers/lcp/input_error.h"
#include "solvers/sweeps/row_work.h"
#include "solvers/sweeps/stopping_test.h"
#include "solvers/sweeps/sweep_loop.h"

namespace lcpbench {
namespace {

void CheckRelaxation(double relaxation) {
  if (!(relaxation > 0 && relaxation < 2)) {
    throw InputError("pgs: option 'relaxation' must be in (0, 2), found " + std::to_string(relaxation));
  }
}

struct ConstantRelaxation {
  double omega;
  double Next() const { return omega; }
  void Observe(const StepSums& /*sums*/) const {}
};

}  // namespace

struct PgsSolver::Workspace {
  RowWork rows;
  StoppingTest test;
};

PgsOptions PgsOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("pgs", settings);
  PgsOptions options;
  options.form = ReadRowForm(&reader);
  options.sweep = ReadSweepOrder(&reader);
  options.relaxation = reader.Number("relaxation", options.relaxation, 0.0, 2.0);
  reader.Finish();
  CheckRelaxation(options.relaxation);
  return options;
}

PgsSolver::PgsSolver(PgsOptions options) : options_(options), work_(std::make_unique<Workspace>()) {
  CheckRelaxation(options.relaxation);
}
PgsSolver::~PgsSolver() = default;

std::string PgsSolver::WhyUnsupported(const LcpProblem& problem) const { return WhyNoRows(problem, options_.form); }

void PgsSolver::DoPrepare(const LcpProblem& problem) {
  work_->rows.Prepare(problem, options_.form, options_.sweep == SweepOrder::kColoured);
  work_->test.Prepare(problem);
}

void PgsSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) {
  work_->rows.Start(options.initial_f);
  ConstantRelaxation relaxation{options_.relaxation};
  SolveBySweeps(options_.sweep, options, kDefaultSweeps, &relaxation, &work_->rows, &work_->test, result);
}

}  // namespace lcpbench
