#pragma once

#include <optional>
#include <span>
#include <vector>

#include "model/contact/body.h"
#include "model/contact/forces.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// Everything that acts on the bodies of a world besides its constraints. Bodies by index, as in forces.h.
struct Loads {
  Vec2 gravity;  ///< on every movable body [m/s^2]
  std::vector<Spring> springs;
  std::vector<Damper> dampers;
  std::vector<Thruster> thrusters;
  std::vector<Wrench> wrenches;
  std::optional<MutualAttraction> attraction;
};

/// Sets force and torque of every body to the sum of all loads, in the order of the members above.
/// O(bodies + loads), with attraction O(bodies^2).
/// @throws InputError for loads that forces.h refuses
void SetLoads(const Loads& loads, std::span<Body> bodies);

/// Potential energy of the conservative loads [J]: gravity, springs, attraction, and wrenches, whose force is fixed in
/// the world: - F . p - torque theta. Dampers take energy away (DampingPower); thrusters, whose force turns with the
/// body, have none.
double PotentialEnergy(const Loads& loads, std::span<const Body> bodies);

/// The work per time that all dampers do [W], <= 0.
double DampingPower(const Loads& loads, std::span<const Body> bodies);

/// Sum of (m |v|^2 + I omega^2) / 2 over movable bodies [J].
double KineticEnergy(std::span<const Body> bodies);

/// Sum of m v over movable bodies [kg m/s].
Vec2 Momentum(std::span<const Body> bodies);

/// Sum of m x cross v + I omega over movable bodies, about the origin [kg m^2/s].
double AngularMomentum(std::span<const Body> bodies);

}  // namespace lcpbench
