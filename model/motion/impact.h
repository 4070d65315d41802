#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/body.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// M^-1 J^T f, three entries a body: what row multipliers f do to accelerations, velocities or positions.
/// @param problem  given by factors
Eigen::VectorXd DisplacementOf(const LcpProblem& problem, const Eigen::VectorXd& f);

/// v += change, of movable bodies.
void AddToVelocities(const Eigen::VectorXd& change, std::span<Body> bodies);

/// Velocities of the same bodies.
void CopyVelocities(std::span<const Body> from, std::span<Body> to);

/// One of the rows' numbers, by row.
Eigen::VectorXd ValuesOf(const std::vector<RowInfo>& rows, double RowInfo::*x);

/// The system with those of its constraints that are chosen.
ContactSystem PartOf(const ContactSystem& system, const std::vector<bool>& chosen);

/// The worst violation: max(-x, 0) of unilateral rows and |x| of bilateral ones, x = d [m] or d_dot [m/s].
double WorstViolation(const std::vector<RowInfo>& rows, double RowInfo::*x = &RowInfo::d);

/// Answers an LCP of impulses or displacements: multipliers in result->f. `rows` and `system` are the problem's.
using ImpulseSolver = std::function<void(const ContactSystem& system, const std::vector<RowInfo>& rows,
                                         const LcpProblem& problem, LcpResult* result)>;

/// Solves w = A f + b with the rows of `lcp` and gives f; `change` gets M^-1 J^T f.
Eigen::VectorXd SolveRows(const ImpulseSolver& solve, const ContactSystem& system, const AssembledLcp& lcp,
                          const Eigen::VectorXd& b, Eigen::VectorXd* change);

/// Moves the bodies by the smallest displacement, in the kinetic metric, after which to first order no unilateral
/// constraint of `system` has d < 0 and every bilateral one d = 0: delta x = M^-1 J^T f with
///     w = A f + d,   unilateral rows 0 <= f _|_ w >= 0,   bilateral rows w = 0,
/// A the Delassus matrix. Repeated, for constraints curve, until the violation is at most `goal` [m], at most
/// kMostProjections times, and taken back where it does not get smaller. The LCP can be unsolvable where redundant rows
/// are violated against each other (a disc between walls that are too close).
/// @return the violation that is left
double ProjectPositions(double goal, const ImpulseSolver& solve, ContactSystem* system);

inline constexpr int kMostProjections = 4;

/// How impulses follow from approach. [docs/model.md section 9]
enum class ImpactLaw {
  /// One restitution e for every unilateral row: w = A p + (1 + e) J v-, that is J v+ >= -e J v-. Always solvable
  /// without moving kinematic bodies; kinetic energy does not grow.
  kNewton,
  /// Compression with e = 0 gives p, then impulses e p are applied, then a second LCP with e = 0 stops what approaches.
  kPoisson,
};

/// The law of restitution and its thresholds.
struct ImpactOptions {
  ImpactLaw law = ImpactLaw::kNewton;
  /// e in [0, 1], of all contacts; bilateral rows have e = 0 always.
  double restitution = 0;
  /// Approach slower than this [m/s] is stopped with e = 0, so that bouncing ends: a ball of restitution e < 1 bounces
  /// infinitely often in finite time otherwise. An elastic bounce this slow loses its energy, v^2/2 per mass.
  double resting_speed = 1e-4;
  /// Rows that separate faster than this [m/s] are left out of an impact, for a common e would demand that they
  /// separate at e times that speed still.
  double velocity_tolerance = 1e-6;
};

/// @throws InputError naming the option and its range
void RequireValid(const ImpactOptions& options);

/// One simultaneous impact over the constraints of `system` that do not separate: v+ = v- + M^-1 J^T p, kinematic
/// bodies keeping their velocities. One LCP (Newton) or two (Poisson).
/// @param system  bodies' velocities are changed; constraints are those that touch, bilateral ones all of them
/// @throws InputError as AssembleContactLcp
void ResolveImpact(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

/// The same with e = 0 for every row: the smallest change of velocity, in the kinetic metric, after which bilateral
/// rows have d' = 0 and unilateral ones d' >= 0.
void StopApproach(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

/// The opposite, for contacts that are known to last but separate by rounding: the smallest change of velocity after
/// which every row of `system` has d' <= 0, then StopApproach.
void StopSeparation(const ImpactOptions& options, const ImpulseSolver& solve, ContactSystem* system);

}  // namespace lcpbench
