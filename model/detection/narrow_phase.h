#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "model/contact/closest_points.h"
#include "model/detection/normal_span.h"
#include "model/geometry/broad_phase.h"

namespace lcpbench {

/// Called again and again by what may take long; what it throws ends that.
using StopCheck = std::function<void()>;

/// Gaps that count as contact: -penetration <= d <= gap [m], both >= 0.
struct GapRange {
  double gap = 0;
  double penetration = 0;
};

/// Directions from the angle `begin` on, counter-clockwise [rad]; 2 pi wide for all of them.
struct DirectionRange {
  double begin = 0;
  double width = 0;
};

/// What a run of spans lies in.
struct SpanBound {
  BoundingBox box;         ///< world axes, relative to the body's x
  DirectionRange normals;  ///< to rounding; of spans that are neither straight nor points, all
};

/// A body's outline in the world, ready for the narrow phase.
struct PlacedOutline {
  std::vector<NormalSpan> spans;
  std::vector<BoundingBox> boxes;  ///< of the spans, world axes, relative to x
  BoundingBox whole;               ///< around all of them
  std::vector<SpanBound> bounds;   ///< of the spans, and a tree over them, if there are more than kManySpans
  std::optional<RunTree<SpanBound>> tree;
  Vec2 x;             ///< the body's centre of mass [m]
  Rotation rotation;  ///< SinCos(theta)
};
inline constexpr std::size_t kManySpans = 32;

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
  /// An end of nearly flush straight edges that is not a minimum: the gap falls along both edges.
  bool is_flush_end = false;
};

/// All local minima of the gap between two bodies' spans that lie in `range`, each once: of minima at a join of two
/// edges, found from both within their slack, the first (of a minimum and an end of flush edges the minimum). Pairs of
/// spans are told apart by their boxes, of long outlines by those of runs of spans and by the directions they face:
/// O(n log n) for two bodies of n spans that touch at a few places.
/// Where straight edges lie on each other, also the farther end of their overlap, flagged is_flush_end: a minimum it is
/// not, but a body at rest needs both ends. docs/geometry.md says how minima are found, and when ends are reported.
/// A pair takes below a microsecond in closed form, some 10 to 100 microseconds with general curves.
/// @param check  called now and then
/// @return in lexicographic order of (span1, span2)
/// @throws InputError naming both features, for a curvature match in `range`: D = 0 to rounding (kSingularD)
std::vector<GapMinimum> FindGapMinima(
    const PlacedOutline& body1, const PlacedOutline& body2, const GapRange& range, const StopCheck& check = [] {});

}  // namespace lcpbench
