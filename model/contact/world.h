#pragma once

#include <string>
#include <vector>

#include "model/contact/body.h"
#include "model/contact/loads.h"
#include "model/contact/system.h"

namespace lcpbench {

/// The mechanics that a world moves by.
enum class MotionLevel {
  kAcceleration,  ///< forces from the contact LCP at every evaluation, events located, impacts simultaneous
  kVelocity,      ///< time stepping: one LCP of impulses a step, no events [Anitescu, Potra 1997]
};

/// The friction between two bodies, whichever of their edges touch.
struct PairFriction {
  int body1 = 0;
  int body2 = 1;
  double mu = 0;  ///< in [0, kMostFriction]
  bool operator==(const PairFriction&) const = default;
};

/// A mechanical system that can move: where a sequence of contact problems starts. Its contacts are not listed but
/// found from the bodies' outlines (detection.h) at every instant.
struct World {
  std::string name;
  /// Body::outline is the body's surface, its pieces valid as RequireValidPiece demands; no outline, no contact. Fixed
  /// bodies move as prescribed (kinematic): v and omega now, acceleration and alpha constant.
  std::vector<Body> bodies;
  /// Pins, path joints, rods and ropes; never kContact. Two bodies that share one do not touch each other.
  std::vector<Constraint> joints;
  Loads loads;
  /// Contacts of these pairs have this friction, whatever that of their bodies; a pair at most once.
  std::vector<PairFriction> friction;
  bool operator==(const World&) const = default;
};

/// The world of which `system` is one instant: its bodies, its constraints other than contacts, as loads the forces and
/// torques on its movable bodies, constant in the world's directions, and the friction of its contacts.
World WorldOf(const ContactSystem& system);

/// Whether any of its contacts can have friction.
bool HasFriction(const World& world);

/// One instant of `world`: its bodies under its loads, its joints, and the given contacts after them, with the world's
/// friction. Ropes whose ends coincide are left out.
ContactSystem InstantOf(const World& world, std::vector<Constraint> contacts);

/// @throws InputError naming the world and the body, joint or load: a mass or inertia that is not > 0, numbers that are
///         not finite, indices that are not those of two different bodies, a contact among the joints, a torque limit <
///         0 or of a joint that is no pin, an invalid path, friction outside [0, kMostFriction] or given twice
void RequireValid(const World& world);

}  // namespace lcpbench
