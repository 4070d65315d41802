#pragma once

#include "model/geometry/area_moments.h"
#include "model/shape/outline.h"

namespace lcpbench {

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
