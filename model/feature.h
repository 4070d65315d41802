#pragma once

#include <variant>

#include "model/vec2.h"

namespace lcpbench {

/// Which side of a closed curve holds the material: convex = inside, concave = outside.
enum class Side { kConvex, kConcave };

/// Body-frame features of an outline. Features are meant locally, around a contact point: a straight edge stands for
/// its line, an arc for its circle.
struct Vertex {
  Vec2 p;
};

/// From a to b with the material on the left; the outward normal is on the right-hand side.
struct StraightEdge {
  Vec2 a;
  Vec2 b;
};

/// center + radius (cos s, sin s); radius > 0. Signed curvature +1/radius (convex) or -1/radius (concave).
struct ArcEdge {
  Vec2 center;
  double radius = 1;
  Side side = Side::kConvex;
};

/// A closed set: a new kind fails to compile until every visitor handles it.
using Feature = std::variant<Vertex, StraightEdge, ArcEdge>;

/// The piece s_begin..s_end of an edge (a + s (b - a), or center + radius (cos s, sin s)): one part of a body's
/// outline. Counter-clockwise around the material: s_begin < s_end on convex arcs and straight edges, s_begin > s_end
/// on concave.
struct OutlineEdge {
  std::variant<StraightEdge, ArcEdge> edge;
  double s_begin = 0;
  double s_end = 1;
};

}  // namespace lcpbench
