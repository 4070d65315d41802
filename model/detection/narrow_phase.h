#pragma once

#include <optional>
#include <vector>

#include "model/contact/closest_points.h"
#include "model/detection/normal_span.h"

namespace lcpbench {

/// Gaps that count as contact: -penetration <= d <= gap [m], both >= 0.
struct GapRange {
  double gap = 0;
  double penetration = 0;
};

/// A body's outline in the world, ready for the narrow phase.
struct PlacedOutline {
  std::vector<NormalSpan> spans;
  std::vector<BoundingBox> boxes;  ///< of the spans, world axes, relative to x
  Vec2 x;                          ///< the body's centre of mass [m]
  Rotation rotation;               ///< SinCos(theta)
};

/// @param outline  in the body frame (NormalSpans)
PlacedOutline PlaceOutline(const Outline& outline, Vec2 x, double theta);

/// A local minimum of the gap between two spans, or an end of flush straight edges.
struct GapMinimum {
  int span1 = 0;  ///< index into PlacedOutline::spans of body 1
  int span2 = 0;
  ClosestPoints closest;
  /// Where along general curves the search for it starts; none for straight edges, arcs, vertices.
  std::optional<double> s1;
  std::optional<double> s2;
  /// An end of nearly flush straight edges that is no minimum: the gap falls along both edges.
  bool is_flush_end = false;
};

/// Appends the local minima of the gap between two spans that lie in `range`, at most a few, but for those of general
/// curves that `minima` (of the same two bodies) holds already.
///
/// With n from body 2 to body 1, p2(n) the point of span 2 with outward normal n and p1(n) that of span 1 with -n, the
/// gap's stationary points are the zeros of g(n) = t.(p1 - p2), t = Perp(n), over the directions that both spans have
/// (a vertex has its whole cone). Along them g' = -(rho1 + rho2 + d), of the sign of -D kappa1 kappa2: where D keeps
/// its sign, g has one zero at most, which a change of sign brackets. So the directions are halved
///   until the parts of the spans are proved to be further apart than the range (boxes along n and t around both
///   parts' chords and the triangles of their end tangents), or
///   until they are narrow (kNarrow) and D has one sign at their ends; D > 0 and a change of sign of g is a minimum.
/// Each is narrowed by the Illinois variant of the regula falsi and finished by FindClosestPoints' search.
/// Straight edges have one normal and need no halving; vertices and arcs against each other have closed forms.
/// What cannot be a minimum is not looked at: straight/straight, vertex/vertex, concave/concave or concave/straight.
///
/// Straight edges that lie on each other touch at both ends of their overlap, which is the one exception to "minima
/// only". Tilted by any angle they have one minimum, at or beyond the nearer end; but within a tolerance both ends are
/// contacts, and a body at rest needs both. So the farther end is reported too, as vertex against straight edge
/// [MODEL.md section 5], flagged is_flush_end, where
///   the edges face each other at an angle of sine <= 1e-2, and
///   the gaps at both ends of their overlap (along the edge that does not end there) are within the range, and
///   the edge that ends there ends in a vertex or goes over smoothly into a convex curve (NormalSpan's joins; not at a
///   re-entrant corner, whose other edge is in the way).
/// Which end is farther is left to rounding where the gaps are equal; what is then found twice, RemoveRepeated removes.
/// A straight edge that goes over flatly into a curve (NormalSpan::kFlatEnd: D = 0 there) ends at the join, as far as
/// edges are concerned that are flush within NormalSpan::kSlack.
///
/// O(1) for closed forms (below a microsecond), some 10 to 100 microseconds for general curves.
/// @throws InputError naming both features, for a curvature match in `range`: D = 0 to rounding (kSingularD)
void FindGapMinima(const PlacedOutline& body1, int span1, const PlacedOutline& body2, int span2, const GapRange& range,
                   std::vector<GapMinimum>* minima);

/// All local minima between two bodies' spans, each once: of minima at a join of two edges, found from both within
/// their slack, the first (of a minimum and an end of flush edges the minimum). Pairs of spans are told apart by their
/// boxes, many of them by the sorted sweep.
/// @return in lexicographic order of (span1, span2)
std::vector<GapMinimum> FindGapMinima(const PlacedOutline& body1, const PlacedOutline& body2, const GapRange& range);

/// Sorts by (span1, span2) and keeps the first of minima that are the same point: feet within a few NormalSpan::kSlack
/// of the spans' lengths, and the same normal.
void RemoveRepeated(const PlacedOutline& body1, const PlacedOutline& body2, std::vector<GapMinimum>* minima);

}  // namespace lcpbench
