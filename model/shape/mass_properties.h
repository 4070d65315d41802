#pragma once

#include "model/contact/body.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// The outline moved so that its centre of mass is the origin, as a body frame demands.
Outline Centered(const Outline& outline);

/// A movable body of that shape, at rest with its body frame on the outline's frame: x = centre of mass, theta = 0;
/// name, mass, inertia and outline (body frame, as of Centered(outline)) are set.
/// @throws InputError as RequireValid and ComputeMassProperties
Body MakeBody(const Outline& outline, double density);

}  // namespace lcpbench
