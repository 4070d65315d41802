#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// The order in which a sweep visits the rows.
enum class SweepOrder {
  kForward,    ///< as given
  kSymmetric,  ///< as given and backwards in turn
  kColoured,   ///< blocks of rows as given, within a block colour by colour: rows of one colour share no body
               ///< (assembled: no entry of A), and are stepped by fours without waiting for each other; matrix-free
               ///< rows on more than two bodies: as given
};

/// Options of PgsSolver.
struct PgsOptions {
  static constexpr std::int64_t kDefaultSweeps = 20000;  ///< limit where max_iterations is 0
  /// Default `relaxation` of psor: loses least over the scenes, short chains and long ones.
  static constexpr double kFirstOfAdaptive = 1.6;

  RowForm form = RowForm::kAuto;  ///< assembled rows, or matrix-free
  /// Coloured sweeps converge like forward ones and take less than half the time.
  SweepOrder sweep = SweepOrder::kColoured;
  /// omega in (0, 2), constant or of the first sweeps (there at most 1 on up to six rows); 1 is Gauss-Seidel.
  double relaxation = 1.0;
  bool adaptive = false;  ///< omega follows the measured rate of convergence: `psor`
  /// As in NncgOptions.
  bool end_when_hopeless = false;

  /// Options `form` = auto | assembled | matrix-free, `sweep` = forward | symmetric | coloured, and `relaxation`, in
  /// whose place adaptive ones have `first_relaxation`.
  void Read(SettingsReader* reader);
};

/// Projected Gauss-Seidel with a relaxation, constant (`pgs`) or adaptive (`psor`). One sweep visits the rows in turn:
///     w_i = (A f + b)_i with the newest f,    f_i <- f_i - omega w_i / A_ii,    f_i <- max(0, f_i) on unilateral rows.
/// A row with A_ii = 0 keeps f_i = 0 (for PSD A the whole row is 0 then, so w_i = b_i and the row is consistent or the
/// problem is not).
///
/// Adaptive: for a linear system with consistently ordered A (a chain, say), the per-sweep rate lambda of SOR at an
/// omega below the best one obeys (lambda + omega - 1)^2 = lambda omega^2 mu^2, mu the spectral radius of Jacobi's
/// method, and the best omega is 2 / (1 + sqrt(1 - mu^2)) [Young 1971, sec. 6.2; Hageman, Young 1981, ch. 9]. The norm
/// of the steps over eight sweeps gives lambda, lambda gives mu, mu gives the next omega. At or above the best omega
/// the rate is about omega - 1 and tells nothing of mu: then omega goes back towards 1 by a tenth.
///
/// Matrix class. Symmetric PSD with omega in (0, 2): each step lowers the energy 1/2 f.A f + b.f, and w converges
/// wherever the problem is solvable. The rate is linear at best and has no useful bound: with omega = 1 expect sweeps
/// in proportion to the square of the longest chain of bodies. A nonsymmetric A is taken by the assembled form without
/// any promise; a negative A_ii is refused. On an infeasible problem f grows without bound, and the solve ends at its
/// limit.
///
/// Unit of `iterations`: sweeps, a symmetric pair counts twice; default limit kDefaultSweeps. Warm start: initial_f,
/// clipped at 0. Cost of a sweep: one multiply-add per entry of A, or 12 per two-body row. Memory: A, or J.
///
/// Stopping (solvers/first_order/first_order_engine.h): rho of the scaled problem at every 32nd sweep and where
/// steps look small enough; kSolved only after rho and the backward error pass by the given form in extended precision.
///
/// A failure leaves in f the iterate of least rho among those checked. Stagnation ends as kIterationLimit or
/// kTimeLimit, overflow as kNumericalFailure. The clock is read about every 20 us, so also within a sweep. Solve
/// allocates nothing once prepared. SolveArrays sweeps rows on two bodies without an LcpProblem, unless `form` is
/// assembled, and allocates only where it has met no problem as large; from few rows its clock starts some 20 us late.
///
/// Friction, sliding and bounded rows are taken, for symmetric A (contact_sweeps.h): a contact at a time, its normal
/// and friction row solved together, in the given order whatever `sweep` and `form`. Then nothing is guaranteed, cycles
/// among it; what is claimed passes the verifier's own measures.
///
/// [Cottle, Pang, Stone, The Linear Complementarity Problem, sec. 5.3; Cryer 1971 for the relaxation and its
/// convergence; matrix-free rows as in Tonge, Benevolenski, Voroshilov 2012.] More: docs/solvers/first_order.md.
using PgsSolver = EngineSolver<PgsOptions, class PgsEngine>;
extern template class EngineSolver<PgsOptions, PgsEngine>;

}  // namespace lcpbench
