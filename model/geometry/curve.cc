#include "model/geometry/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
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

std::vector<double> EqualCuts(double s_begin, double s_end, int parts) {
  const double range = s_end - s_begin;
  std::vector<double> cuts;
  for (int k = 0; k < parts; ++k) cuts.push_back(s_begin + range * k / parts);
  cuts.push_back(s_end);
  return cuts;
}

std::vector<double> QuarterCuts(double s_begin, double s_end) {
  constexpr double kRoundingSlack = 1 - 1e-12;  // a full turn makes four parts, not five
  const double quarters = std::abs(s_end - s_begin) / (std::numbers::pi / 2);
  return EqualCuts(s_begin, s_end, std::max(2, static_cast<int>(std::ceil(quarters * kRoundingSlack))));
}

Vec2 EllipseApexOffset(double a, double b, double phi, double s_begin, double s_end) {
  // For an arc over 2 alpha the image of (cos s, sin s) sin^2 alpha / cos alpha at the middle parameter.
  const Rotation middle = SinCos(s_begin + (s_end - s_begin) / 2);
  const Rotation half = SinCos((s_end - s_begin) / 2);
  const double rise = half.sin * half.sin / half.cos;
  return Rotate(SinCos(phi), {a * rise * middle.cos, b * rise * middle.sin});
}

}  // namespace lcpbench
