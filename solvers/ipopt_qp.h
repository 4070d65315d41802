#pragma once

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct IpoptQpOptions {
  static IpoptQpOptions FromSettings(const Settings& settings);
};

/// Convex QP through Ipopt.
class IpoptQpSolver final : public LcpSolver {
 public:
  explicit IpoptQpSolver(IpoptQpOptions options = {}) : options_(options) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  IpoptQpOptions options_;
};

}  // namespace lcpbench
