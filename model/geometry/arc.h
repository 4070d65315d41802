#pragma once

#include "model/geometry/curve.h"

namespace lcpbench {

/// center + radius (cos s, sin s); radius > 0. Signed curvature +1/radius (convex) or -1/radius (concave).
struct ArcEdge {
  static constexpr const char* kName = "arc";
  static constexpr CurveKind kKind = CurveKind::kArc;
  static constexpr bool kIsAngle = true;
  Vec2 center;
  double radius = 1;
  Side side = Side::kConvex;

  static constexpr std::tuple kFields = {Field{"center", &ArcEdge::center}, Field{"radius", &ArcEdge::radius},
                                         Field{"side", &ArcEdge::side}};
  bool operator==(const ArcEdge&) const = default;
  std::string WhyInvalid() const {
    if (!(radius > 0)) return "the radius must be > 0";
    return std::isfinite(1 / radius) ? "" : "the curvature 1/radius overflows";
  }
  double Reach(double angle) const { return Largest(center) + angle * radius; }

  Vec2 Point(double s) const {
    const Rotation u = SinCos(s);
    return center + Vec2{radius * u.cos, radius * u.sin};
  }
  Vec2 Direction(double s) const {
    const Rotation u = SinCos(s);
    return {-u.sin, u.cos};
  }
  double AngleAt(Vec2 p) const { return AngleOf(p - center); }
  SpanPoint AtNormal(Vec2 n, const TurnedPiece& /*piece*/) const {
    return {center + (SignOf(side) * radius) * n, {1, SignOf(side) / radius}, {}};
  }
  void AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const {
    segments->push_back({begin, EllipseMoments(radius, radius, 0, s_begin, s_end), Segment::Base::kChordMiddle});
  }
};

}  // namespace lcpbench
