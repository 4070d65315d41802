#include "solvers/suitesparse.h"

namespace lcpbench {

SuitesparseOptions SuitesparseOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("suitesparse", settings);
  reader.Finish();
  return {};
}

void SuitesparseSolver::DoPrepare(const LcpProblem& /*problem*/) { static_cast<void>(options_); }
void SuitesparseSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) {
  result->status = LcpStatus::kUnsupported;
}

}  // namespace lcpbench
