#pragma once

#include <memory>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A solver that takes `factor` times as long as another: after set-up and solve it keeps the processor busy. It shows
/// whether a campaign finds a difference of known size.
class SlowedSolver : public LcpSolver {
 public:
  /// @param factor  >= 1
  SlowedSolver(std::unique_ptr<LcpSolver> solver, double factor);

  std::string WhyUnsupported(const LcpProblem& problem) const override;
  void Reserve(Index max_rows) override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  void WaitSince(double start) const;

  std::unique_ptr<LcpSolver> solver_;
  double factor_;
};

}  // namespace lcpbench
