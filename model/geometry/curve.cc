#include "model/geometry/curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lcpbench {

double Largest(Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); }

Vec2 UnitOrZero(Vec2 a) { return Norm(a) > 0 ? Unit(a) : a; }

double DistanceToSegment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double square = Dot(along, along);
  const double t = square > 0 ? std::clamp(Dot(p - a, along) / square, 0.0, 1.0) : 0;
  return Norm(p - a - t * along);
}

bool InCone(Vec2 v, Vec2 u1, Vec2 u2) {
  // The last condition matters to cones that are thin but for rounding, for which the others hold on the opposite side
  // too.
  if (Cross(u1, u2) < 0) std::swap(u1, u2);
  return Cross(u1, v) >= 0 && Cross(v, u2) >= 0 && Dot(v, u1 + u2) > 0;
}

}  // namespace lcpbench
