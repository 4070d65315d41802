#pragma once

#include <functional>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// How impulses follow from approach. [MODEL.md section 9]
enum class ImpactLaw {
  /// One restitution e for every unilateral row: w = A p + (1 + e) J v-, that is J v+ >= -e J v-. Always solvable
  /// without moving kinematic bodies; kinetic energy does not grow.
  kNewton,
  /// Restitution e_i by contact: compression with e = 0 gives p, then impulses e_i p_i are applied, then a second LCP
  /// with e = 0 stops what approaches. Both solvable where every e_i e of Newton's law may not be.
  kPoisson,
};

/// The law of restitution and its thresholds.
struct ImpactOptions {
  ImpactLaw law = ImpactLaw::kNewton;
  /// e in [0, 1], of all contacts; bilateral rows have e = 0 always.
  double restitution = 0;
  /// Of the contacts of two bodies, by their indices (body 1, body 2), in [0, 1]; empty for `restitution`. Poisson's
  /// law only.
  std::function<double(int, int)> pair_restitution;
  /// Approach slower than this [m/s] is stopped with e = 0, so that bouncing ends: a ball of restitution e < 1 bounces
  /// infinitely often in finite time otherwise. An elastic bounce this slow loses its energy, v^2/2 per mass.
  double resting_speed = 1e-4;
  /// Rows that separate faster than this [m/s] are left out of an impact, for a common e would demand that they
  /// separate at e times that speed still.
  double velocity_tolerance = 1e-6;
};

/// @throws InputError naming the option and its range
void RequireValid(const ImpactOptions& options);

/// Answers an LCP of impulses: p in result->f. `rows` and `system` are those of the problem.
using ImpulseSolver = std::function<void(const ContactSystem& system, const std::vector<RowInfo>& rows,
                                         const LcpProblem& problem, LcpResult* result)>;

/// One simultaneous impact over the constraints of `system` that do not separate: v+ = v- + M^-1 J^T p, kinematic
/// bodies keeping their velocities. One LCP (Newton) or two (Poisson).
/// @param system  bodies' velocities are changed; constraints are those that touch, bilateral ones all of them
/// @throws InputError as AssembleContactLcp, or for a pair restitution out of range
void ResolveImpact(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

/// The same with e = 0 for every row: the smallest change of velocity, in the kinetic metric, after which bilateral
/// rows have d' = 0 and unilateral ones d' >= 0.
void StopApproach(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

/// The opposite, for contacts that are known to last but separate by rounding: the smallest change of velocity after
/// which every row of `system` has d' <= 0, then StopApproach.
void StopSeparation(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

}  // namespace lcpbench
