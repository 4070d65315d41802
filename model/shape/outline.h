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

/// The moments about `base` of what a loop encloses: counted positive where it runs counter-clockwise.
/// An open joint (within tolerance) is closed by taking each edge's begin as the vertex. + - * / sqrt and correctly
/// rounded sines only: the same bits on every machine. docs/geometry.md says how.
/// @param loop  every piece passes RequireValidPiece
AreaMoments LoopMoments(const OutlineLoop& loop, Vec2 base);

/// Of a plate of uniform density.
struct MassProperties {
  AreaMoments moments;  ///< about the centre of mass
  double area = 0;      ///< [m^2]
  double mass = 0;      ///< [kg]
  Vec2 center;          ///< centre of mass, in the outline's frame [m]
  double inertia = 0;   ///< about the centre of mass [kg m^2]
};

/// Mass, centre of mass and inertia of a plate, relative error about 1e-14 of a shape's own size and moments; for thin
/// rings and slender shapes off their axes as much more as their area is smaller than their squared extent.
/// @param outline  as RequireValid (outline_checks.h) accepts it; not checked again
/// @param density  of area [kg/m^2], finite, > 0
/// @throws InputError for a density that is not, or if the results are not positive and finite
MassProperties ComputeMassProperties(const Outline& outline, double density);

}  // namespace lcpbench
