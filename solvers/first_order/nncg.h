#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of NncgSolver.
struct NncgOptions {
  static constexpr std::int64_t kDefaultIterations = 30000;  ///< limit where max_iterations is 0

  /// How the sweep's step and the previous step are combined.
  enum class Direction {
    kOptimal,         ///< least energy over the plane of the sweep's step and the previous step
    kFletcherReeves,  ///< the published rule, without a line search
  };
  /// Measured: the optimal one needs about 60 % of the iterations of the published one, and its energy never rises.
  Direction direction = Direction::kOptimal;
  RowForm form = RowForm::kAuto;  ///< assembled rows, or matrix-free
  /// Forward and backward over the rows as given, or over the coloured order (RowWork). Measured:
  /// coloured takes 5 to 40 % more iterations, each in half the time.
  bool coloured = true;
  /// Ends with kIterationLimit as soon as the rate of convergence so far predicts that max_iterations will not do, for
  /// callers that have another method at hand.
  bool end_when_hopeless = false;
  /// Iterations that end_when_hopeless waits before it looks at the rate, and leaves out of it.
  std::int64_t least_iterations = 0;

  /// Options `direction` = optimal | fletcher-reeves, `form` = auto | assembled | matrix-free, `sweep` = symmetric |
  /// coloured.
  void Read(SettingsReader* reader);
};

/// Nonsmooth nonlinear conjugate gradients on symmetric projected Gauss-Seidel sweeps. A sweep forward and backward
/// takes x to y; its step is z = y - x. The iterate then moves on along z and the previous step p:
///     optimal:          x' = P(x + alpha z + beta p), (alpha, beta) least for the energy 1/2 f.A f + b.f; where the
///                       projection P onto f >= 0 cuts something off, the point of least energy between y and it
///     Fletcher-Reeves:  x' = P(y + beta p), beta = |z|^2 / |z of the previous iteration|^2, and beta = 0 (restart) if
///                       that is above 1.
/// Either way the previous step is forgotten again and again once projections keep the residual from falling.
///
/// Matrix class: symmetric PSD. Optimal: the energy after an iteration is at most that of the sweep alone, so w
/// converges wherever the problem is solvable, as for pgs; a numerically nonsymmetric A is refused. Sweeps in
/// proportion to the longest chain of bodies, not to its square. Infeasible problems end at a limit.
///
/// Unit of `iterations`: one symmetric sweep (two sweeps of pgs) with its step; default limit kDefaultIterations.
/// Cost of an iteration: two sweeps, five passes over vectors of n rows and of 4 numbers per body (together about as
/// much as another sweep), and one product per row that the projection cuts off. Assembled: one product with A more.
/// Stopping, failures, warm start, clock, allocation: as pgs.
///
/// [Silcowitz, Niebe, Erleben, Nonsmooth Newton and nonlinear conjugate gradient methods for interactive contact force
/// problems: VRIPHYS 2009; The Visual Computer 2010.] Departures: docs/solvers/first_order.md.
using NncgSolver = EngineSolver<NncgOptions, class NncgEngine>;
extern template class EngineSolver<NncgOptions, NncgEngine>;

}  // namespace lcpbench
