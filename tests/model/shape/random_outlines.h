#pragma once

#include "model/geometry/feature.h"
#include "model/shape/outline.h"
#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {

enum class EdgeKind { kStraight, kArc, kEllipse, kSuperellipse, kBezier };
inline constexpr int kEdgeKinds = 5;

inline int RandomInteger(int count, Random* random) {
  return static_cast<int>(random->Uniform(0, static_cast<double>(count)));
}

inline OutlinePiece Line(Vec2 a, Vec2 b) { return {StraightEdge{a, b}, 0, 1}; }

/// Corners counter-clockwise: the material is inside.
inline Outline Polygon(const std::vector<Vec2>& corners) {
  Outline outline{"polygon", {{}}};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    outline.loops[0].push_back(Line(corners[k], corners[(k + 1) % corners.size()]));
  }
  return outline;
}

/// Convex where the parameter grows.
inline OutlinePiece Arc(Vec2 center, double radius, double s_begin, double s_end) {
  return {ArcEdge{center, radius, s_begin < s_end ? Side::kConvex : Side::kConcave}, s_begin, s_end};
}

/// All lengths times `scale`.
inline OutlinePiece Scaled(OutlinePiece piece, double scale) {
  piece.edge = Scaled(piece.edge, scale);
  return piece;
}

inline Outline Scaled(Outline outline, double scale) {
  for (OutlineLoop& loop : outline.loops) {
    for (OutlinePiece& piece : loop) piece = Scaled(piece, scale);
  }
  return outline;
}

/// A piece from p to q that stays near its chord: a gently curved piece of the kind, anywhere, moved there by a
/// similarity.
inline OutlinePiece RandomPieceBetween(Vec2 p, Vec2 q, EdgeKind kind, Random* random) {
  if (kind == EdgeKind::kStraight) return {StraightEdge{p, q}, 0, 1};
  const bool convex = random->Uniform(0, 1) < 0.5;
  const Side side = convex ? Side::kConvex : Side::kConcave;
  const double low = random->Uniform(-3, 3);
  const double high = low + random->Uniform(0.3, 0.8);
  OutlinePiece piece{ArcEdge{{}, 1, side}, convex ? low : high, convex ? high : low};
  if (kind == EdgeKind::kEllipse) {
    piece.edge = EllipseEdge{{}, 1, random->Uniform(0.8, 1.3), random->Uniform(-3, 3), side};
  } else if (kind == EdgeKind::kSuperellipse) {
    const int m = 2 + 2 * RandomInteger(2, random);
    piece.edge = SuperellipseEdge{{}, 1, random->Uniform(0.8, 1.3), m, random->Uniform(-3, 3), side};
  } else if (kind == EdgeKind::kBezier) {
    piece.edge =
        BezierEdge{{Vec2{0, 0}, Vec2{1, random->Uniform(-0.3, 0.3)}, Vec2{2, random->Uniform(-0.3, 0.3)}, Vec2{3, 0}}};
    piece.s_begin = random->Uniform(0, 0.2);
    piece.s_end = random->Uniform(0.8, 1);
  }
  const Vec2 chord = CurvePoint(piece.edge, piece.s_end) - CurvePoint(piece.edge, piece.s_begin);
  const Vec2 wanted = q - p;
  piece = Scaled(piece, Norm(wanted) / Norm(chord));
  piece = Transformed(piece, AngleOf({Dot(chord, wanted), Cross(chord, wanted)}), {});
  return Transformed(piece, 0, p - CurvePoint(piece.edge, piece.s_begin));
}

/// Points around `center` in their order, with angles and distances that scatter: by `scatter` of the angle between two
/// and by `spread` of the radius.
inline std::vector<Vec2> RandomCorners(int count, Vec2 center, double radius, bool counter_clockwise, double scatter,
                                       double spread, Random* random) {
  std::vector<Vec2> corners;
  for (int k = 0; k < count; ++k) {
    const double turn = (k + random->Uniform(-scatter, scatter)) / count;
    const Vec2 u = UnitVector(2 * kPi * (counter_clockwise ? turn : -turn));
    corners.push_back(center + (radius * random->Uniform(1 - spread, 1 + spread)) * u);
  }
  return corners;
}

/// Random edges, of a kind that `kind()` gives, from corner to corner.
template <class Kind>
OutlineLoop RandomLoopThrough(const std::vector<Vec2>& corners, const Kind& kind, Random* random) {
  OutlineLoop loop;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    loop.push_back(RandomPieceBetween(corners[k], corners[(k + 1) % corners.size()], kind(), random));
  }
  return loop;
}

/// A closed loop of 5 to 9 random edges between vertices near the unit circle about `center` times `radius`.
inline OutlineLoop RandomLoop(Vec2 center, double radius, bool counter_clockwise, Random* random) {
  const int vertices = 5 + RandomInteger(5, random);
  return RandomLoopThrough(
      RandomCorners(vertices, center, radius, counter_clockwise, 0.15, 0.1, random),
      [&] { return static_cast<EdgeKind>(RandomInteger(kEdgeKinds, random)); }, random);
}

/// A valid outline of all kinds of edges, with up to two holes.
inline Outline RandomOutline(Random* random) {
  const Vec2 center = random->Vector(2);
  Outline outline{"random", {RandomLoop(center, 1, true, random)}};
  const int holes = RandomInteger(3, random);
  for (int k = 0; k < holes; ++k) {
    outline.loops.push_back(RandomLoop(center + Vec2{k == 0 ? -0.33 : 0.33, 0}, 0.2, false, random));
  }
  return outline;
}

}  // namespace lcpbench::testing
