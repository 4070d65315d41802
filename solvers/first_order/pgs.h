#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of PgsSolver.
struct PgsOptions {
  static constexpr std::int64_t kDefaultSweeps = 20000;  ///< limit where max_iterations is 0

  using Form = RowForm;     ///< assembled rows, or matrix-free
  Form form = Form::kAuto;  ///< by predicted time

  /// Coloured sweeps converge like forward ones and take less than half the time.
  SweepOrder sweep = SweepOrder::kColoured;

  double relaxation = 1.0;  ///< omega in (0, 2); 1 is Gauss-Seidel
  bool self_check = true;   ///< SettingsReader::SelfCheck

  /// Options `form` = auto | assembled | matrix-free, `sweep` = forward | symmetric | coloured, `relaxation` and
  /// `self_check`.
  static PgsOptions FromSettings(const Settings& settings);
};

/// Projected Gauss-Seidel, with a constant relaxation. One sweep visits the rows in turn and sets
///     w_i = (A f + b)_i with the newest f,    f_i <- f_i - omega w_i / A_ii,    f_i <- max(0, f_i) on unilateral rows.
/// A row with A_ii = 0 keeps f_i = 0 (for PSD A the whole row is 0 then, so w_i = b_i and the row is consistent or the
/// problem is not).
///
/// Matrix class. Symmetric PSD with omega in (0, 2): each step lowers the energy 1/2 f.A f + b.f, and w converges
/// wherever the problem is solvable. The rate is linear at best and has no useful bound: expect sweeps in proportion to
/// the square of the longest chain of bodies. A nonsymmetric A is taken by the assembled form without any promise;
/// a negative A_ii is refused. On an infeasible problem f grows without bound, and the solve ends at its limit.
///
/// Unit of `iterations`: sweeps, a symmetric pair counts twice; default limit kDefaultSweeps. Warm start: initial_f,
/// clipped at 0. Cost of a sweep: one multiply-add per entry of A, or 12 per two-body row. Memory: A, or J.
///
/// Stopping: solvers/first_order/sweeps/stopping_test.h. rho of the scaled problem at every 32nd sweep and where steps
/// look small enough; kSolved only after rho and the backward error pass by the given form in extended precision.
///
/// A failure leaves in f the iterate of least rho among those checked. Stagnation ends as kIterationLimit or
/// kTimeLimit, overflow as kNumericalFailure. The clock is read about every 20 us, so also within a sweep. Solve
/// allocates nothing once prepared.
///
/// [Cottle, Pang, Stone, The Linear Complementarity Problem, sec. 5.3; Cryer 1971 for the relaxation and its
/// convergence; matrix-free rows as in Tonge, Benevolenski, Voroshilov 2012.] More: docs/solvers/first_order.md.
using PgsSolver = EngineSolver<PgsOptions, class PgsEngine>;
extern template class EngineSolver<PgsOptions, PgsEngine>;

}  // namespace lcpbench
