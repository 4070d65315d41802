#pragma once

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct SuitesparseOptions {
  static SuitesparseOptions FromSettings(const Settings& settings);
};

/// Sparse method on CHOLMOD.
class SuitesparseSolver final : public LcpSolver {
 public:
  explicit SuitesparseSolver(SuitesparseOptions options = {}) : options_(options) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  SuitesparseOptions options_;
};

}  // namespace lcpbench
