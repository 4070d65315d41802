#pragma once

#include <cstdint>

#include "model/contact/system.h"

namespace lcpbench {

// Changes of how edges are curved at the contacts of a system. Every edge is scaled about its own contact point: point,
// normal, gap, J and A stay (but for rounding), and b changes by the velocity-product terms alone.

/// Radii of curvature of the convex edges at contacts are multiplied by contrast^-u, u uniform in [0, 1]: convex edges
/// get smaller, so that they still fit where they lie in concave ones.
/// @param contrast  >= 1
/// @throws InputError for another contrast, and as AssembleContactLcp
void ContrastCurvature(ContactSystem* system, double contrast, std::uint64_t seed);

/// Every convex arc that lies in a concave one gets the radius (1 - clearance) R of that one: the contact is nearly
/// conformal, and gamma grows as 1 / clearance.
/// @param clearance  in (0, 1)
/// @throws InputError for another clearance, where no such pair is there, and as AssembleContactLcp
void MakeConformal(ContactSystem* system, double clearance);

}  // namespace lcpbench
