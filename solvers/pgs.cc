#include "solvers/pgs.h"

namespace lcpbench {

PgsOptions PgsOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("pgs", settings);
  reader.Finish();
  return {};
}

void PgsSolver::DoPrepare(const LcpProblem& /*problem*/) { static_cast<void>(options_); }
void PgsSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) {
  result->status = LcpStatus::kUnsupported;
}

}  // namespace lcpbench
