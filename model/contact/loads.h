#pragma once

#include <optional>
#include <span>
#include <vector>

#include "model/contact/body.h"

namespace lcpbench {

// Applied forces. Every Apply function adds to Body::force (at the centre of mass, world frame) and Body::torque.
// Bodies are named by their index; points by body-frame coordinates, a body-frame point c lying at x + R(theta) c.
// Forces between two bodies act with equal and opposite amounts along one line, so that they add up to no force and no
// torque. Fixed bodies are loaded like others: it has no effect on them, and is the reaction they bear; uniform gravity
// leaves them out. Only + - * / sqrt and correctly rounded sines: the same bits everywhere. Energies are those whose
// loss is the work done. @throws InputError, naming the force and the body, for an index out of range, parameters that
// are not finite (or negative where that makes no sense), and an undefined direction. O(1) unless said otherwise.

/// A point of a body.
struct Attachment {
  int body = 0;
  Vec2 point;  ///< body frame [m]
  bool operator==(const Attachment&) const = default;
};

/// Sets force and torque of every body to 0. O(n).
void ClearLoads(std::span<Body> bodies);

/// A linear spring between two points: pulls with stiffness (length - rest_length). With rest_length = 0 it is defined
/// at length 0 too; otherwise its direction is undefined there, which is an error.
struct Spring {
  Attachment end1;
  Attachment end2;
  double stiffness = 1;    ///< [N/m] >= 0
  double rest_length = 0;  ///< [m] >= 0
  bool operator==(const Spring&) const = default;
};
void ApplySpring(const Spring& spring, std::span<Body> bodies);

/// A linear damper (dashpot) between two points: resists the rate of change of their distance with coefficient times
/// that rate. Its power is - coefficient rate^2 <= 0. Length 0 is an error.
struct Damper {
  Attachment end1;
  Attachment end2;
  double coefficient = 1;  ///< [N s/m] >= 0
  bool operator==(const Damper&) const = default;
};
void ApplyDamper(const Damper& damper, std::span<Body> bodies);

/// A force fixed in a body: turns with it.
struct Thruster {
  Attachment at;
  Vec2 force;  ///< body frame [N]
  bool operator==(const Thruster&) const = default;
};

/// Attraction between the centres of mass of all pairs of bodies, as between far-apart balls: strength m1 m2 / r^2. A
/// softening length e makes it strength m1 m2 r / (r^2 + e^2)^(3/2), finite for all distances [Aarseth 1963]; without
/// it coincident centres are an error.
struct MutualAttraction {
  double strength = 1;   ///< [N m^2/kg^2]; negative repels
  double softening = 0;  ///< [m] >= 0
  bool operator==(const MutualAttraction&) const = default;
};
/// O(n^2), pairs in order of indices.
void ApplyMutualAttraction(const MutualAttraction& attraction, std::span<Body> bodies);

/// A force at a point of a body and a torque, both fixed in the world's directions.
struct Wrench {
  Attachment at;
  Vec2 force;         ///< world frame [N]
  double torque = 0;  ///< [N m], besides the force's own moment
  bool operator==(const Wrench&) const = default;
};

/// Everything that acts on the bodies of a world besides its constraints.
struct Loads {
  Vec2 gravity;  ///< on every movable body [m/s^2]
  std::vector<Spring> springs;
  std::vector<Damper> dampers;
  std::vector<Thruster> thrusters;
  std::vector<Wrench> wrenches;
  std::optional<MutualAttraction> attraction;
  bool operator==(const Loads&) const = default;
};

/// Sets force and torque of every body to the sum of all loads, in the order of the members above.
/// O(bodies + loads), with attraction O(bodies^2).
/// @throws InputError for loads that are refused above
void SetLoads(const Loads& loads, std::span<Body> bodies);

/// Potential energy of the conservative loads [J]: gravity, springs, attraction, and wrenches, whose force is fixed in
/// the world: - F . p - torque theta. Dampers take energy away; thrusters, whose force turns with the
/// body, have none.
double PotentialEnergy(const Loads& loads, std::span<const Body> bodies);

/// Sum of (m |v|^2 + I omega^2) / 2 over movable bodies [J].
double KineticEnergy(std::span<const Body> bodies);

}  // namespace lcpbench
