#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "solvers/active_set/bpp.h"
#include "solvers/active_set/semismooth_newton.h"
#include "solvers/auto/auto_rules.h"
#include "solvers/auto/hybrid.h"
#include "solvers/first_order/nncg.h"
#include "solvers/first_order/pgs.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/pivoting/dantzig.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/interior_point/ipm.h"
#endif

namespace lcpbench {

/// The methods of AutoStage::kBackends: solvers of LcpProblems, each one starting from what the one before it reached.
/// Internal to solvers/.
///
/// The facts that the rules ask for are predictions from the structure. A method that would need more memory than there
/// is refuses (MemoryRefusal), and the next one is asked. Where none arrives, the answer is the point of least rho that
/// any of them ended at. Iterations, and their limit, are those of all methods that were asked, each in its own unit.
class AutoPortfolio {
 public:
  explicit AutoPortfolio(const HybridOptions& hybrid);  ///< the rules of HybridSolver alone
  explicit AutoPortfolio(const AutoLimits& limits);

  /// The facts that need no set-up.  O(nnz J log)
  void Classify(const LcpProblem& problem);
  /// All facts, and set-up of the methods that come first. `problem` has at least one row. Without it,
  /// facts().tableau_failed must be set.
  void Prepare(const LcpProblem& problem);
  /// As LcpSolver::DoSolve; `deadline` began with the solve, and options.time_limit_s is not looked at. Appends to
  /// result->detail. result->f holds what was reached before, or 0: it stays where nothing better is found.
  void Solve(const LcpProblem& problem, const LcpOptions& options, const Deadline& deadline, LcpResult* result);

  /// HybridSolver's.
  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    Solve(problem, options, Deadline(options), result);
  }
  const IpmStatistics& statistics() const;

  AutoFacts& facts() { return facts_; }  ///< of the problem; those of other stages are the caller's

 private:
  AutoPortfolio(const HybridOptions& hybrid, const AutoLimits& limits, bool is_hybrid);
  void PrepareHybrid(const LcpProblem& problem);
  bool TryMethod(AutoMethod method, std::int64_t granted, LcpResult* result);
  bool TrySweeps(LcpSolver* solver, std::string_view name, std::int64_t granted, LcpResult* result);
  bool TryBpp(std::int64_t granted, LcpResult* result);
  bool TryFromStart(LcpSolver* solver, std::string_view name, std::int64_t granted, LcpResult* result);
  bool TryGuess(std::string_view name, LcpResult* result);
  bool RunBackend(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result);
  void StartAt(const Eigen::VectorXd* f);
  void Remember(const Eigen::VectorXd& f);
  void TakeTheBest(LcpResult* result);

  AutoFacts facts_;
  const HybridOptions hybrid_;
  const AutoLimits limits_;
  const bool is_hybrid_;

  PgsSolver psor_;
  NncgSolver nncg_;
  NncgSolver patient_nncg_;
  NncgSolver hybrid_nncg_;
  BppSolver bpp_;
  SemismoothNewtonSolver newton_;
#ifdef LCPBENCH_WITH_SUITESPARSE
  IpmSolver ipm_;
#endif
  DantzigSolver dantzig_;
  GivenFormTest test_;

  // One call.
  const LcpProblem* problem_ = nullptr;
  const LcpOptions* options_ = nullptr;
  const Deadline* deadline_ = nullptr;
  Eigen::VectorXd start_;  // where the next backend starts
  std::int64_t iterations_ = 0;
  // Where backends ended that did not arrive: the first `reached_count_`.
  std::vector<Eigen::VectorXd> reached_;
  std::size_t reached_count_ = 0;
};

}  // namespace lcpbench
