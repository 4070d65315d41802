#pragma once

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct IpoptNcpOptions {
  static IpoptNcpOptions FromSettings(const Settings& settings);
};

/// Complementarity formulation through Ipopt.
class IpoptNcpSolver final : public LcpSolver {
 public:
  explicit IpoptNcpSolver(IpoptNcpOptions options = {}) : options_(options) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  IpoptNcpOptions options_;
};

}  // namespace lcpbench
