#include "solvers/ipopt_ncp.h"

namespace lcpbench {

IpoptNcpOptions IpoptNcpOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("ipopt_ncp", settings);
  reader.Finish();
  return {};
}

void IpoptNcpSolver::DoPrepare(const LcpProblem& /*problem*/) { static_cast<void>(options_); }
void IpoptNcpSolver::DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) {
  result->status = LcpStatus::kUnsupported;
}

}  // namespace lcpbench
