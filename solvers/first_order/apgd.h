#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of ApgdSolver.
struct ApgdOptions {
  static constexpr std::int64_t kDefaultIterations = 20000;  ///< limit where max_iterations is 0
  /// The factor of the estimated Lipschitz constant per iteration, so that steps grow again where the curvature met is
  /// small ...
  static constexpr double kDecay = 0.98;
  /// ... and at least, after a step that was too long for its own curvature.
  static constexpr double kGrowth = 1.5;
  /// Above the curvature of that step: the next one often goes the same way, and must not hang on rounding.
  static constexpr double kMargin = 1.02;
  /// It stays at or above this (and at or below n): along directions without curvature steps need not grow for ever.
  static constexpr double kLeast = 0.1;

  RowForm form = RowForm::kAuto;  ///< assembled rows, or matrix-free
  /// Give up the momentum where it points uphill. Without it the bound below holds for the iterates of one run, with it
  /// the iterates stop circling the solution: on the scenes a quarter to a tenth of the iterations.
  bool restart = true;

  /// Options `form` = auto | assembled | matrix-free and `restart` = yes | no.
  void Read(SettingsReader* reader);
};

/// Accelerated projected gradient descent (Nesterov) on the Jacobi-scaled problem. From the iterates x_k, x_{k-1},
///     y = x_k + (t_k - 1) / t_{k+1} (x_k - x_{k-1}),    x_{k+1} = P(y - w(y) / L),
///     t_{k+1} (t_{k+1} - 1) = t_k^2 L_{k+1} / L_k,
/// with P the projection onto f >= 0 on unilateral rows. L estimates the largest eigenvalue A need be given: it shrinks
/// by kDecay per iteration, and where the step d = x_{k+1} - y has d.A d > L d.d it grows to kMargin d.A d / d.d, by
/// kGrowth at least, and the step is made again; it stays between kLeast and n, the trace of A, which is no less than
/// the eigenvalue whatever rounding says of d. Restart: t = 1 where (y - x_{k+1}).(x_{k+1} - x_k) > 0.
///
/// Matrix class: symmetric PSD; a numerically nonsymmetric A is refused. Without restart the energy obeys
///     E(x_k) - E* <= 2 kGrowth lambda_max |x_0 - x*|^2 / k^2
/// in the scaled variables, lambda_max that of D^-1/2 A D^-1/2 (at most the largest number of rows of A that one row
/// meets); with restart that holds from restart to restart, and convergence is linear in practice. Not monotone: the
/// iterate of least rho among those checked is kept.
///
/// Unit of `iterations`: steps that were taken (repeated ones count once); default limit kDefaultIterations.
///
/// Cost of an iteration: one pass over the rows (assembled: one product with A) and four over vectors. No row waits for
/// another, so the rows are laid out in colours always.
///
/// Stopping, failures, warm start, clock, allocation: as pgs.
///
/// [Mazhar, Heyn, Negrut, Tasora, Using Nesterov's method to accelerate multibody dynamics with friction and contact,
/// ACM Transactions on Graphics 34(3), 2015; restart: O'Donoghue, Candes 2015; t with varying L: Scheinberg, Goldfarb,
/// Bai 2014.] Departures: docs/solvers/first_order.md.
using ApgdSolver = EngineSolver<ApgdOptions, class ApgdEngine>;
extern template class EngineSolver<ApgdOptions, ApgdEngine>;

}  // namespace lcpbench
