#pragma once

#include <memory>

#include "model/motion/impact.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// Lengths marked "sizes" are in units of the smallest width or height of a movable body's outline in its body frame,
/// 1 m where none has an outline.
struct VelocityOptions {
  double step = 1e-3;  ///< h [s], > 0
  /// Newton's e, one for all contacts, in [0, 1]. A contact that approaches fast enough to close within the step leaves
  /// with e times its speed, where impulses on other contacts do not make it faster.
  double restitution = 0;
  /// Poisson's law resolves an impact (impact.h) of what closes within a step before that step, with c = d / h in it.
  ImpactLaw impact_law = ImpactLaw::kNewton;
  /// Approach slower than this [m/s], >= 0, leaves with none of its speed; Poisson's law takes 1e-6 at least.
  double resting_speed = 0;
  /// Contacts deeper than this [sizes], > 0, may be ghosts: WithoutGhosts.
  double doubtful_depth = 0.02;
  /// Starts every solve from the impulses of the step before, rows matched by RowMatching.
  bool warm_start = true;
  /// Tolerance and limits of every solve; initial_f is not read.
  LcpOptions lcp;
};

/// The time stepping of Anitescu and Potra (1997) and Stewart and Trinkle (1996) [docs/model.md section 9, friction.md
/// section 9]:
///     v^ = v + h M^-1 F,   w = A p + J v^ + c,   0 <= p perp w >= 0 (joints: w = 0, p free),
///     |p_t| <= mu p_n, p_t = -sign(w_t) mu p_n where w_t is not 0   (tangent rows, of contacts with mu > 0),
///     |p| <= h torque_limit   (bounded rows, of pins with one),   c = RowInfo::drive of both kinds,
///     v+ = v^ + M^-1 J^T p,   x+ = x + h v+,   theta+ = theta + h omega+,
/// with J, the gaps d and the forces F at the step's beginning, p impulses [N s], w velocities [m/s], and
///     c = d / h                                   of contacts and ropes with d >= 0 (with friction, d beyond 1e-10
///                                                 sizes: less is rounding, see docs/friction.md section 9),
///     c = max(d, -delta) / h                      of those with d < 0; joints: d clamped to [-delta, delta],
///     c = min(c, e d')                            of contacts that close within the step at d' = J v < 0, if e > 0 in
///                                                 Newton's law;
/// no more than delta, 0.01 sizes, is undone in one step. Contacts enter up to the gap 3 h V, V the largest speed of
/// any point of a body at its free velocity v^. Order 1 in h. Kinematic bodies follow their prescribed acceleration
/// exactly; J v^ has their mean velocity.
///
/// Where the solver says kInfeasible, the observer gets that problem with its ray, statistics().unsolvable counts it,
/// and the step is repeated with less; with friction also where it says kNumericalFailure, since no ray need exist.
/// A solver that does not take friction rows ends the motion at the first of them. Any other failure goes on with the
/// impulses that it left, unless they are not finite: kSolverFailed. docs/motion.md: energy, and what an unsolvable
/// step is repeated with. O(contacts) per step beside the broad phase and the solve.
/// @param solver  not owned; must outlive the motion
/// @throws InputError for an invalid world (RequireValid), options outside their ranges, or bodies that overlap by more
///         than TreatedDepth, naming them
std::unique_ptr<Motion> MakeVelocityMotion(World world, const VelocityOptions& options, LcpSolver& solver);

}  // namespace lcpbench
