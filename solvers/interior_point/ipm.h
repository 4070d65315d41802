#pragma once

#include <cstdint>

#include "solvers/lcp/engine_solver.h"
#include "solvers/linear_algebra/scaled_system.h"

namespace lcpbench {

/// What happened below an IpmSolver, for tests and tuning.
struct IpmStatistics {
  std::int64_t analyses = 0;        ///< symbolic, in the latest Prepare; 0 if those of the problem before serve
  std::int64_t factorizations = 0;  ///< numeric, in the latest Solve
  std::int64_t interior_steps = 0;  ///< of these, interior-point steps
  std::int64_t pivots = 0;          ///< of these, active sets tried
  bool body_space = false;          ///< the systems live on the bodies
  double fill = 0;                  ///< entries of L
  double factor_flops = 0;          ///< of one factorization
};

/// Options of IpmSolver.
struct IpmOptions {
  using Space = ScaledSystem::Space;  ///< see there
  /// Where the linear systems live. kAutomatic: by the column counts of J.
  Space space = Space::kAutomatic;
  /// Proximal weight relative to the scaled unit diagonal. Smaller than 1e-13 meets rounding of singular A; 1e-7
  /// already slows the interior point on rank-deficient A, as directions in the null space are damped.
  double proximal = 1e-12;
  /// Centrality correctors per interior-point step, as long as they lengthen it; each costs one solve.
  int correctors = 4;

  /// Names: space (auto, contact, body), proximal [1e-13, 1e-6], correctors [0, 10].
  void Read(SettingsReader* reader);
};

/// Sparse second-order LCP solver on CHOLMOD: an interior point that finds the active set, and an active-set method
/// that makes the answer exact. [Mehrotra 1992; Gondzio 1996; Judice, Pires 1994; Rockafellar 1976; Chen et al. 2008]
///
/// Scaled variables (scaled_system.h): unit diagonal, b of size 1 in every connected component.
///
/// 1. Mehrotra predictor-corrector with Gondzio's centrality correctors on  w = A f + b, f w = mu e, its target mu
///    chosen among three by the mu that each step would leave (InteriorPoint); bilateral rows are free. Every step
///    factorizes A + diag(w/f) + eps I once. The pattern never changes, so neither does the symbolic analysis of
///    Prepare. eps is a proximal term about the current iterate, so it slows but does not move the limit.
/// 2. Systems live on the contacts, A + diag(w/f), or on the bodies (BodySpace), where redundant rows cost nothing: on
///    the bodies where the columns of J hold many rows. A solve is refined only where its residual calls for it.
/// 3. From mu = 1e-4 on every iterate may be the last one (InteriorFinish): refinement on the factor of the step where
///    F = {f > w} is right, sweeps where what is wrong with it is local. Where few rows are wrong, block pivots correct
///    F (BlockPivoting), with an eps of about sqrt(mu) after the first try. Accepted only if the tier is met by a
///    fresh w, summed in extended precision from the given form of A.
/// 4. Where the interior point stagnates: block principal pivoting with Murty's least-index rule as a safeguard on
///    A + eps I, b - eps c (a P-matrix, so finite), inside a proximal-point loop c <- f (convergent for PSD A), up to
///    300 pivots.
/// 5. Where f grows without bound, growth directions of 1 or 4 are projected onto the null space of A over their
///    support; kInfeasible is claimed only with a ray that VerifyFarkasRay accepts.
///
/// Guaranteed class: in exact arithmetic, and within the limits, all symmetric PSD A. In double, scaled eigenvalues of
/// A in (0, 1e-13) are as good as zero (the rank tolerance). Refuses A that is not symmetric to rounding, has a
/// negative diagonal entry, or a nonzero beside a zero diagonal entry. Departures: one step length for f and w (the QP
/// couples them); the proximal term; finishing by active sets.
///
/// iterations = numeric factorizations, of interior-point steps, of active sets and of rays alike; default limit 500.
/// Cost of one: CHOLMOD's Factorize plus 3 to 10 solves. Limits are checked before each factorization; none is begun
/// that would end more than 10 % past the time limit if it takes as long as the one before. A failure leaves the
/// iterate of least rho seen.
///
/// Warm start: initial_f, clipped at 0, is returned if it meets the tier; it is ignored where its rho is at least half
/// that of f = 0. Else: its active set, with block pivots only as long as they pay (BlockPivoting); nncg for as long
/// as its rate promises an answer within the time of four factorizations; the interior point from the best iterate so
/// far where that has a rho below 3 % of that of f = 0, or cold. May change the answer where f is not unique.
/// In a sequence order and symbolic analysis are kept for the same pattern. Measured: docs/solvers/interior_point.md.
class IpmSolver final : public EngineSolver<IpmOptions, class IpmEngine> {
 public:
  using EngineSolver::EngineSolver;

  /// Statistics of the latest Prepare and Solve.
  const IpmStatistics& statistics() const;

  /// What later solves do with initial_f, for callers that sweep themselves.
  enum class WarmStart {
    kFull,         ///< active set, sweeps, interior point
    kGuessOnly,    ///< the active set alone: ends with kIterationLimit and the best iterate where it is not the answer
    kAfterSweeps,  ///< active set, interior point
  };
  /// Holds until it is called again; kFull at first.
  void UseWarmStart(WarmStart use);
};
extern template class EngineSolver<IpmOptions, IpmEngine>;

}  // namespace lcpbench
