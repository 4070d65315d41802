#pragma once

#include <array>

#include "model/feature.h"
#include "model/vec2.h"

namespace lcpbench {

/// center + R(phi) (a cos s, b sin s), s the eccentric angle [rad]; a, b > 0 [m].
struct EllipseEdge {
  Vec2 center;
  double a = 1;
  double b = 1;
  double phi = 0;
  Side side = Side::kConvex;
};

/// center + R(phi) r (cos s, sin s) with r(s) = ((cos s / a)^m + (sin s / b)^m)^(-1/m): s is the POLAR angle [rad]; a,
/// b > 0 [m]; m >= 2 even.
struct SuperellipseEdge {
  Vec2 center;
  double a = 1;
  double b = 1;
  int m = 4;
  double phi = 0;
  Side side = Side::kConvex;
};

/// The cubic of control points P, s in [0, 1], with the material on the left of increasing s.
struct BezierEdge {
  std::array<Vec2, 4> P;
};

}  // namespace lcpbench
