#pragma once

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct DantzigOptions {
  static DantzigOptions FromSettings(const Settings& settings);
};

/// Baraff's incremental pivoting, dense.
class DantzigSolver final : public LcpSolver {
 public:
  explicit DantzigSolver(DantzigOptions options = {}) : options_(options) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  DantzigOptions options_;
};

}  // namespace lcpbench
