#pragma once

#include <optional>

#include "model/geometry/feature.h"
#include "support/json_field.h"

namespace lcpbench {

/// An edge of a path, and the point where the next one begins: as the file states it, where it does.
struct DrawnEdge {
  OutlinePiece piece;
  Vec2 end;
};

/// Reads {"line" | "arc" | "ellipse" | "superellipse" | "bezier": {...}}, in any of the forms that scene_file.h lists.
/// The piece passes RequireValidPiece. Derived centres and parameters: + - * / sqrt and AngleOf, the same bits
/// everywhere.
/// @param begin  where the edge before ends; without one, only forms that state their own begin are accepted. Such a
///               form need not begin at `begin` here: paths check that.
/// @throws InputError naming the JSON path
DrawnEdge ReadEdge(const JsonField& edge, std::optional<Vec2> begin);

}  // namespace lcpbench
