#pragma once

#include "model/geometry/vec2.h"

namespace lcpbench {

/// Moments of area of a signed plane region about a base point: the integrals of 1, (x, y), and x^2, xy, y^2 over the
/// region, x and y from the base point. They add over regions.
struct AreaMoments {
  double area = 0;  ///< [m^2]
  Vec2 first;       ///< [m^3]
  double xx = 0;    ///< [m^4]
  double xy = 0;
  double yy = 0;

  double polar() const { return xx + yy; }
};

AreaMoments operator+(const AreaMoments& p, const AreaMoments& q);
/// The moments of the region moved by d.
AreaMoments Moved(const AreaMoments& m, Vec2 d);
/// The moments of the region's image under the linear map whose columns are u and v.
AreaMoments Mapped(const AreaMoments& m, Vec2 u, Vec2 v);
/// The moments of the region turned by an angle about the base point.
AreaMoments Rotated(const AreaMoments& m, double angle);

/// The moments of the region between the piece s_begin..s_end of an ellipse and its chord, about the middle of the
/// chord: closed forms; power series for arcs below 2 rad, where those would cancel.
AreaMoments EllipseMoments(double a, double b, double phi, double s_begin, double s_end);

/// An edge, or a part of one: the region between it and its chord.
struct Segment {
  Vec2 begin;           ///< the vertex where the edge begins
  AreaMoments moments;  ///< of the region, signed, about `base`
  enum class Base { kChordMiddle, kBegin } base = Base::kBegin;
};

/// The moments about p(0) of the cone over a curve from there, area = 1/2 (integral of p x dp), first moment 1/3
/// (integral of p (p x dp)), second 1/4: `integrate` takes an integrand of t, `at` gives the pair p - p(0), dp/dt.
template <class Integrate, class At>
AreaMoments ConeMoments(const Integrate& integrate, const At& at) {
  const auto integral = [&](const auto& weight) {
    return integrate([&](double t) {
      const auto [p, dp] = at(t);
      return weight(p) * Cross(p, dp);
    });
  };
  AreaMoments m;
  m.area = integral([](Vec2) { return 0.5; });
  m.first.x = integral([](Vec2 p) { return p.x; }) / 3;
  m.first.y = integral([](Vec2 p) { return p.y; }) / 3;
  m.xx = integral([](Vec2 p) { return p.x * p.x; }) / 4;
  m.xy = integral([](Vec2 p) { return p.x * p.y; }) / 4;
  m.yy = integral([](Vec2 p) { return p.y * p.y; }) / 4;
  return m;
}

}  // namespace lcpbench
