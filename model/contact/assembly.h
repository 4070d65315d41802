#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "model/contact/system.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// "contact", "path joint", "pin", "rod" or "rope".
const char* ToString(ConstraintType type);

/// One row of an assembled system, with the geometry it came from (world frame).
struct RowInfo {
  int constraint = 0;  ///< index into ContactSystem::constraints
  /// 'n' contact, path joint, rod or rope; 't' a contact's tangent; 'x' or 'y' the rows of a pin, 'r' its torque.
  char axis = 'n';
  bool bilateral = false;
  Vec2 p1;  ///< closest point on body 1
  Vec2 p2;  ///< closest point on body 2
  /// Unit normal from body 2 to body 1 (a tangent row: Perp of it; a pin row: its world axis; a rope: from p1 to p2,
  /// because it pulls; a torque: 0, and J = [0, 0, 1, 0, 0, -1]). The row is J = [n, R1 x n, -n, -R2 x n] in every
  /// case: f acts on body 1 as +f n.
  Vec2 n;
  /// Gap [m] (a tangent or torque row: 0; a pin row: its component of g = p1 - p2; a rod: |p1 - p2| - L; a rope: L -
  /// |p1 - p2|).
  double d = 0;
  double d_dot = 0;  ///< [m/s]; of a tangent row the slip, of a torque TurningSlip [rad/s]
  double gamma = 0;  ///< velocity-product term of d'', of a tangent row of the slip's derivative [m/s^2]
  double drive = 0;  ///< d_dot - J v: of a tangent row minus the surfaces' speeds, of a torque minus the motor's

  /// Whether d is a gap or a joint's error.
  bool has_gap() const { return axis != 't' && axis != 'r'; }
};

/// J (n x 3N, columns of every body in body order, fixed ones included), inverse mass (3N, 0 for fixed bodies),
/// b = J M^-1 F + gamma (prescribed accelerations of fixed bodies through J), and the rows' geometry.
struct AssembledLcp {
  std::vector<RowInfo> rows;
  LcpProblem problem;
};

/// What becomes of Constraint::friction and torque_limit.
enum class Friction {
  kNone,  ///< nothing: the other rows only
  /// Every contact with mu > 0 has a tangent row after its normal one, of kind kFriction, and every pin with a torque
  /// limit > 0 a row of kind kBounded after its two.
  kRows,
};

/// Assembles the acceleration-level LCP of `system`. [docs/model.md sections 3, 4, 6, 7, 8]  O(rows).
/// Tangent rows are friction rows whatever the slip: at this level that is Coulomb's law of contacts without slip only.
/// @throws InputError for invalid geometry, a coefficient of friction outside [0, kMostFriction], and for singular
///         constraints, naming the condition and both features
AssembledLcp AssembleContactLcp(const ContactSystem& system, Friction friction = Friction::kNone);

/// Assembles the LCP of a time step h [s] with Coulomb friction: f impulses, w velocities at its end,
///     b = J v^ + c,   v^ = FreeVelocity(system.bodies, h),   c = d / h of contacts and ropes, where d > 0, else
///     `drive`.
/// Where all fixed bodies rest it has a solution for every mu. [docs/friction.md sections 1, 2]  O(rows).
/// @throws InputError as AssembleContactLcp
AssembledLcp AssembleStepLcp(const ContactSystem& system, double h);

/// The problem that an instant stands for: the time step h where any contact has friction or a pin a torque, else the
/// acceleration level.
AssembledLcp AssembleInstant(const ContactSystem& system, double h);

/// v^ = v + h M^-1 F, three numbers a body; of a fixed body the mean velocity over the step, as prescribed.
Eigen::VectorXd FreeVelocity(std::span<const Body> bodies, double h);

}  // namespace lcpbench
