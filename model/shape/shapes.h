#pragma once

#include "model/contact/body.h"
#include "model/shape/outline.h"

namespace lcpbench {

// Ready-made outlines, each valid in the sense of RequireValid (outline.h) for every parameter that is accepted,
// up to its limits of size and slenderness. Lengths in m, angles in rad. The frame is the drawing's own; its origin is
// the centre of mass only where the shape is symmetric about it: see Centered and MakeBody.
// Vertices lie wherever pieces join, also at smooth joints. The same bits on every machine.
// @throws InputError naming the shape and the parameter, for parameters outside the stated ranges

/// A full disc about the origin.
Outline Disc(double radius);

/// An axis-parallel box about the origin.
Outline Box(double width, double height);

/// A box with quarter-circle corners. 0 < corner_radius, 2 corner_radius < width and height.
Outline RoundedBox(double width, double height, double corner_radius);

/// The points within radius of the segment of that length on the x axis about the origin: two straight edges, two half
/// circles.
Outline Capsule(double length, double radius);

/// The upper half of a disc about the origin: flat side on the x axis.
Outline HalfDisc(double radius);

/// A letter D: the box -straight..0 x -radius..radius with a half disc of that radius on its right side.
Outline DShape(double straight, double radius);

/// A ring about the origin: a disc with a concentric round hole. inner_radius < outer_radius.
Outline Ring(double outer_radius, double inner_radius);

/// An ellipse about the origin, semi-axes a along x and b along y.
Outline Ellipse(double a, double b);

/// A superellipse about the origin: (x/a)^m + (y/b)^m = 1, m >= 2 even.
Outline Superellipse(double a, double b, int m);

/// A gear about the origin, one tooth centred on the positive x axis. Each tooth has a land on the tip circle, each gap
/// one on the root circle, joined by flanks that are convex circular arcs through the ends of the lands.
struct GearShape {
  int teeth = 12;            ///< >= 3
  double root_radius = 0.8;  ///< < tip_radius
  double tip_radius = 1;
  /// Share of a tooth's angular pitch 2 pi / teeth that the tip land and the tooth's foot take: 0 < tip_share <=
  /// foot_share < 1.
  double tip_share = 0.25;
  double foot_share = 0.6;
  /// Radius of the flank arcs, at least as long as the flank's chord: flatter flanks for larger radii.
  double flank_radius = 0.5;
};
Outline Gear(const GearShape& shape);

/// A cam: a base circle about the origin and a smaller nose circle on the positive x axis, joined by their two common
/// tangents. nose_radius <= base_radius, base_radius - nose_radius < distance.
Outline Cam(double base_radius, double nose_radius, double distance);

/// A bowl like a letter C that opens upwards: the part of a ring about the origin at more than half_opening from the
/// positive y axis, its two lips rounded by half circles. 0 < inner_radius < outer_radius; the lips must not touch:
/// half_opening < pi and sin(half_opening) mean radius > (outer_radius - inner_radius) / 2 while half_opening < pi / 2.
Outline Bowl(double outer_radius, double inner_radius, double half_opening);

/// The outline moved so that its centre of mass is the origin, as a body frame demands.
Outline Centered(const Outline& outline);

/// A movable body of that shape, at rest with its body frame on the outline's frame: x = centre of mass, theta = 0;
/// name, mass, inertia and outline (body frame, as of Centered(outline)) are set.
/// @throws InputError as RequireValid and ComputeMassProperties
Body MakeBody(const Outline& outline, double density);

}  // namespace lcpbench
