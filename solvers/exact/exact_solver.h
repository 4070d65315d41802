#pragma once

#include <optional>
#include <string>

#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The exact solution, each force rounded to the nearest double; or the exact ray, rounded. Its bits depend on the
/// problem and nothing else: there is no guess in doubles, no native instruction and no random number on the way, and a
/// warm start is ignored. Where f is not unique, it is the one of the active rows that SolveExactly ends with, which
/// are independent. So sequences of problems that it drives are the same on every machine.
///
/// The doubles of redundant rows may contradict themselves by a rounding. Such a problem has an exact ray, which
/// rounding destroys, and any other solver solves it to its tolerance. So does this one:
/// where the exact solution for A + kProximal diag A passes the tolerance asked for, that is the answer, and `detail`
/// says so. Where not, the problem is infeasible.
///
/// max_iterations does not matter, the tolerance to contradictory problems only; the time limit is looked at between
/// exact solves, which end in milliseconds for some tens of rows and in seconds for some hundreds. `iterations` are
/// exact solves with a basis.
/// Takes what SolveExactly takes: factors, or a symmetric positive semidefinite matrix of some 120 rows.
class ExactSolver : public LcpSolver {
 public:
  /// Between the roundings that contradict each other, 2^-53 of the terms, and the tolerances asked for.
  static constexpr double kProximal = 0x1p-40;

  /// @param rounds_together  whether forces of up to 24 rows whose nearest doubles do not pass the tolerance are
  /// replaced
  ///     by doubles nearby that do, if a reduced lattice basis shows some: the errors of rows that are nearly dependent
  ///     then cancel. Their bits may depend on the version of FLINT.
  explicit ExactSolver(bool rounds_together = false) : rounds_together_(rounds_together) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  bool SolveContradiction(const LcpProblem& problem, const LcpOptions& options, double elapsed_s, LcpResult* result);

  const bool rounds_together_;
  std::optional<ExactLcp> exact_;
};

/// The double that is nearest, of two the even one; infinite beyond the range of doubles.
double RoundToNearest(const Rational& value);
Eigen::VectorXd Rounded(const std::vector<Rational>& values);

}  // namespace lcpbench
