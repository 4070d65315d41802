#pragma once

#include <optional>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// The directions from `first` counter-clockwise to `last`, unit vectors.
struct NormalCone {
  /// @param angle  from begin to end, 0..2 pi, to tell narrow (up to pi) from wide; a full turn contains everything
  NormalCone(Vec2 begin, Vec2 end, double angle);
  /// Whether n is inside, or outside by at most `slack` [rad].
  bool Contains(Vec2 n, double slack) const;

  Vec2 first;
  Vec2 last;
  bool is_narrow;
  bool is_full;  ///< all directions
};

/// A part of a body's outline along which the outward normal turns one way only, so that a point is known by its
/// normal: a convex corner (the normal turns, the point stays), a straight edge (the reverse), an arc, or a part of a
/// general curve between its axes (oval) or inflections (Bezier) that turns by at most a quarter turn. A Bezier part
/// that hardly turns at all (kFlatTurn) counts as straight. A join is the end of a straight edge that goes over into a
/// convex curve without a corner: a point with one normal, for straight edges that lie flush (narrow_phase.h).
/// Points are arms from the body's centre of mass, in world axes.
struct NormalSpan {
  /// What the span is a part of.
  enum class Kind { kVertex, kJoin, kStraight, kArc, kCurve };

  /// Feet may lie this far beyond a span's ends, relative to its chord, and normals beyond its cone [rad]: what joins
  /// are open by, and how much straight edges may lack to count as flush.
  static constexpr double kSlack = 1e-9;
  /// Parts of Bezier curves that turn by less [rad] are searched as straight edges.
  static constexpr double kFlatTurn = 1e-7;
  /// A curve whose curvature, times its size, is less where it joins a straight edge goes over into it flatly: no
  /// contact point can be found by its normal there. Turned by kSlack, a curve of at least this curvature moves its
  /// contact point by 1e-5 of its size, and its gap by 1e-14.
  static constexpr double kFlatEnd = 1e-4;

  NormalSpan(Kind of_kind, const Feature& of_feature, const NormalCone& normals)
      : kind(of_kind), feature(of_feature), cone(normals) {}

  Kind kind;
  Feature feature;  ///< body frame
  NormalCone cone;  ///< outward normals
  double sign = 1;  ///< -1 concave
  Vec2 begin;       ///< begin == end for a vertex or join
  Vec2 end;
  Vec2 center;           ///< vertex, join, arc, oval
  double radius = 0;     ///< of an arc
  double semi_axis = 0;  ///< the greater one of an oval
  OutlineCurve turned;   ///< the edge in world axes
  TurnedPiece piece;
  /// For a vertex or join: whether a straight edge goes over into a curve flatly (kFlatEnd) there, and the far ends of
  /// the straight edges before and after it along the outline.
  bool is_flat_end = false;
  std::optional<Vec2> straight_before;
  std::optional<Vec2> straight_after;
  std::vector<Vec2> flat_normals;  ///< of a curve, at those of its ends that are flat joins

  bool is_point() const { return kind == Kind::kVertex || kind == Kind::kJoin; }
  bool is_round() const { return kind == Kind::kVertex || kind == Kind::kArc; }
  bool is_convex() const { return sign > 0; }
  /// The signed radius of a vertex (0) or arc.
  double rho() const { return sign * radius; }
  double chord() const { return Norm(end - begin); }
  /// The lengths that points are computed from [m]: rounding errors are a few epsilon of it.
  double reach() const { return Norm(center) + radius + Norm(begin) + Norm(end) + semi_axis; }
  /// Whether a curve goes over into a straight edge flatly (kFlatEnd) where its normal is n, within kSlack.
  bool IsFlatWhere(Vec2 n) const;
  BoundingBox Bounds() const;

  /// The point with outward normal n, in or near the cone; not for straight spans.
  SpanPoint At(Vec2 n) const;
  /// The curve parameter of a place, by correctly rounded functions.
  std::optional<double> Parameter(Vec2 place) const;
  /// The straight span's parameter at the fraction u of its length.
  std::optional<double> StraightParameter(double u) const;
  /// Whether the foot of the span's curve at `arm`, with that outward normal, lies on the span (within kSlack).
  bool Holds(Vec2 arm, Vec2 outward) const;
};

/// The spans of an outline placed by `rotation`, loop after loop, every piece followed by the vertex at its end where
/// that is a convex corner, or by a join. Other smooth joins and re-entrant corners have none, nor have the ends of
/// open chains.
/// @param outline  in the body frame, pieces valid (RequireValidPiece); loops may be open or run either way
std::vector<NormalSpan> NormalSpans(const Outline& outline, Rotation rotation);

}  // namespace lcpbench
