#pragma once

#include <string>
#include <vector>

#include "model/geometry/feature.h"

namespace lcpbench {

/// A closed curve of pieces, each beginning where the one before ends; a vertex lies at every such joint. One piece is
/// enough if it closes on itself (a full circle).
using OutlineLoop = std::vector<OutlinePiece>;

/// The boundary of a plane shape, in a frame of its own [m]: loops[0] is the outer boundary, counter-clockwise; every
/// further loop is a hole, clockwise. So the material is on the left of every piece.
struct Outline {
  std::string name;
  std::vector<OutlineLoop> loops;
};

/// c -> R(angle) c + shift for every point. A rotation adds its angle to curve parameters and to phi, so that joints
/// may open by rounding.
Outline Transformed(const Outline& outline, double angle, Vec2 shift);

/// All pieces, loop after loop.
std::vector<OutlinePiece> AllPieces(const Outline& outline);

/// "outline 'name', outer boundary, edge 3" or "outline 'name', hole 1, edge 0", for error texts.
std::string PieceName(const Outline& outline, std::size_t loop, std::size_t piece);
/// "outline 'name', outer boundary" or "outline 'name', hole 1".
std::string LoopName(const Outline& outline, std::size_t loop);

}  // namespace lcpbench
