#pragma once

#include "model/shape/outline.h"

namespace lcpbench {

/// Joints may be open by this, relative to the outline's extent (the diagonal of its bounding box) ...
inline constexpr double kClosureTolerance = 1e-9;
/// ... edges shorter than this are refused as having zero length ...
inline constexpr double kMinEdgeLength = 1e-8;
/// ... and edges that come nearer to each other than this, other than at their common vertex, count as meeting.
/// All three grow with the rounding of the edges' own numbers where that is larger: arcs may have radii and centres up
/// to about 1e9 times the extent.
inline constexpr double kTouchTolerance = 1e-10;

/// Whether an outline bounds a plane shape. Refused, in this order:
///   no loop, an empty loop; a piece that RequireValidPiece refuses (NaN, radius <= 0, zero length, aspect ratio, ...);
///   a size outside 1e-60..1e60 m, or too far from the origin for its coordinates to have digits left;
///   a Bezier edge whose derivative vanishes; an edge shorter than kMinEdgeLength; an open joint;
///   edges that meet other than at their joint, of the same loop or of two, and vertices of zero angle (cusps);
///   an outer boundary that runs clockwise, a hole that runs counter-clockwise; a hole outside the outer boundary or
///   inside another hole; an aspect ratio of the whole outline, the root of the ratio of its principal second moments
///   of area (a / b of an ellipse, length / width of a box, 1 of a ring), beyond kMaxAspectRatio
///   (model/geometry/curve.h).
/// About O(n log n) for n edges that stay clear of each other; edges that run along each other at a gap g cost
/// O(sqrt(extent / g)) more. How meetings are found: docs/geometry.md.
/// @throws InputError, one line naming the outline, the loop, the edge and what was expected
void RequireValid(const Outline& outline);

}  // namespace lcpbench
