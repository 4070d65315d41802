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

/// Spans of a body, by their indices.
struct SpanRange {
  int first = 0;
  int count = 0;
};

/// Appends the local minima of the gap between spans of two bodies that lie in `range`, at most a few for each pair,
/// but for those of general curves that `minima` (of the same two bodies) holds already. Pairs of spans are told apart
/// by their boxes.
/// Where straight edges lie on each other, also the farther end of their overlap, flagged is_flush_end: a minimum it is
/// not, but a body at rest needs both ends. docs/geometry.md says how minima are found, and when ends are reported.
/// O(1) for closed forms (below a microsecond), some 10 to 100 microseconds for general curves.
/// @throws InputError naming both features, for a curvature match in `range`: D = 0 to rounding (kSingularD)
void FindGapMinima(const PlacedOutline& body1, SpanRange spans1, const PlacedOutline& body2, SpanRange spans2,
                   const GapRange& range, std::vector<GapMinimum>* minima);

/// All local minima between two bodies' spans, each once: of minima at a join of two edges, found from both within
/// their slack, the first (of a minimum and an end of flush edges the minimum).
/// @return in lexicographic order of (span1, span2)
std::vector<GapMinimum> FindGapMinima(const PlacedOutline& body1, const PlacedOutline& body2, const GapRange& range);

/// Sorts by (span1, span2) and keeps the first of minima that are the same point: feet within a few NormalSpan::kSlack
/// of the spans' lengths, and the same normal.
void RemoveRepeated(const PlacedOutline& body1, const PlacedOutline& body2, std::vector<GapMinimum>* minima);

}  // namespace lcpbench
