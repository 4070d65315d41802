#pragma once

#include <array>
#include <span>

#include "model/contact/body.h"
#include "model/contact/closest_points.h"
#include "model/contact/system.h"

namespace lcpbench {

/// Which closest points a contact or path joint means. A point passes the end of a piece before its motion goes on
/// along the next one, so on paths places beyond ends count.
SearchStart StartOf(const Constraint& constraint);

/// The closest points of a contact or path joint between bodies where they are now.
/// @throws InputError as FindClosestPoints of features
ClosestPoints FindClosestPoints(const Constraint& constraint, std::span<const Body> bodies,
                                Regularity required = Regularity::kLocalMinimum);

/// The row of a contact or path joint: d' = J v and d'' = J a + gamma, v = (v1x, v1y, omega1, v2x, v2y, omega2).
struct ContactRow {
  std::array<double, 6> J{};
  double d_dot = 0;    ///< d' [m/s]
  double gamma = 0;    ///< velocity-product term of d'' [m/s^2]
  double omega_n = 0;  ///< n' = omega_n t [rad/s], t = Perp(n)
};

/// J = [n, R1 x n, -n, -R2 x n]. With t = Perp(n), the slip u = t.(v1(p1) - v2(p2)) [m/s] of the material points at p1
/// and p2, the pairs (r, s) of CurvaturePair and D of ClosestPoints, exact at any gap d, for every kind and side,
///     gamma   = -omega1^2 n.R1 + omega2^2 n.R2 + (s1 s2 u^2 + 2 u (r1 s2 omega1 + s1 r2 omega2)
///               - r1 r2 (omega1 - omega2)^2 - d (r1 s2 omega1^2 + s1 r2 omega2^2)) / D,
///     omega_n = (s1 s2 u + r1 s2 omega1 + s1 r2 omega2) / D.   [docs/model.md sections 3, 4]
/// The curvature form is chosen over the equivalent centre form because it stays accurate as an edge becomes straight.
/// O(1). `closest` must be regular (FindClosestPoints saw to that).
///
/// Corrects these errata of the paper (Neumann, Curved Edge Physics), by their numbers in docs/model.md section 11:
/// 1 (eq. (3) is d''), 3 (the attached normal's alpha2 term: R1 and R2 here lead to the closest points, where it
/// vanishes), 4 (n' = omega_n t turns with the line of centres, not with body 2), 5 (concave edges: signed curvature),
/// 6 (terms in d), 7 (J is the same for U and R, only gamma's arms matter: here R), 8 and 10 (p1, p2 and the osculating
/// centres are fixed in their bodies), 11 (either body may own the normal).
ContactRow ComputeContactRow(const ClosestPoints& closest, const Body& body1, const Body& body2);

/// The tangent row of a contact: the slip u = J v, u' = J a + gamma, v as of ContactRow.
struct TangentRow {
  std::array<double, 6> J{};
  double slip = 0;   ///< u [m/s]
  double gamma = 0;  ///< velocity-product term of u' [m/s^2]
};

/// J = [t, R1 x t, -t, -R2 x t] at the contact arms, t = Perp(n): other arms give other rows here, unlike along n.
///     gamma = -omega1^2 t.R1 + omega2^2 t.R2 - omega_n d'.   [docs/model.md section 7]  O(1).
/// u' is the true derivative of the slip of what touches, exact at any gap. Swapping the bodies leaves the row as it
/// is, bit by bit.
/// @param row  ComputeContactRow of the same contact
TangentRow ComputeTangentRow(const ClosestPoints& closest, const Body& body1, const Body& body2, const ContactRow& row);

/// The rows of a pin: g = p1 - p2 along the fixed world axes x and y; g' = J v, g'' = J a + gamma, exact also for
/// g != 0.
struct PinRows {
  Vec2 R1;  ///< p1 - x1 [m]
  Vec2 R2;  ///< p2 - x2 [m]
  std::array<std::array<double, 6>, 2> J{};
  std::array<double, 2> g{};      ///< [m]
  std::array<double, 2> g_dot{};  ///< [m/s]
  std::array<double, 2> gamma{};  ///< [m/s^2]
};

/// How much faster a pin turns than its motor drives it, omega1 - omega2 - speed [rad/s]; with J = [0, 0, 1, 0, 0, -1]
/// this is J v - speed, so that f is the torque on body 1.
double TurningSlip(const Constraint& pin, std::span<const Body> bodies);

/// Row of axis e: J = [e, R1 x e, -e, -R2 x e], gamma = -omega1^2 e.R1 + omega2^2 e.R2. [docs/model.md section 6] O(1).
/// @param vertex1, vertex2  the joint's points in the body frames, rotations as SinCos(theta)
PinRows ComputePinRows(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                       const Rotation& rotation2, const Body& body2);

/// The distance between a point of body 1 and a point of body 2, as rods and ropes constrain it. World frame.
struct ConnectorRow {
  ClosestPoints points;  ///< n = (p1 - p2)/|p1 - p2| from body 2 to body 1, d = D = |p1 - p2| > 0 [m]
  ContactRow row;        ///< d' = J v, d'' = J a + gamma
};

/// |p1 - p2| of the ends of a rod or rope [m].
double DistanceOfEnds(const Constraint& connector, std::span<const Body> bodies);
/// Whether the ends of a rope coincide, for ComputeConnectorRow: it has no direction then, and needs none, for it is
/// slack. False for a length that is not finite and > 0.
bool HasNoDirection(const Constraint& rope, std::span<const Body> bodies);

/// The vertex/vertex row: (r, s) = (0, 1) on both sides of the formula of ComputeContactRow, u the slip, so that
///     J = [n, R1 x n, -n, -R2 x n],   gamma = -omega1^2 n.R1 + omega2^2 n.R2 + u^2/d.   [docs/model.md sections 4, 6]
/// O(1). A rod is w = 0 on d - L; a rope is unilateral on L - d, with J and gamma negated (assembly.h).
/// Swapping the bodies swaps the row bit by bit (n changes sign). Vertex/vertex *contacts* are another matter: as they
/// close, d -> 0 and n is lost, so FindClosestPoints refuses them.
/// @param vertex1, vertex2  the attachment points in the body frames, rotations as SinCos(theta)
/// @param length            the connector's length L [m]
/// @throws InputError unless L is finite and > 0, and the points are finite and farther apart than kSingularD L: of
///         points that coincide the direction is undefined, and nearer ones it is mostly rounding
ConnectorRow ComputeConnectorRow(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                                 const Rotation& rotation2, const Body& body2, double length);

}  // namespace lcpbench
