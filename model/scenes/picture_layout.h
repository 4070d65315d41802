#pragma once

#include "model/assembly.h"
#include "model/system.h"

namespace lcpbench {

enum class EdgeKind { kStraight, kConvex, kConcave };

EdgeKind KindOf(const OutlineEdge& piece);
bool IsFullCircle(const OutlineEdge& piece);
/// Body-frame point of an outline piece at parameter s.
Vec2 PieceAt(const OutlineEdge& piece, double s);
Vec2 ToWorld(const Body& body, Vec2 p);

// All in pixels.
inline constexpr double kPageWidth = 900;
inline constexpr double kPagePadding = 20;
inline constexpr double kMaxDrawingHeight = 620;
inline constexpr double kStripGap = 10;

/// How the world is laid out on the page: `strips` windows of equal width, one below the other.
struct Layout {
  double scale = 1;   ///< [px/m]
  Vec2 top_left;      ///< world point at the drawing's upper left corner
  double width = 0;   ///< of one strip [px]
  double height = 0;  ///< of one strip [px]
  int strips = 1;
  double body_size = 0;  ///< median extent of the movable bodies [px]

  /// Measured from the upper left corner of the first strip, as if the strips were side by side.
  Vec2 ToPage(Vec2 p) const { return {(p.x - top_left.x) * scale, (top_left.y - p.y) * scale}; }
  double drawing_height() const { return strips * height + (strips - 1) * kStripGap; }
};

/// Fits movable bodies and contacts into kPageWidth x kMaxDrawingHeight. Rows much wider than high are broken into
/// strips.
Layout MakeLayout(const ContactSystem& system, const AssembledLcp& lcp);

}  // namespace lcpbench
