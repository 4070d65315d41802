#pragma once

#include <array>
#include <variant>

#include "model/geometry/vec2.h"

namespace lcpbench {

/// Which side of a closed curve holds the material: convex = inside, concave = outside.
enum class Side { kConvex, kConcave };

/// Body-frame features of an outline. Features are meant locally, around a contact point: a straight edge stands for
/// its line, an arc for its circle, an ellipse or superellipse for the whole oval; a Bezier curve ends at s = 0 and 1.
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

/// center + R(phi) (a cos s, b sin s); semi-axes a, b > 0, in either order.
struct EllipseEdge {
  Vec2 center;
  double a = 1;
  double b = 1;
  double phi = 0;  ///< [rad] from the body's x axis to the semi-axis a
  Side side = Side::kConvex;
};

/// center + R(phi) r(s) (cos s, sin s), r(s) = ((cos s/a)^m + (sin s/b)^m)^(-1/m): s is the polar angle. m even, >= 2;
/// m = 2 is an ellipse (with another parameter), and for m > 2 the curvature is 0 where the curve crosses its axes.
struct SuperellipseEdge {
  Vec2 center;
  double a = 1;
  double b = 1;
  int m = 4;
  double phi = 0;  ///< [rad] as of the ellipse
  Side side = Side::kConvex;
};

/// The cubic Bezier curve of the control points P, s in [0, 1], material on the left of increasing s. It may turn
/// either way, so the sign of its curvature varies along it. Its speed |c'| must not vanish.
struct BezierEdge {
  std::array<Vec2, 4> P;
};

/// A closed set: a new kind fails to compile until every visitor handles it.
using Feature = std::variant<Vertex, StraightEdge, ArcEdge, EllipseEdge, SuperellipseEdge, BezierEdge>;

/// The edges that outlines are made of. A closed set, too.
using OutlineCurve = std::variant<StraightEdge, ArcEdge, EllipseEdge, SuperellipseEdge, BezierEdge>;

/// The piece s_begin..s_end of an edge, by the parameter s of its declaration: one part of a body's outline. The
/// material lies on the left of the direction of travel: s_begin < s_end on straight and Bezier edges and on convex
/// curves, s_begin > s_end on concave curves.
struct OutlineEdge {
  OutlineCurve edge;
  double s_begin = 0;
  double s_end = 1;
};

}  // namespace lcpbench
