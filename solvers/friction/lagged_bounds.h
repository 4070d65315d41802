#pragma once

#include <cstdint>

#include "solvers/friction/relaxation.h"

namespace lcpbench {

/// Coulomb friction by a fixed point of its bounds [Haslinger 1983; Panagiotopoulos 1985]: with f_n of the round before
/// (initial_f, or 0) friction rows become bounded ones, |f_t| <= mu f_n, sliding rows f_t = -s mu f_n. Each round is a
/// convex quadratic program with a box, by `auto`, warm started. From a cold start the second round is what engines
/// with `findex` stop after. [docs/friction.md section 1, "fixed bounds"]
///
/// Converges where the bounds contract; one contact: where mu |A_nt| < A_nn. No guarantee else.
///
/// Takes friction rows, any number a contact, sliding and bounded rows; symmetric A. Without friction rows the inner
/// solver is asked once, in its own unit of iterations. kSolved only where f, with friction clipped to its own normal
/// forces, passes by Coulomb's law (ComputeMetrics). kInfeasible: as a round has no solution, with a ray that is 0 on
/// friction rows and that VerifyFarkasRay accepts. kNumericalFailure where kPatience rounds have not lowered the least
/// rho. Unit of iterations and max_iterations: rounds; default kDefaultRounds. A failure leaves the f of least rho.
/// Allocates.
class LaggedBoundsSolver final : public EngineSolver<WithinOptions, class LaggedBoundsEngine> {
 public:
  using EngineSolver::EngineSolver;

  static constexpr std::int64_t kDefaultRounds = 60;  ///< limit where max_iterations is 0
  static constexpr std::int64_t kPatience = 20;       ///< rounds without a new least rho
};
extern template class EngineSolver<WithinOptions, LaggedBoundsEngine>;

}  // namespace lcpbench
