#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Asks solvers in turn, judges each answer by rho and backward error, in double, and answers with the first one that
/// passes, else with that of the least rho. A turn has what is left of the time limit. `kSolved` says that the answer
/// passes. All of it is on the clock. A turn that ends at its time limit is the last. Where the first solver refuses
/// the problem or claims that it has no solution, that is the answer.
class SolversInTurn : public LcpSolver {
 public:
  /// A solver and what it is asked.
  struct Turn {
    std::shared_ptr<LcpSolver> solver;  ///< may have several turns
    /// It is asked A + s I, s being `shift` times the largest diagonal entry of A. From factors that are n more columns
    /// of J, so that the problem keeps its form; it no longer shows which bodies a row joins. 0: the problem.
    double shift = 0;
  };
  explicit SolversInTurn(std::vector<Turn> turns) : turns_(std::move(turns)) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return turns_.front().solver->WhyUnsupported(problem);
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override { turns_.front().solver->Prepare(problem); }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override;

 private:
  template <typename Given>
  void SolveInTurn(const Given& given, const LcpOptions& options, LcpResult* result);
  // Whether f passes; rho is written.
  static bool Passes(const LcpProblem& problem, double tolerance, const Eigen::VectorXd& f, double* rho);
  bool Passes(const ProblemArrays& arrays, double tolerance, const Eigen::VectorXd& f, double* rho);

  std::vector<Turn> turns_;
  Eigen::VectorXd velocity_;  // by column of J
};

}  // namespace lcpbench
