#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "model/contact/system.h"
#include "model/scenes/random.h"
#include "model/shape/outline.h"

namespace lcpbench {

// What the scene families are built from. World-aligned body frames (theta = 0) unless said otherwise; SI units; bodies
// are plates, so densities are areal [kg/m^2]; points p1, p2 of bodies are body-frame coordinates.

inline constexpr double kPi = 3.14159265358979323846;
/// Standard gravity [m/s^2], rounded.
inline constexpr double kGravity = 9.81;

/// (1 / |a|) a, whose bits are not those of Unit (vec2.h).
inline Vec2 Normalized(Vec2 a) { return (1 / Norm(a)) * a; }
/// The unit vector at that angle [rad] from the x axis.
Vec2 Direction(double angle);
/// The rotation by the angle of that sine, within a right angle.
Rotation OfSine(double sine);
/// The unit vector turned, a unit vector again.
Vec2 Turned(Vec2 direction, Rotation turn);

/// An empty system named "<family>-<rows>-s<seed>".
ContactSystem EmptyScene(std::string_view family, int rows, std::uint64_t seed);

/// A homogeneous disc about x: mass pi r^2 density, inertia m r^2 / 2, outline a full circle.
Body MakeDisc(Vec2 x, double radius, double density);
/// A homogeneous box about x: mass w h density, inertia m (w^2 + h^2) / 12; outline: bottom, right, top, left.
Body MakeBox(Vec2 x, double width, double height, double density);
/// A homogeneous ellipse about x, turned by theta [rad]: mass pi a b density, inertia m (a^2 + b^2) / 4.
Body MakeOval(Vec2 x, double theta, double a, double b, double density);
/// A homogeneous ring about x, inner < outer radius: mass pi (R^2 - r^2) density, inertia m (R^2 + r^2) / 2.
Body MakeRing(Vec2 x, double outer_radius, double inner_radius, double density);
/// A homogeneous box about x, w by h, with quarter-circle corners of radius r, 0 < r, 2 r < w and h; outline: bottom,
/// lower right corner, right, and so on.
Body MakeRoundedBox(Vec2 x, double w, double h, double r, double density);
/// A homogeneous body of that shape (MakeBody) that has no name yet.
Body MakePlate(Outline outline, double density);
/// A body that cannot move, at the origin.
Body MakeFixed(std::string name, std::vector<OutlineEdge> outline = {});

/// The circle about the body's origin.
ArcEdge Circle(double radius);
/// The whole circle as one outline piece, material inside (convex) or outside (concave).
OutlineEdge FullCircle(Vec2 center, double radius, Side side);
/// A straight edge as one outline piece.
OutlineEdge WholeEdge(Vec2 a, Vec2 b);
/// Straight edges from each point to the next.
std::vector<OutlineEdge> Polyline(const std::vector<Vec2>& points);
/// The four sides of an axis-parallel box, material inside: bottom, right, top, left.
std::vector<OutlineEdge> Sides(Vec2 low, Vec2 high);

/// Two discs touch each other and the inside of an arc of radius `arc`, one after the other counter-clockwise. Returns
/// the unit direction from the arc's centre to the second disc's, given that to the first. In the triangle with sides
/// a = arc - r1, b = arc - r2 and r1 + r2, sin^2(angle / 2) = ((r1 + r2)^2 - (a - b)^2) / (4 a b), and a - b = r2 - r1.
Vec2 NextAlongArc(Vec2 direction, double r1, double r2, double arc);

/// Where circles of these radii about two centres meet: foot +- sqrt(square) Perp(unit), nowhere if square < 0.
struct CircleMeeting {
  Vec2 foot;  ///< on the line of centres
  Vec2 unit;  ///< from the first centre to the second
  double square = 0;

  Vec2 Left() const { return foot + std::sqrt(square) * Perp(unit); }
  Vec2 Right() const { return foot - std::sqrt(square) * Perp(unit); }
};
CircleMeeting MeetingOf(Vec2 center1, double reach1, Vec2 center2, double reach2);

/// The velocity of the body's material point at a world point.
Vec2 VelocityAt(const Body& body, Vec2 p);

/// Appends and returns the index; a body without a name gets "<kind> <index>".
int AddBody(ContactSystem* system, std::string_view kind, Body body);
/// Appends; the normal points from body 2 to body 1. A rod or rope gets the length that its vertices are apart now.
Constraint& AddConstraint(ContactSystem* system, ConstraintType type, int body1, const Feature& feature1, int body2,
                          const Feature& feature2);
inline Constraint& AddContact(ContactSystem* system, int body1, const Feature& feature1, int body2,
                              const Feature& feature2) {
  return AddConstraint(system, ConstraintType::kContact, body1, feature1, body2, feature2);
}

/// That component of body 1's velocity (x, y or omega: 0, 1, 2) with which the gap of the last constraint, a contact
/// or path joint, lasts, the component being 0 now.
double StillVelocity(const ContactSystem& system, std::size_t component);

/// How a scene is loaded. `weight` and `gust` are accelerations [m/s^2].
struct LoadLevel {
  /// In-plane gravity: kGravity for an upright plane, less for an inclined one. Sums of random gusts grow with a
  /// region's size, those of weights with its square: the higher a pile, the flatter the plane, or its weight would
  /// close every contact below the top layers.
  double weight = kGravity;
  /// Each movable body gets a random force of up to m gust in a random direction, and a random torque of up to m gust
  /// sqrt(I / m).
  double gust = kGravity;
};

/// The loads of the first and the last unilateral constraint, as gap accelerations that they alone would give [m/s^2]:
/// several times what the families' other loads and velocities amount to.
struct EndLoads {
  double squeeze = 100;
  double burst = 200;
};
/// Pulls the two sides of the first unilateral constraint together, and pushes those of the last apart, with equal and
/// opposite forces along its normal. Opposite forces of size l at a contact shift the lower bound of its force from 0
/// to l: if l exceeds the force that it would bear otherwise, the row separates for certain, and if -l is below it, the
/// row stays closed. So hardly a seed gives an active set of all rows or of none, however few rows there are.
void LoadEnds(ContactSystem* system, const EndLoads& loads = {});

}  // namespace lcpbench
