#pragma once

#include <span>

#include "model/contact/body.h"
#include "model/contact/system.h"

namespace lcpbench {

/// Moves the start values s1, s2 of path joints on general curves to where the joints are at the bodies' present
/// positions, so that the next search begins there: a search without a start value looks through the whole curve, and
/// may find another of its stationary points. Other constraints are left as they are.
/// @throws InputError as FindClosestPoints
void FollowPathJoints(std::span<const Body> bodies, std::span<Constraint> constraints);

}  // namespace lcpbench
