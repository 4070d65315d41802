#pragma once

#include <string>

#include "model/shape/mass_properties.h"
#include "model/shape/outline.h"
#include "support/json_field.h"

namespace lcpbench {

/// What a body of a scene file looks like, in the frame it is drawn in.
struct SceneShape {
  Outline outline;
  /// Whether the outline bounds a plane shape (RequireValid of outline_checks.h holds) rather than being "chains":
  /// curves, open or closed, that only a fixed body may have.
  bool is_region = true;
  MassProperties per_density;  ///< of a region, at density 1 kg/m^2
};

/// Reads a shape: ready-made, a path with holes, or chains; scene_file.h lists the forms.
/// @param name  what errors call the outline
/// @throws InputError naming the JSON path, and for geometry the outline and the edge
SceneShape ReadShape(const JsonField& field, const std::string& name);

}  // namespace lcpbench
