#pragma once

#include <cstdint>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of PsorSolver.
struct PsorOptions {
  static constexpr std::int64_t kDefaultSweeps = 20000;  ///< limit where max_iterations is 0

  RowForm form = RowForm::kAuto;  ///< assembled rows, or matrix-free
  /// As in PgsOptions.
  SweepOrder sweep = SweepOrder::kColoured;

  /// omega of the first sweeps, in (0, 2), before anything is measured: the constant that loses least over the scenes,
  /// short chains and long ones.
  double first_relaxation = 1.6;
  /// As in NncgOptions.
  bool end_when_hopeless = false;
  bool self_check = true;  ///< SettingsReader::SelfCheck

  /// Options `form`, `sweep`, `first-relaxation` `end-when-hopeless` = yes | no and `self_check`.
  static PsorOptions FromSettings(const Settings& settings);
};

/// Projected SOR whose relaxation omega follows the measured rate of convergence. The sweeps are those of PgsSolver
/// (solvers/first_order/pgs.h), with one omega per sweep.
///
/// For a linear system with consistently ordered A (a chain, say), the per-sweep rate lambda of SOR at an omega below
/// the best one obeys (lambda + omega - 1)^2 = lambda omega^2 mu^2, mu the spectral radius of Jacobi's method, and the
/// best omega is 2 / (1 + sqrt(1 - mu^2)) [Young 1971, sec. 6.2; adaptively: Hageman, Young 1981, ch. 9]. The norm of
/// the steps over eight sweeps gives lambda, lambda gives mu, mu gives the next omega. At or above the best omega the
/// rate is about omega - 1 and tells nothing of mu: then omega goes back towards 1 by a tenth.
///
/// Matrix class: as pgs; omega stays within (0, 2), so no sweep raises the energy. Unit of `iterations`, cost,
/// stopping, failures, warm start, clock: as pgs. More: docs/solvers/first_order.md.
using PsorSolver = EngineSolver<PsorOptions, class PsorEngine>;
extern template class EngineSolver<PsorOptions, PsorEngine>;

}  // namespace lcpbench
