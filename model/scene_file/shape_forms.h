#pragma once

#include <optional>
#include <string>

#include "model/geometry/feature.h"
#include "model/scene_file/fields.h"
#include "model/shape/outline.h"
#include "model/shape/shapes.h"
#include "support/json_field.h"

namespace lcpbench {

/// An edge of a path, and the point where the next one begins: as the file states it, where it does.
struct DrawnEdge {
  OutlinePiece piece;
  Vec2 end;
};

/// Reads {"line" | "arc" | "ellipse" | "superellipse" | "bezier": {...}}, in any of the forms that docs/scene_files.md
/// lists. The piece passes RequireValidPiece. Derived centres and parameters: + - * / sqrt and AngleOf, the same bits
/// everywhere.
/// @param begin  where the edge before ends; without one, only forms that state their own begin are accepted. Such a
///               form need not begin at `begin` here: paths check that.
/// @throws InputError naming the JSON path
DrawnEdge ReadEdge(const JsonField& edge, std::optional<Vec2> begin);

/// Reads a list of points and edges, open or closed, that join.  @throws InputError naming the JSON path
OutlineLoop ReadPath(const JsonField& field);

/// What a body of a scene file looks like, in the frame it is drawn in.
struct SceneShape {
  Outline outline;
  /// Whether the outline bounds a plane shape (RequireValid of outline.h holds) rather than being "chains":
  /// curves, open or closed, that only a fixed body may have.
  bool is_region = true;
  MassProperties per_density;  ///< of a region, at density 1 kg/m^2
};

/// Reads a shape: ready-made, a path with holes, or chains; docs/scene_files.md lists the forms.
/// @param name  what errors call the outline
/// @throws InputError naming the JSON path, and for geometry the outline and the edge
SceneShape ReadShape(const JsonField& field, const std::string& name);

/// The whole curve, which ReadEdge reads back.
OrderedJson ToJson(const OutlineCurve& curve);
/// The path, which ReadPath reads back as the same edges.
OrderedJson ToJson(const OutlineLoop& loop);

}  // namespace lcpbench
