#pragma once

#include <optional>

#include "model/contact/body.h"
#include "model/contact/closest_points.h"

namespace lcpbench {

/// How fast the closest points move over the surfaces of their bodies, along t = Perp(n) [m/s]; 0 for a vertex.
struct ContactTravel {
  double sigma_dot1 = 0;
  double sigma_dot2 = 0;
};

/// With the curvature pairs (r, s) of the two features,
///     sigma_dot1 = r1 (r2 (omega1 - omega2) - s2 (u - d omega1)) / D,
///     sigma_dot2 = r2 (r1 (omega1 - omega2) + s1 (u - d omega2)) / D:
/// for two edges the speeds of MODEL.md section 4, for a vertex on edge 2 sigma_dot2 = (u - d omega2)/(1 + d kappa2).
/// Along +t the parameter of body 2's edge grows and that of body 1's edge falls where the material is on its left
/// (straight edges, Bezier curves, convex arcs and ovals); on concave ones the other way round. O(1).
/// @param closest  regular (FindClosestPoints)
ContactTravel ComputeContactTravel(const ClosestPoints& closest, const Body& body1, const Body& body2);

/// The signed curvatures [1/m] of two edges that join smoothly at the closest point: of the edge that lies on the side
/// of +t, and of the one on the side of -t.
struct JoinCurvatures {
  double along_t = 0;
  double against_t = 0;
};

/// At a join of edges with one tangent and two curvatures d'' is one-sided: the curvature that counts is that of the
/// edge into which the closest point moves. Returns `closest` with that curvature on each side that has a join. Where
/// the point rests (speed 0) both give the same d''. [MODEL.md section 4]
/// If both bodies are at a join, the four combinations are tried for the one whose speeds agree with its choice; where
/// all have D > 0 there is one. O(1).
/// @throws InputError if a side with a join is a vertex, or D is not above the singular threshold for a curvature that
///         had to be considered
ClosestPoints WithOneSidedCurvature(const ClosestPoints& closest, const std::optional<JoinCurvatures>& join1,
                                    const std::optional<JoinCurvatures>& join2, const Body& body1, const Body& body2);

}  // namespace lcpbench
