#include "model/geometry/area_moments.h"

#include <cmath>

namespace lcpbench {
namespace {

// The region between an arc of the unit circle, symmetric about the x axis and delta [rad] long, and its chord; about
// the middle of the chord. All are odd in delta, so that an arc run backwards counts negative.
AreaMoments UnitSegment(double delta) {
  AreaMoments m;
  // Below this the closed forms, differences of terms of order delta for a result of order delta^3 to delta^7, cancel.
  constexpr double kSeriesLimit = 2;
  if (std::abs(delta) < kSeriesLimit) {
    const double half = delta / 2;
    double power = delta;       // (-1)^k delta^(2k+1) / (2k+1)!
    double half_power = half;   // (-1)^k (delta/2)^(2k+1) / (2k+1)!
    double four_power = 2;      // 2^(2k+1)
    double nine_power = 1;      // 9^k
    constexpr int kTerms = 20;  // (3 * 1)^41 / 41! < 1e-29
    for (int k = 1; k <= kTerms; ++k) {
      const double divisor = (2.0 * k) * (2.0 * k + 1);
      power *= -delta * delta / divisor;
      half_power *= -half * half / divisor;
      four_power *= 4;
      nine_power *= 9;
      const double across = four_power / 48 - 1.0 / 6;
      m.area -= power / 2;
      m.first.x += half_power * (0.75 + nine_power / 4 - (2 * k + 1));
      m.yy += power * across;
      m.xx += power * ((k - 1) / 2.0 - across);
    }
    return m;
  }
  const Rotation full = SinCos(delta);
  const Rotation half = SinCos(delta / 2);
  m.area = (delta - full.sin) / 2;
  m.first.x = half.sin * half.sin * half.sin * 2 / 3 - half.cos * m.area;
  m.yy = delta / 8 - full.sin / 6 + full.sin * full.cos / 24;
  m.xx = delta / 2 + delta * full.cos / 4 - 0.75 * full.sin - m.yy;
  return m;
}

}  // namespace

AreaMoments operator+(const AreaMoments& p, const AreaMoments& q) {
  return {p.area + q.area, p.first + q.first, p.xx + q.xx, p.xy + q.xy, p.yy + q.yy};
}

AreaMoments Moved(const AreaMoments& m, Vec2 d) {
  return {m.area, m.first + m.area * d, m.xx + d.x * (2 * m.first.x + m.area * d.x),
          m.xy + d.x * m.first.y + d.y * (m.first.x + m.area * d.x), m.yy + d.y * (2 * m.first.y + m.area * d.y)};
}

AreaMoments Mapped(const AreaMoments& m, Vec2 u, Vec2 v) {
  const double determinant = Cross(u, v);
  const auto second = [&](double p, double q, double r, double s) {
    return determinant * (m.xx * p * q + m.xy * (p * s + q * r) + m.yy * r * s);
  };
  return {determinant * m.area, determinant * (m.first.x * u + m.first.y * v), second(u.x, u.x, v.x, v.x),
          second(u.x, u.y, v.x, v.y), second(u.y, u.y, v.y, v.y)};
}

// A step of its own after scaling, for the determinant of both at once would cancel for slender shapes.
AreaMoments Rotated(const AreaMoments& m, double angle) {
  const Rotation r = SinCos(angle);
  return Mapped(m, {r.cos, r.sin}, {-r.sin, r.cos});
}

AreaMoments EllipseMoments(double a, double b, double phi, double s_begin, double s_end) {
  const Rotation middle = SinCos(s_begin + (s_end - s_begin) / 2);
  return Rotated(
      Mapped(UnitSegment(s_end - s_begin), {a * middle.cos, b * middle.sin}, {-a * middle.sin, b * middle.cos}), phi);
}

}  // namespace lcpbench
