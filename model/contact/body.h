#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/geometry/feature.h"

namespace lcpbench {

/// The largest coefficient of friction: more is a number gone wrong.
inline constexpr double kMostFriction = 1e6;

/// A rigid body's inertia, state and load. World frame, z out of the page, angles counter-clockwise, SI units.
/// The body frame's origin is the centre of mass: a body-frame point c is at x + R(theta) c. [docs/model.md section 1]
struct Body {
  std::string name;
  double mass = 1;     ///< [kg] > 0
  double inertia = 1;  ///< [kg m^2] about the centre of mass, > 0
  /// Inverse mass and inertia are 0; the velocity may still be non-zero (kinematic body).
  bool fixed = false;
  Vec2 x;             ///< centre of mass [m]
  double theta = 0;   ///< [rad]
  Vec2 v;             ///< [m/s]
  double omega = 0;   ///< [rad/s]
  Vec2 force;         ///< applied at the centre of mass [N]
  double torque = 0;  ///< [N m]
  /// Prescribed acceleration of a fixed body [m/s^2], [rad/s^2]; enters b through J. Ignored for movable bodies.
  Vec2 acceleration;
  double alpha = 0;
  /// Coefficient of friction of the surface, in [0, kMostFriction]. A contact that is found has sqrt(mu1 mu2), unless
  /// the world gives the pair another (world.h).
  double friction = 0;
  /// Speed of the surface along the outline of a fixed body, as of a conveyor's belt [m/s]: > 0 the way that edges run,
  /// counter-clockwise around the material. Friction acts on the slip relative to it.
  double surface_speed = 0;
  /// What the body looks like, for pictures; assembly reads the constraints' features only.
  std::vector<OutlineEdge> outline;
  bool operator==(const Body&) const = default;
};

/// The world point of the body-frame point c.
inline Vec2 WorldPoint(const Body& body, Vec2 c) { return body.x + Rotate(SinCos(body.theta), c); }

/// The body-frame point that lies at the world point p.
inline Vec2 BodyPoint(const Body& body, Vec2 p) { return RotateBack(SinCos(body.theta), p - body.x); }

/// "body 3 'name'", for error texts.
std::string BodyText(std::span<const Body> bodies, std::size_t i);

/// Whether bodies can be assembled: finite numbers; masses and inertias of movable ones > 0, with finite inverses.
/// @throws InputError naming the condition and the body, after `where`
void RequireValid(std::span<const Body> bodies, const std::string& where);

}  // namespace lcpbench
