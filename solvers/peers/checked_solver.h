#pragma once

#include <memory>
#include <string>
#include <utility>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A solver with the check that ours have: rho of its answer by the given form, and where that is above the tolerance
/// one more solve of A + s I, from which the better answer is taken. `kSolved` then says that rho is within the
/// tolerance. All of it is on the clock.
///
/// s is `shift` times the largest diagonal entry of A. From factors the shift is n more columns of J, so that the
/// problem keeps its form; what bodies a row joins is not seen any more then.
class CheckedSolver : public LcpSolver {
 public:
  static constexpr double kShift = 1e-9;  ///< unless told otherwise: what the engines' users take

  CheckedSolver(std::unique_ptr<LcpSolver> inner, double shift) : inner_(std::move(inner)), shift_(shift) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override { return inner_->WhyUnsupported(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  std::unique_ptr<LcpSolver> inner_;
  double shift_;
};

}  // namespace lcpbench
