#pragma once

#include <array>

#include "model/contact/body.h"
#include "model/contact/closest_points.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// The row of a contact or path joint: d' = J v and d'' = J a + gamma, v = (v1x, v1y, omega1, v2x, v2y, omega2).
struct ContactRow {
  std::array<double, 6> J{};
  double d_dot = 0;    ///< d' [m/s]
  double gamma = 0;    ///< velocity-product term of d'' [m/s^2]
  double slip = 0;     ///< u = t.(v1(p1) - v2(p2)) [m/s], t = Perp(n)
  double omega_n = 0;  ///< n' = omega_n t [rad/s]
};

/// J = [n, R1 x n, -n, -R2 x n], and by the unified curvature formula, exact at any gap d, for every kind, side and
/// owner of the normal,
///     gamma   = -omega1^2 n.R1 + omega2^2 n.R2 + (s1 s2 u^2 + 2 u (r1 s2 omega1 + s1 r2 omega2)
///               - r1 r2 (omega1 - omega2)^2 - d (r1 s2 omega1^2 + s1 r2 omega2^2)) / D,
///     omega_n = (s1 s2 u + r1 s2 omega1 + s1 r2 omega2) / D.   [MODEL.md sections 3, 4; Neumann, Curved Edge Physics]
/// The curvature form is chosen over the equivalent centre form because it stays accurate as an edge becomes straight.
/// O(1). `closest` must be regular (FindClosestPoints saw to that).
///
/// Corrects these errata of the paper, by their numbers in MODEL.md section 11: 1 (eq. (3) is d''), 3 (the attached
/// normal's alpha2 term: R1 and R2 here lead to the closest points, where it vanishes), 4 (n' = omega_n t turns with
/// the line of centres, not with body 2), 5 (concave edges: signed curvature), 6 (terms in d), 7 (J is the same for U
/// and R, only gamma's arms matter: here R), 8 and 10 (p1, p2 and the osculating centres are fixed in their bodies), 11
/// (either body may own the normal).
ContactRow ComputeContactRow(const ClosestPoints& closest, const Body& body1, const Body& body2);

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

/// Row of axis e: J = [e, R1 x e, -e, -R2 x e], gamma = -omega1^2 e.R1 + omega2^2 e.R2. [MODEL.md section 6]  O(1).
/// @param vertex1, vertex2  the joint's points in the body frames, rotations as SinCos(theta)
PinRows ComputePinRows(Vec2 vertex1, const Rotation& rotation1, const Body& body1, Vec2 vertex2,
                       const Rotation& rotation2, const Body& body2);

}  // namespace lcpbench
