#pragma once

#include "model/contact/body.h"
#include "model/geometry/vec2.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Moments of area of a signed plane region about a base point: the integrals of 1, (x, y), and x^2, xy, y^2 over the
/// region, x and y from the base point. They add over regions.
struct AreaMoments {
  double area = 0;  ///< [m^2]
  Vec2 first;       ///< [m^3]
  double xx = 0;    ///< [m^4]
  double xy = 0;
  double yy = 0;

  double polar() const { return xx + yy; }
};

AreaMoments operator+(const AreaMoments& p, const AreaMoments& q);
/// The moments of the region moved by d.
AreaMoments Moved(const AreaMoments& m, Vec2 d);
/// The moments of the region's image under the linear map whose columns are u and v.
AreaMoments Mapped(const AreaMoments& m, Vec2 u, Vec2 v);

/// The moments about `base` of what a loop encloses: counted positive where it runs counter-clockwise.
/// By Green's theorem, area = 1/2 (integral of p x dp) and so on, split into the polygon of the loop's vertices and the
/// regions between every edge and its chord, so that nearly straight arcs (small region, huge radius) keep all digits:
///   circular and elliptic arcs   closed forms; power series for arcs below 2 rad, where those would cancel
///   Bezier edges                 Gauss-Legendre quadrature of a degree that makes it exact for these polynomials
///   superellipse edges           adaptive Gauss-Kronrod quadrature to a relative 1e-14, in the slope of the polar ray,
///                                in which the integrand is algebraic and does not know the aspect ratio
/// An open joint (within tolerance) is closed by taking each edge's begin as the vertex. + - * / sqrt and correctly
/// rounded sines only: the same bits on every machine.
/// @param loop  every piece passes RequireValidPiece
AreaMoments LoopMoments(const OutlineLoop& loop, Vec2 base);

/// The moments about `base` of the material of a whole outline: all loops added.
AreaMoments OutlineMoments(const Outline& outline, Vec2 base);

/// Of a plate of uniform density.
struct MassProperties {
  double area = 0;     ///< [m^2]
  double mass = 0;     ///< [kg]
  Vec2 center;         ///< centre of mass, in the outline's frame [m]
  double inertia = 0;  ///< about the centre of mass [kg m^2]
};

/// Mass, centre of mass and inertia of a plate, relative error about 1e-14 of a shape's own size and moments; for thin
/// rings and slender shapes off their axes as much more as their area is smaller than their squared extent.
/// @param outline  as RequireValid (outline_checks.h) accepts it; not checked again
/// @param density  of area [kg/m^2], finite, > 0
/// @throws InputError for a density that is not, or if the results are not positive and finite
MassProperties ComputeMassProperties(const Outline& outline, double density);

/// The outline moved so that its centre of mass is the origin, as a body frame demands.
Outline Centered(const Outline& outline);

/// A movable body of that shape, at rest with its body frame on the outline's frame: x = centre of mass, theta = 0;
/// name, mass, inertia and outline (body frame, as of Centered(outline)) are set.
/// @throws InputError as RequireValid and ComputeMassProperties
Body MakeBody(const Outline& outline, double density);

}  // namespace lcpbench
