#pragma once

#include <vector>

#include "benchmarks/drawing/picture_outline.h"
#include "model/contact/assembly.h"
#include "model/contact/system.h"

namespace lcpbench {

// All in pixels.
inline constexpr double kPageWidth = 900;
inline constexpr double kPagePadding = 20;
inline constexpr double kMaxDrawingHeight = 620;
inline constexpr double kStripGap = 10;

/// An axis-parallel box; empty until a point is added.
class Bounds {
 public:
  void Add(Vec2 p);
  void Add(const Bounds& other);
  bool empty() const { return !(low_.x <= high_.x); }
  Vec2 low() const { return low_; }
  Vec2 high() const { return high_; }
  Vec2 size() const { return high_ - low_; }
  /// The longer side; 0 where empty.
  double extent() const;

 private:
  Vec2 low_{1e300, 1e300};
  Vec2 high_{-1e300, -1e300};
};

/// Of the outline and the centre of mass, world frame.
Bounds BoundsOf(const Body& body);

/// What a picture of these bodies should show: the movable ones and `points`, and of the fixed ones those that are not
/// much larger, such as races and drums; floors and walls are clipped.
Bounds ViewOf(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds, const std::vector<Vec2>& points);

/// Median extent of the movable bodies that have an outline [m]; 0 without any.
double MedianExtent(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds);

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
  PageMap MapOf(const Body& body) const { return {ToPage(body.x), scale, SinCos(body.theta), body.theta, true}; }
};

/// Fits what ViewOf says of the bodies, the rows and `more` points into kPageWidth x kMaxDrawingHeight. Rows much wider
/// than high are broken into strips.
Layout MakeLayout(const ContactSystem& system, const AssembledLcp& lcp, const std::vector<Vec2>& more);

}  // namespace lcpbench
