#pragma once

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct PgsOptions {
  static PgsOptions FromSettings(const Settings& settings);
};

/// Projected Gauss-Seidel.
class PgsSolver final : public LcpSolver {
 public:
  explicit PgsSolver(PgsOptions options = {}) : options_(options) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  PgsOptions options_;
};

}  // namespace lcpbench
