#pragma once

#include "solvers/bpp.h"

namespace lcpbench {

struct ActiveSetOptions {
  BppOptions method = Defaults();
  static BppOptions Defaults();

  /// Keys `proximal`, `largest_proximal` and `patience`, as BppOptions. @throws InputError for others
  static ActiveSetOptions FromSettings(const Settings& settings);
};

/// Primal-dual active set method for large sparse problems: block principal pivoting with a proximal outer loop,
/// exactly as BppSolver, on a factor through the bodies that is updated where few rows change sides
/// (BodyActiveBlock).
class ActiveSetSolver final : public LcpSolver {
 public:
  explicit ActiveSetSolver(ActiveSetOptions options = {}) : method_(options.method) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override { return method_.WhyUnsupported(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override { method_.Prepare(problem); }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    method_.Solve(problem, options, result);
  }

 private:
  BppSolver method_;
};

}  // namespace lcpbench
