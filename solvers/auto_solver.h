#pragma once

#include <cstdint>
#include <memory>

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct AutoOptions {
  /// Up to this many rows a dense tableau is tried first; in [0, SmallPivoting::kMaxRows].
  Index tableau_rows = 48;
  /// Factorisations that the semismooth Newton method is granted, >= 1; problems up to 10^3 rows need 10 to 70.
  std::int64_t newton_factorisations = 150;

  /// Keys `tableau_rows` and `newton_factorisations`. @throws InputError for others
  static AutoOptions FromSettings(const Settings& settings);
};

/// Chooses among our own backends by the problem, checks the answer, and asks the next one where it is not right.
///
/// Order: 1. up to tableau_rows rows and without a warm start, principal pivoting on a dense tableau (SmallPivoting);
/// 2. the proximal semismooth Newton method on sparse factors (SemismoothNewtonSolver), for all sizes; 3. the sparse
/// interior point method (SuitesparseSolver, where it is in the build), whose number of factorisations hardly depends
/// on the problem; 4. Dantzig pivoting (DantzigSolver) up to its max_rows. A backend is left when its f does not pass,
/// by rho and backward error of the problem, and it brings no proof of infeasibility either. kSolved is claimed only
/// for an f that passed: in double with a wide margin after the tableau, in extended precision by the given form after
/// the others.
///
/// LcpResult::detail says which backend answered, and which ones failed before it. `iterations` are those of the one
/// that answered, in its unit. Guaranteed class: symmetric positive semidefinite A of any rank, as its backends;
/// nonsymmetric A is refused. A failure leaves the last backend's f and status.
///
/// Set-up covers the first backend for the size; a later one, rarely needed, prepares within the solve. Limits are the
/// backends' own, the time limit is shared. Solve does not allocate unless a later backend is asked.
class AutoSolver final : public LcpSolver {
 public:
  explicit AutoSolver(AutoOptions options = {});
  ~AutoSolver() override;

  std::string WhyUnsupported(const LcpProblem& problem) const override;
  void Reserve(Index max_rows) override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  struct Backends;
  AutoOptions options_;
  std::unique_ptr<Backends> backends_;
};

}  // namespace lcpbench
