#include "solvers/ipopt_qp.h"

namespace lcpbench {

IpoptQpOptions IpoptQpOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("ipopt_qp", settings);
  reader.Finish();
  return {};
}

void IpoptQpSolver::DoPrepare(const LcpProblem& /*problem*/) { static_cast<void>(options_); }
void IpoptQpSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) {
  result->status = LcpStatus::kUnsupported;
}

}  // namespace lcpbench
