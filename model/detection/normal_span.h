#pragma once

#include <optional>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// The directions from `first` counter-clockwise to `last`, unit vectors.
class NormalCone {
 public:
  /// @param angle  from first to last, 0..2 pi, to tell narrow from wide; a full turn contains everything
  NormalCone(Vec2 first, Vec2 last, double angle);

  Vec2 first() const { return first_; }
  Vec2 last() const { return last_; }
  /// All directions.
  bool is_full() const { return width_ == Width::kFull; }
  bool is_narrow() const { return width_ == Width::kNarrow; }
  /// Whether n is inside, or outside by at most `slack` [rad].
  bool Contains(Vec2 n, double slack) const;

 private:
  enum class Width { kNarrow, kWide, kFull };
  Vec2 first_;
  Vec2 last_;
  Width width_;
};

/// A part of a body's outline along which the outward normal turns one way only, so that a point is known by its
/// normal: a convex corner (the normal turns, the point stays), a straight edge (the reverse), an arc, or a part of a
/// general curve between its axes (oval) or inflections (Bezier) that turns by at most a quarter turn. A Bezier part
/// that hardly turns at all (kFlatTurn) counts as straight. A join is the end of a straight edge that goes over into a
/// convex curve without a corner: a point with one normal, for straight edges that lie flush (narrow_phase.h).
class NormalSpan {
 public:
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

  static NormalSpan OfVertex(Vec2 p, Vec2 first_normal, Vec2 last_normal, Rotation rotation);
  static NormalSpan OfJoin(Vec2 p, Vec2 normal, Rotation rotation);
  /// The part s_begin..s_end of an edge, as NormalCuts (feature.h) cuts it.
  static NormalSpan OfPiece(const OutlineCurve& curve, double s_begin, double s_end, Rotation rotation);

  Kind kind() const { return kind_; }
  bool is_round() const { return kind_ == Kind::kVertex || kind_ == Kind::kArc; }
  bool is_convex() const { return sign_ > 0; }
  /// Outward normals, world axes.
  const NormalCone& cone() const { return cone_; }
  /// The feature in the body frame.
  const Feature& feature() const { return feature_; }
  /// The signed radius of a vertex (0) or arc and the arm of its centre.
  double rho() const { return sign_ * radius_; }
  Vec2 center() const { return center_; }
  /// Ends, as arms in world axes; begin == end for a vertex.
  Vec2 begin() const { return begin_; }
  Vec2 end() const { return end_; }
  double chord() const { return Norm(end_ - begin_); }
  /// The lengths that points are computed from [m]: rounding errors are a few epsilon of it.
  double reach() const;
  /// The far ends of the straight edges that end at a vertex or join: of the one before it and of the one after it
  /// along the outline, as arms in world axes.
  const std::optional<Vec2>& straight_before() const { return straight_before_; }
  const std::optional<Vec2>& straight_after() const { return straight_after_; }
  /// Whether a straight edge goes over into a curve flatly (kFlatEnd) at this vertex or join.
  bool is_flat_end() const { return is_flat_end_; }
  /// Whether a curve goes over into a straight edge flatly (kFlatEnd) where its normal is n, within kSlack.
  bool IsFlatWhere(Vec2 n) const;
  /// World axes, relative to the body's centre of mass.
  BoundingBox Bounds() const;

  /// The point with outward normal n, in or near the cone; not for straight spans.
  SpanPoint At(Vec2 n) const;
  /// The curve parameter of a place, by correctly rounded functions.
  std::optional<double> Parameter(Vec2 place) const;
  /// The straight span's parameter at the fraction u of its length.
  std::optional<double> StraightParameter(double u) const;
  /// Records the neighbours of a vertex or join: of the spans before and after it, those that are straight.
  /// @param flat  one of them is straight, and the other one flat there
  static void Connect(NormalSpan* before, NormalSpan* vertex, NormalSpan* after, bool flat);
  /// Whether the foot of the span's curve at `arm`, with that outward normal, lies on the span (within kSlack).
  bool Holds(Vec2 arm, Vec2 outward) const;

 private:
  NormalSpan(Kind kind, const Feature& feature, NormalCone cone) : kind_(kind), feature_(feature), cone_(cone) {}

  Kind kind_;
  Feature feature_;
  NormalCone cone_;
  double sign_ = 1;  // -1 concave
  Vec2 begin_;
  Vec2 end_;
  Vec2 center_;  // vertex, arc, oval
  double radius_ = 0;
  double semi_axis_ = 0;  // the greater one of an oval
  OutlineCurve turned_;   // the edge in world axes
  TurnedPiece piece_;
  bool is_flat_end_ = false;             // vertex, join
  std::optional<Vec2> straight_before_;  // vertex, join
  std::optional<Vec2> straight_after_;
  std::vector<Vec2> flat_normals_;  // of a curve's ends that are flat joins
};

/// The spans of an outline placed by `rotation`, loop after loop, every piece followed by the vertex at its end where
/// that is a convex corner, or by a join. Other smooth joins and re-entrant corners have none, nor have the ends of
/// open chains.
/// @param outline  in the body frame, pieces valid (RequireValidPiece); loops may be open or run either way
std::vector<NormalSpan> NormalSpans(const Outline& outline, Rotation rotation);

}  // namespace lcpbench
