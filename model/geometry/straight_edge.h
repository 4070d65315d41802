#pragma once

#include "model/geometry/curve.h"

namespace lcpbench {

/// From a to b with the material on the left, s in [0, 1]; the outward normal is on the right-hand side.
struct StraightEdge {
  static constexpr const char* kName = "straight";
  static constexpr CurveKind kKind = CurveKind::kStraight;
  static constexpr bool kIsAngle = false;
  Vec2 a;
  Vec2 b;

  static constexpr std::tuple kFields = {Field{"a", &StraightEdge::a}, Field{"b", &StraightEdge::b}};
  bool operator==(const StraightEdge&) const = default;
  std::string WhyInvalid() const {
    const double length = Norm(b - a);
    if (!(length > 0)) return "zero-length edge";
    return std::isfinite(length) ? "" : "the edge's length overflows";
  }
  double Reach(double /*angle*/) const { return std::max(Largest(a), Largest(b)); }

  Vec2 Point(double s) const { return s == 1 ? b : a + s * (b - a); }
  Vec2 Direction(double /*s*/) const { return b - a; }
  SpanPoint AtNormal(Vec2 /*n*/, const TurnedPiece& /*piece*/) const { return {}; }
  void AppendMoments(double /*s_begin*/, double /*s_end*/, Vec2 begin, std::vector<Segment>* segments) const {
    segments->push_back({begin, {}, Segment::Base::kBegin});
  }
};

}  // namespace lcpbench
