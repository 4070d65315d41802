#include "model/shape/outline.h"

namespace lcpbench {

Outline Transformed(const Outline& outline, double angle, Vec2 shift) {
  Outline moved = outline;
  for (OutlineLoop& loop : moved.loops) {
    for (OutlinePiece& piece : loop) piece = Transformed(piece, angle, shift);
  }
  return moved;
}

std::vector<OutlinePiece> AllPieces(const Outline& outline) {
  std::vector<OutlinePiece> pieces;
  for (const OutlineLoop& loop : outline.loops) pieces.insert(pieces.end(), loop.begin(), loop.end());
  return pieces;
}

std::string LoopName(const Outline& outline, std::size_t loop) {
  return "outline '" + outline.name + "', " + (loop == 0 ? "outer boundary" : "hole " + std::to_string(loop));
}

std::string PieceName(const Outline& outline, std::size_t loop, std::size_t piece) {
  return LoopName(outline, loop) + ", edge " + std::to_string(piece);
}

}  // namespace lcpbench
