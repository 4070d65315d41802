#include "model/shape/mass_properties.h"

#include "model/shape/outline_checks.h"

namespace lcpbench {

Outline Centered(const Outline& outline) { return Transformed(outline, 0, -ComputeMassProperties(outline, 1).center); }

Body MakeBody(const Outline& outline, double density) {
  RequireValid(outline);
  const MassProperties properties = ComputeMassProperties(outline, density);
  Body body;
  body.name = outline.name;
  body.mass = properties.mass;
  body.inertia = properties.inertia;
  body.x = properties.center;
  body.outline = AllPieces(Centered(outline));
  return body;
}

}  // namespace lcpbench
