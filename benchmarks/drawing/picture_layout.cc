#include "benchmarks/drawing/picture_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/geometry/feature.h"

namespace lcpbench {

void Bounds::Add(Vec2 p) {
  low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
  high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
}

void Bounds::Add(const Bounds& other) {
  if (other.empty()) return;
  Add(other.low_);
  Add(other.high_);
}

double Bounds::extent() const { return empty() ? 0 : std::max(size().x, size().y); }

Bounds BoundsOf(const Body& body) {
  constexpr int kSamples = 24;
  Bounds bounds;
  const Rotation rotation = SinCos(body.theta);
  for (const OutlineEdge& piece : body.outline) {
    for (int k = 0; k <= kSamples; ++k) {
      const double s = piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples;
      bounds.Add(body.x + Rotate(rotation, CurvePoint(piece.edge, s)));
    }
  }
  if (!body.fixed) bounds.Add(body.x);
  return bounds;
}

Bounds ViewOf(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds, const std::vector<Vec2>& points) {
  Bounds view;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed) view.Add(bounds[i]);
  }
  for (const Vec2 p : points) view.Add(p);
  constexpr double kMuchLarger = 3;
  const double largest = kMuchLarger * view.extent();
  Bounds whole = view;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].fixed && (view.empty() || bounds[i].extent() <= largest)) whole.Add(bounds[i]);
  }
  if (whole.empty()) whole.Add(Vec2{});
  return whole;
}

double MedianExtent(const std::vector<Body>& bodies, const std::vector<Bounds>& bounds) {
  std::vector<double> extents;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].fixed && !bodies[i].outline.empty()) extents.push_back(bounds[i].extent());
  }
  if (extents.empty()) return 0;
  const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
  std::nth_element(extents.begin(), middle, extents.end());
  return *middle;
}

Layout MakeLayout(const ContactSystem& system, const AssembledLcp& lcp, const std::vector<Vec2>& more) {
  std::vector<Bounds> bounds;
  bounds.reserve(system.bodies.size());
  for (const Body& body : system.bodies) bounds.push_back(BoundsOf(body));
  std::vector<Vec2> points = more;
  for (const RowInfo& row : lcp.rows) {
    points.push_back(row.p1);
    points.push_back(row.p2);
  }
  const Bounds view = ViewOf(system.bodies, bounds, points);
  const double median = MedianExtent(system.bodies, bounds);
  const double largest = std::max({view.extent(), median, std::numeric_limits<double>::min()});
  // A few bodies shall not fill the page: at least two median extents in view, with room around them.
  const double margin = std::max({0.04 * largest, 0.25 * median, (2 * median - largest) / 2});
  const Vec2 size = view.size() + Vec2{2 * margin, 2 * margin};

  constexpr double kWidth = kPageWidth - 2 * kPagePadding;
  Layout layout;
  // k strips are k^2 as high in total as one.
  layout.strips = std::max(1, static_cast<int>(std::sqrt(kMaxDrawingHeight * size.x / (kWidth * size.y))));
  if (layout.strips > 1) {
    // The margin belongs to the outer ends of the row, and above and below it.
    const double low_margin = std::min(margin, 0.1 * (view.size().y + median));
    layout.top_left = {view.low().x - low_margin, view.high().y + low_margin};
    const Vec2 trimmed = view.size() + Vec2{2 * low_margin, 2 * low_margin};
    layout.strips = std::max(2, static_cast<int>(std::sqrt(kMaxDrawingHeight * trimmed.x / (kWidth * trimmed.y))));
    layout.width = kWidth;
    layout.scale = kWidth * layout.strips / trimmed.x;
    layout.height = trimmed.y * layout.scale;
  } else {
    layout.scale = std::min(kWidth / size.x, kMaxDrawingHeight / size.y);
    layout.top_left = {view.low().x - margin, view.high().y + margin};
    layout.width = size.x * layout.scale;
    layout.height = size.y * layout.scale;
  }
  layout.body_size = median * layout.scale;
  return layout;
}

}  // namespace lcpbench
