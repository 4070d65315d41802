#include "solvers/dantzig.h"

namespace lcpbench {

DantzigOptions DantzigOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("dantzig", settings);
  reader.Finish();
  return {};
}

void DantzigSolver::DoPrepare(const LcpProblem& /*problem*/) { static_cast<void>(options_); }
void DantzigSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) {
  result->status = LcpStatus::kUnsupported;
}

}  // namespace lcpbench
