#pragma once

#include <optional>

#include "model/contact/contact_row.h"
#include "model/contact/system.h"
#include "model/geometry/vec2.h"
#include "model/shape/outline.h"

namespace lcpbench {

// What the families of mechanisms are built from, besides parts.h. Points p1, p2 are body-frame coordinates [m].

/// Two points kept together: two bilateral rows.
void AddPin(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2);
/// Two points kept at the distance they have now: one bilateral row.
void AddRod(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2);
/// Two points at most as far apart as they are now: one unilateral row, just taut.
void AddRope(ContactSystem* system, int body1, Vec2 p1, int body2, Vec2 p2);
/// A point of body 1 kept on an edge of body 2: one bilateral row. `s2`: where on the edge, for general curves.
void AddPathJoint(ContactSystem* system, int body1, Vec2 p1, int body2, const Feature& edge2,
                  std::optional<double> s2 = std::nullopt);

/// x + R(theta) p.
Vec2 WorldPoint(const Body& body, Vec2 p);
/// The body-frame coordinates of a world point.
Vec2 BodyPoint(const Body& body, Vec2 p);
/// The velocity of the body's material point at a world point.
Vec2 VelocityAt(const Body& body, Vec2 p);
/// Turns and moves the body, and sets its velocity to that of a rotation at `omega` about the world's origin.
void TurnAboutOrigin(Body* body, double omega);

/// The row of the last constraint, a contact or path joint, at the bodies' present velocities: d_dot is what a velocity
/// still has to cancel.
ContactRow LastRow(const ContactSystem& system);

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

/// The body's outline as a fixed body has it that turns about the drawing's origin.
Body MakeKinematic(std::string name, const Outline& outline);

}  // namespace lcpbench
