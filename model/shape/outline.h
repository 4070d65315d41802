#pragma once

#include <string>
#include <vector>

#include "model/geometry/area_moments.h"
#include "model/geometry/feature.h"

namespace lcpbench {

/// A closed curve of pieces, each beginning where the one before ends; a vertex lies at every such joint. One piece is
/// enough if it closes on itself (a full circle).
using OutlineLoop = std::vector<OutlinePiece>;

/// The boundary of a plane shape, in a frame of its own [m]: loops[0] is the outer boundary, counter-clockwise; every
/// further loop is a hole, clockwise. So the material is on the left of every piece.
struct Outline {
  std::string name;
  std::vector<OutlineLoop> loops;
};

/// c -> R(angle) c + shift for every point. A rotation adds its angle to curve parameters and to phi, so that joints
/// may open by rounding.
Outline Transformed(const Outline& outline, double angle, Vec2 shift);

/// All pieces, loop after loop.
std::vector<OutlinePiece> AllPieces(const Outline& outline);

/// "outline 'name', outer boundary, edge 3" or "outline 'name', hole 1, edge 0", for error texts.
std::string PieceName(const Outline& outline, std::size_t loop, std::size_t piece);
/// "outline 'name', outer boundary" or "outline 'name', hole 1".
std::string LoopName(const Outline& outline, std::size_t loop);

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

/// The moments about `base` of what a loop encloses: counted positive where it runs counter-clockwise.
/// An open joint (within tolerance) is closed by taking each edge's begin as the vertex. + - * / sqrt and correctly
/// rounded sines only: the same bits on every machine. docs/geometry.md says how.
/// @param loop  every piece passes RequireValidPiece
AreaMoments LoopMoments(const OutlineLoop& loop, Vec2 base);

/// Mass, centre of mass and inertia of a plate of uniform density.
struct MassProperties {
  AreaMoments moments;  ///< about the centre of mass
  double area = 0;      ///< [m^2]
  double mass = 0;      ///< [kg]
  Vec2 center;          ///< centre of mass, in the outline's frame [m]
  double inertia = 0;   ///< about the centre of mass [kg m^2]
};

/// Mass, centre of mass and inertia of a plate, relative error about 1e-14 of a shape's own size and moments; for thin
/// rings and slender shapes off their axes as much more as their area is smaller than their squared extent.
/// @param outline  as RequireValid accepts it; not checked again
/// @param density  of area [kg/m^2], finite, > 0
/// @throws InputError for a density that is not, or if the results are not positive and finite
MassProperties ComputeMassProperties(const Outline& outline, double density);

}  // namespace lcpbench
