#pragma once

#include "model/contact/body.h"
#include "model/contact/closest_points.h"
#include "model/contact/contact_row.h"
#include "model/geometry/trig.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// The distance between a point of body 1 and a point of body 2, as rods and ropes constrain it. World frame.
struct ConnectorRow {
  ClosestPoints points;  ///< n = (p1 - p2)/|p1 - p2| from body 2 to body 1, d = D = |p1 - p2| > 0 [m]
  ContactRow row;        ///< d' = J v, d'' = J a + gamma
};

/// The vertex/vertex row: (r, s) = (0, 1) on both sides of the unified formula, so that
///     J = [n, R1 x n, -n, -R2 x n],   gamma = -omega1^2 n.R1 + omega2^2 n.R2 + u^2/d.   [MODEL.md sections 4, 6]
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
