#pragma once

#include <cstdint>

#include "model/contact/loads.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

// How the one-problem form of a scene becomes a world that starts moving: its bodies and joints, under other loads than
// the unbalanced ones of that form, which would blow the bodies apart.

/// The world of which `system` is one instant, under `loads` alone.
World SetInMotion(ContactSystem system, Loads loads);

/// SetInMotion under gravity [m/s^2].
World WorldUnderGravity(ContactSystem system, Vec2 gravity);

/// Random velocities of bodies that lie still otherwise [m/s]: of centres of mass, and of points one radius of gyration
/// away by spin. Small against the speeds of falling by a body's size (1 to 2 m/s), so that contacts last.
inline constexpr double kStir = 0.1;

/// Adds a random velocity of up to `speed` in a random direction, and a spin of up to speed / sqrt(I / m), to every
/// movable body, in body order. The same seed gives the same bits.
void Stir(World* world, double speed, std::uint64_t seed);

}  // namespace lcpbench
