#include "model/scenes/picture_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "model/outline_piece.h"
#include "model/scenes/parts.h"
#include "model/trig.h"

namespace lcpbench {
namespace {

struct Bounds {
  Vec2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  void Add(Vec2 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  bool empty() const { return !(low.x <= high.x); }
  Vec2 size() const { return high - low; }
};

void AddOutline(const Body& body, Bounds* bounds) {
  constexpr int kSamples = 24;
  for (const OutlineEdge& piece : body.outline) {
    for (int k = 0; k <= kSamples; ++k) {
      bounds->Add(ToWorld(body, PieceAt(piece, piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples)));
    }
  }
}

}  // namespace

EdgeKind KindOf(const OutlineEdge& piece) {
  struct Visitor {
    EdgeKind operator()(const StraightEdge& /*edge*/) const { return EdgeKind::kStraight; }
    // A free-form edge may turn either way; its ends tell which way it turns on the whole.
    EdgeKind operator()(const BezierEdge& edge) const {
      return Cross(edge.P[1] - edge.P[0], edge.P[3] - edge.P[2]) >= 0 ? EdgeKind::kConvex : EdgeKind::kConcave;
    }
    EdgeKind operator()(const ArcEdge& edge) const { return Of(edge.side); }
    EdgeKind operator()(const EllipseEdge& edge) const { return Of(edge.side); }
    EdgeKind operator()(const SuperellipseEdge& edge) const { return Of(edge.side); }
    static EdgeKind Of(Side side) { return side == Side::kConvex ? EdgeKind::kConvex : EdgeKind::kConcave; }
  };
  return std::visit(Visitor{}, piece.edge);
}

bool IsFullCircle(const OutlineEdge& piece) {
  return std::holds_alternative<ArcEdge>(piece.edge) && std::abs(piece.s_end - piece.s_begin) >= 2 * kPi * (1 - 1e-9);
}

/// Body-frame point of an outline piece at parameter s.
Vec2 PieceAt(const OutlineEdge& piece, double s) { return CurvePoint(piece.edge, s); }

Vec2 ToWorld(const Body& body, Vec2 p) { return body.x + Rotate(SinCos(body.theta), p); }

Layout MakeLayout(const ContactSystem& system, const AssembledLcp& lcp) {
  Bounds view;
  std::vector<double> extents;
  for (const Body& body : system.bodies) {
    if (body.fixed) continue;
    Bounds own;
    own.Add(body.x);
    AddOutline(body, &own);
    view.Add(own.low);
    view.Add(own.high);
    extents.push_back(std::max(own.size().x, own.size().y));
  }
  for (const RowInfo& row : lcp.rows) {
    view.Add(row.p1);
    view.Add(row.p2);
  }
  if (view.empty()) view.Add({});
  double median = 0;
  if (!extents.empty()) {
    const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
    std::nth_element(extents.begin(), middle, extents.end());
    median = *middle;
  }
  const double largest = std::max({view.size().x, view.size().y, median, std::numeric_limits<double>::min()});
  // A few bodies shall not fill the page: at least three median extents in view.
  const double margin = std::max({0.04 * largest, 0.25 * median, (3 * median - largest) / 2});
  const Vec2 size = view.size() + Vec2{2 * margin, 2 * margin};

  constexpr double kWidth = kPageWidth - 2 * kPagePadding;
  Layout layout;
  // k strips are k^2 as high in total as one.
  layout.strips = std::max(1, static_cast<int>(std::sqrt(kMaxDrawingHeight * size.x / (kWidth * size.y))));
  if (layout.strips > 1) {
    // The margin belongs to the outer ends of the row, and above and below it.
    const double low_margin = std::min(margin, 0.1 * (view.size().y + median));
    layout.top_left = {view.low.x - low_margin, view.high.y + low_margin};
    const Vec2 trimmed = view.size() + Vec2{2 * low_margin, 2 * low_margin};
    layout.strips = std::max(2, static_cast<int>(std::sqrt(kMaxDrawingHeight * trimmed.x / (kWidth * trimmed.y))));
    layout.width = kWidth;
    layout.scale = kWidth * layout.strips / trimmed.x;
    layout.height = trimmed.y * layout.scale;
  } else {
    layout.scale = std::min(kWidth / size.x, kMaxDrawingHeight / size.y);
    layout.top_left = {view.low.x - margin, view.high.y + margin};
    layout.width = size.x * layout.scale;
    layout.height = size.y * layout.scale;
  }
  layout.body_size = median * layout.scale;
  return layout;
}

}  // namespace lcpbench
