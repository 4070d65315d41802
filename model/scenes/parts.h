#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "model/contact/system.h"
#include "model/scenes/random.h"

namespace lcpbench {

// What the scene families are built from. World-aligned body frames (theta = 0) unless said otherwise; SI units; bodies
// are plates, so densities are areal [kg/m^2].

inline constexpr double kPi = 3.14159265358979323846;
/// Standard gravity [m/s^2], rounded.
inline constexpr double kGravity = 9.81;

/// An empty system named "<family>-<rows>-s<seed>".
ContactSystem EmptyScene(std::string_view family, int rows, std::uint64_t seed);

/// A homogeneous disc about x: mass pi r^2 density, inertia m r^2 / 2, outline a full circle.
Body MakeDisc(Vec2 x, double radius, double density);
/// A homogeneous box about x: mass w h density, inertia m (w^2 + h^2) / 12.
Body MakeBox(Vec2 x, double width, double height, double density);
/// A body that cannot move, at the origin, without outline.
Body MakeFixed(std::string name);

/// The circle about the body's origin.
ArcEdge Circle(double radius);
/// The whole circle as one outline piece, material inside (convex) or outside (concave).
OutlineEdge FullCircle(Vec2 center, double radius, Side side);
/// A straight edge as one outline piece.
OutlineEdge WholeEdge(Vec2 a, Vec2 b);
/// Corner 0..3 of a box in its body frame, counter-clockwise from the lower left.
Vec2 BoxCorner(double width, double height, int corner);
/// Edge 0..3 of a box in its body frame: bottom, right, top, left.
StraightEdge BoxEdge(double width, double height, int edge);

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

/// Of two discs that touch each other and the inside of an arc of radius `arc`, one after the other counter-clockwise:
/// the unit direction from the arc's centre to the second disc's, given that to the first. In the triangle with sides
/// a = arc - r1, b = arc - r2 and r1 + r2, sin^2(angle / 2) = ((r1 + r2)^2 - (a - b)^2) / (4 a b), and a - b = r2 - r1.
Vec2 NextAlongArc(Vec2 direction, double r1, double r2, double arc);

/// The point at these distances from two others, the one on the left of the way from the first to the second.
Vec2 NotchPoint(Vec2 center1, double reach1, Vec2 center2, double reach2);

/// Appends and returns the index; a body without a name gets "<kind> <index>".
int AddBody(ContactSystem* system, std::string_view kind, Body body);
/// Appends a unilateral contact; the normal points from body 2 to body 1.
void AddContact(ContactSystem* system, int body1, const Feature& feature1, int body2, const Feature& feature2);

/// How a scene is loaded. `weight` and `gust` are accelerations [m/s^2].
struct LoadLevel {
  /// In-plane gravity: kGravity for an upright plane, less for an inclined one.
  double weight = kGravity;
  /// Each movable body gets a random force of up to m gust in a random direction ...
  double gust = kGravity;
  /// ... and a random torque of up to m gust (lever), lever = lever_per_gyradius sqrt(I / m).
  double lever_per_gyradius = 1;
};

/// Weight and independent random forces and torques on every movable body, in body order.
void ApplyLoads(ContactSystem* system, const LoadLevel& level, Random* random);

}  // namespace lcpbench
