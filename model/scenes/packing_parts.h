#pragma once

#include "model/scenes/parts.h"

namespace lcpbench {

// Bodies that the packings are built from besides those of parts.h. All by closed forms, so that a body costs O(edges)
// and 10^6 of them are no burden; world-aligned body frames, SI units, areal densities [kg/m^2].

/// The oval with semi-axes a and b about its body's origin, a along the body's x axis.
EllipseEdge Oval(double a, double b);
/// A homogeneous ellipse about x, turned by theta [rad]: mass pi a b density, inertia m (a^2 + b^2) / 4.
Body MakeOval(Vec2 x, double theta, double a, double b, double density);

/// A homogeneous ring about x, inner < outer radius: mass pi (R^2 - r^2) density, inertia m (R^2 + r^2) / 2.
Body MakeRing(Vec2 x, double outer_radius, double inner_radius, double density);

/// A box with quarter-circle corners about its body's origin. 0 < corner, 2 corner < width and height.
struct RoundedBoxShape {
  double width = 1;
  double height = 1;
  double corner = 0.1;

  /// Arc at corner 0..3, counter-clockwise from the lower left (as BoxCorner).
  ArcEdge Corner(int corner_index) const;
  /// The straight part of edge 0..3: bottom, right, top, left (as BoxEdge).
  StraightEdge Edge(int edge) const;
};
/// A homogeneous one about x.
Body MakeRoundedBox(Vec2 x, const RoundedBoxShape& shape, double density);

}  // namespace lcpbench
