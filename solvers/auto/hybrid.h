#pragma once

#include "solvers/auto/auto_limits.h"
#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

struct IpmStatistics;  // solvers/interior_point/ipm.h

/// Options of HybridSolver.
struct HybridOptions {
  /// Iterations that the sweeps take in any case, as the interior point starts better from them, in [0, 100000].
  int least_iterations = static_cast<int>(kDefaultLimits.hybrid_least_sweeps);
  /// Iterations that they may take while their rate of convergence promises an answer within them, in [0, 100000]: at
  /// 10^5 rows of a pile about four factorizations. 0: the interior point at once.
  int most_iterations = static_cast<int>(kDefaultLimits.hybrid_most_sweeps);

  /// Names: least_iterations, most_iterations.
  void Read(SettingsReader* reader);
};

/// First-order, then second-order: nonsmooth conjugate gradients (NncgSolver) for as long as they promise to be
/// cheaper, then active sets and the interior point (IpmSolver) from where they stopped. These are rules of AutoSolver,
/// asked alone (docs/solvers/auto.md).
///
/// Sweeps cost a hundredth of a factorization at 10^5 rows. On ovals and loose piles they arrive; where redundant
/// contacts or long chains make them stall they still find most of the active set and four digits, which spares the
/// interior point its first steps. Where the rate flattens is measured: the sweeps end as soon as the present rate
/// would not reach the tolerance within most_iterations (StoppingTest::EndWhenHopeless), after least_iterations at
/// the earliest. Above 20 000 rows the interior point is set up only where it is needed: ordering takes longer than 50
/// sweeps.
///
/// Trees and chains of bodies need no case of their own: minimum degree eliminates them from the leaves without fill
/// (tests/solvers/linear_algebra/body_space_test.cc), in either space.
///
/// Guaranteed class, failures, certificates: as IpmSolver, which has the last word. Unit of `iterations`: the steps of
/// both, sweeps and factorizations; statistics() tells them apart. Limits hold for both together. Problems of less than
/// 500 rows go to the interior point at once.
/// Warm start: where a factorization takes no longer than 17 sweeps, the active set of initial_f first (IpmSolver), as
/// far as that is done in the time of 90 sweeps; then the sweeps, from the best iterate. A start whose rho is at least
/// half that of f = 0 is passed over. Departures: none; the two methods are used as they are.
class HybridSolver final : public EngineSolver<HybridOptions, class AutoPortfolio> {
 public:
  using EngineSolver::EngineSolver;

  /// Statistics of the interior point, in the latest Prepare and Solve.
  const IpmStatistics& statistics() const;
};
extern template class EngineSolver<HybridOptions, AutoPortfolio>;

}  // namespace lcpbench
