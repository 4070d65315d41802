#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "solvers/active_set/bpp.h"
#include "solvers/active_set/semismooth_newton.h"
#include "solvers/first_order/nncg.h"
#include "solvers/first_order/pgs.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/pivoting/dantzig.h"
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/interior_point/hybrid.h"
#endif

namespace lcpbench {

/// What AutoSolver asks for problems that are too large for a tableau: backends in the order of what they are predicted
/// to cost, each one starting from what the one before it reached. Internal to solvers/.
///
/// Predictions come from the structure; docs/solvers/auto.md says which backend comes when. One that would need more
/// memory than there is refuses (MemoryRefusal), and the next one is asked. Where none arrives, the answer is the point
/// of least rho that any of them ended at.
class AutoPortfolio {
 public:
  AutoPortfolio(std::int64_t newton_factorizations, bool self_check);

  enum class Choice {
    kByCost,
    kRobust,  ///< the Newton method at once: something has shown that the problem is not an easy one
  };

  /// Above kSmallRows, and not given as a dense matrix.
  static bool IsLarge(const LcpProblem& problem);
  /// What suits_tableau tells before any set-up.  O(nnz J)
  void Classify(const LcpProblem& problem);
  /// Set-up of the backends that come first; not needed for Choice::kRobust. `problem` has at least one row.
  void Prepare(const LcpProblem& problem);
  /// As LcpSolver::DoSolve; `deadline` began with the solve, and options.time_limit_s is not looked at. Appends to
  /// result->detail. result->f holds what was reached before, or 0: it stays where nothing better is found.
  void Solve(const LcpProblem& problem, const LcpOptions& options, Choice choice, const Deadline& deadline,
             LcpResult* result);
  /// From here on `hybrid` is faster than the semismooth Newton method on every redundant family (1e-9, one thread).
  static constexpr Index kSmallRows = 900;

  /// Whether factors of the prepared problem are dense, or rows outnumber degrees of freedom: a tableau does well then
  /// up to larger sizes.
  bool suits_tableau() const { return suits_tableau_; }

 private:
  bool PrepareBpp(const LcpProblem& problem);
  void AskAll(Choice choice, LcpResult* result);
  void Remember(const Eigen::VectorXd& f);
  void TakeTheBest(LcpResult* result);
  std::int64_t NncgLimit(double factorizations, double step_time) const;
  bool TrySweeps(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result);
  bool TryBpp(LcpResult* result);
  bool TryNewton(LcpResult* result);
  bool TryHybrid(LcpResult* result);
  bool Try(LcpSolver* solver, std::string_view name, std::int64_t limit, LcpResult* result);

  std::int64_t newton_factorizations_;
  bool is_redundant_ = false;
  bool is_large_ = false;
  bool has_bpp_ = false;
  bool sweeps_alone_ = false;  // block pivoting is set up only where they do not arrive
  bool suits_tableau_ = false;
  double nncg_time_ = 1;         // of an iteration, nanoseconds
  std::int64_t nncg_limit_ = 0;  // 0: not worth a try
  std::int64_t psor_limit_ = 0;

  PgsSolver psor_;
  NncgSolver nncg_;
  NncgSolver nncg_of_given_;  // of a large sparse A
  BppSolver bpp_;
  SemismoothNewtonSolver newton_;
#ifdef LCPBENCH_WITH_SUITESPARSE
  HybridSolver hybrid_;
#endif
  DantzigSolver dantzig_;
  GivenFormTest test_;

  // One call.
  const LcpProblem* problem_ = nullptr;
  const LcpOptions* options_ = nullptr;
  const Deadline* deadline_ = nullptr;
  Eigen::VectorXd start_;  // where the next backend starts
  bool has_start_ = false;
  // Where backends ended that did not arrive: the first `reached_count_`.
  std::vector<Eigen::VectorXd> reached_;
  std::size_t reached_count_ = 0;
};

}  // namespace lcpbench
