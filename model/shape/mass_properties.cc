#include "model/shape/mass_properties.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "model/geometry/overloaded.h"
#include "model/geometry/trig.h"
#include "model/shape/outline_checks.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// An edge, or a part of one: the region between it and its chord.
struct Segment {
  Vec2 begin;           // the vertex where the edge begins
  AreaMoments moments;  // of the region, signed, about `base`
  enum class Base { kChordMiddle, kBegin } base = Base::kBegin;
};

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

// The moments about p(0) of the cone over a curve from there, area = 1/2 (integral of p x dp), first moment 1/3
// (integral of p (p x dp)), second 1/4: `integrate` takes an integrand of t, `at` gives p - p(0) and dp/dt.
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

struct PointAndDerivative {
  Vec2 p;
  Vec2 dp;
};

AreaMoments BezierMoments(const std::array<Vec2, 4>& P) {
  // The integrands have degree 10 at most; n points are exact up to degree 2n - 1.
  using Gauss = boost::math::quadrature::gauss<double, 7>;
  const Vec2 q1 = P[1] - P[0];
  const Vec2 q2 = P[2] - P[0];
  const Vec2 q3 = P[3] - P[0];
  return ConeMoments([](const auto& f) { return Gauss::integrate(f, 0.0, 1.0); },
                     [&](double t) {
                       const double r = 1 - t;
                       return PointAndDerivative{(3 * r * r * t) * q1 + (3 * r * t * t) * q2 + (t * t * t) * q3,
                                                 (3 * r * r) * q1 + (6 * r * t) * (q2 - q1) + (3 * t * t) * (q3 - q2)};
                     });
}

// Half of one side of the unit superellipse x^m + y^m = 1: the side that the x axis meets, turned by quarter_turns; q
// = y / x is the slope of the polar ray, within -1..0 or 0..1, so that x and y are monotone.
struct Octant {
  int quarter_turns = 0;
  double q_begin = 0;
  double q_end = 0;
};

Vec2 QuarterTurned(Vec2 p, int turns) {
  for (int k = 0; k < turns; ++k) p = Perp(p);
  return p;
}

Vec2 OctantPoint(double q, int m, int turns) {
  const double x = 1 / RootOfOnePlusPower(q, m);
  return QuarterTurned({x, q * x}, turns);
}

// Where the ray at polar angle s lies on the superellipse scaled to a = b = 1.
struct RaySlope {
  int octant = 0;  // 0..7 counter-clockwise; octant k is the half [-1, 0] (k odd) or [0, 1] (k even) of a side
  double q = 0;
};

RaySlope SlopeAt(const SuperellipseEdge& e, double s) {
  const Rotation u = SinCos(s);
  Vec2 ray{u.cos / e.a, u.sin / e.b};
  int turns = 0;
  while (!(ray.x > 0 && std::abs(ray.y) <= ray.x) && turns < 3) {
    ray = -Perp(ray);
    ++turns;
  }
  RaySlope slope;
  slope.q = ray.y / ray.x;
  slope.octant = (2 * turns + (slope.q < 0 ? 7 : 0)) % 8;
  return slope;
}

// The octants from s_low counter-clockwise to s_high.
std::vector<Octant> OctantsBetween(const SuperellipseEdge& e, double s_low, double s_high) {
  constexpr int kOctants = 8;
  const RaySlope low = SlopeAt(e, s_low);
  RaySlope high = SlopeAt(e, s_high);
  // A full turn, whose end is off its begin by the rounding of 2 pi: that matters for slender shapes, whose polar angle
  // runs very fast at their ends.
  const double magnitude = std::max(std::abs(s_low), std::abs(s_high));
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * magnitude;
  if (std::abs(s_high - s_low - 2 * std::numbers::pi) <= rounding) high = low;
  int steps = (high.octant - low.octant + kOctants) % kOctants;
  // Half turns are half turns in either angle: what begins and ends in the same or the next octant yet is longer than
  // that has run all the way round. What ends an octant earlier yet is shorter has, but for rounding, not moved at all.
  const bool beyond_half = s_high - s_low > std::numbers::pi;
  if (beyond_half && steps <= 1) steps += kOctants;
  std::vector<Octant> octants;
  if (!beyond_half && steps == kOctants - 1) return octants;
  for (int k = 0; k <= steps; ++k) {
    const int octant = (low.octant + k) % kOctants;
    Octant part;
    part.quarter_turns = (octant + 1) / 2 % 4;
    const double first = octant % 2 == 0 ? 0 : -1;
    part.q_begin = k == 0 ? low.q : first;
    part.q_end = k == steps ? high.q : first + 1;
    if (part.q_begin != part.q_end) octants.push_back(part);
  }
  return octants;
}

// Adaptive quadrature: halves the range until the estimated error is below kTolerance of the integral or below `noise`,
// what rounding of the integrand amounts to.
template <class Integrand>
double Integrate(const Integrand& f, double from, double to, double noise, int depth) {
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 61>;
  constexpr double kTolerance = 1e-14;
  constexpr int kMaxDepth = 15;  // resolves the corner of the largest exponent with room to spare
  double error = 0;
  const double integral = Kronrod::integrate(f, from, to, 0, kTolerance, &error);
  // The error is estimated before scaling with half the range.
  error *= std::abs(to - from) / 2;
  if (error <= std::max(kTolerance * std::abs(integral), noise) || depth == kMaxDepth) return integral;
  const double middle = from + (to - from) / 2;
  return Integrate(f, from, middle, noise / 2, depth + 1) + Integrate(f, middle, to, noise / 2, depth + 1);
}

AreaMoments OctantMoments(const Octant& octant, int m) {
  const Vec2 origin = OctantPoint(octant.q_begin, m, 0);
  // The cone's integrand is a product of lengths that cancel: good to a few epsilon of their product.
  constexpr double kNoise = 8 * std::numeric_limits<double>::epsilon();
  const double length = std::abs(octant.q_end - octant.q_begin);
  const AreaMoments moments =
      ConeMoments([&](const auto& f) { return Integrate(f, octant.q_begin, octant.q_end, kNoise * length, 0); },
                  [&](double q) {
                    const double x = 1 / RootOfOnePlusPower(q, m);
                    const double slope_power = IntegerPower(q, m - 1);
                    const double dx = -slope_power * x / (1 + slope_power * q);
                    return PointAndDerivative{Vec2{x, q * x} - origin, {dx, x + q * dx}};
                  });
  return Mapped(moments, QuarterTurned({1, 0}, octant.quarter_turns), QuarterTurned({0, 1}, octant.quarter_turns));
}

void AddSegments(const SuperellipseEdge& e, Vec2 first_vertex, const OutlinePiece& piece,
                 std::vector<Segment>* segments) {
  const bool forward = piece.s_begin < piece.s_end;
  std::vector<Octant> octants =
      OctantsBetween(e, std::min(piece.s_begin, piece.s_end), std::max(piece.s_begin, piece.s_end));
  if (!forward) {
    std::reverse(octants.begin(), octants.end());
    for (Octant& octant : octants) std::swap(octant.q_begin, octant.q_end);
  }
  const Rotation tilt = SinCos(e.phi);
  const Vec2 u = Rotate(tilt, {e.a, 0});
  const Vec2 v = Rotate(tilt, {0, e.b});
  for (std::size_t k = 0; k < octants.size(); ++k) {
    const Vec2 unit = OctantPoint(octants[k].q_begin, e.m, octants[k].quarter_turns);
    const Vec2 begin = k == 0 ? first_vertex : e.center + unit.x * u + unit.y * v;
    const AreaMoments scaled = Mapped(OctantMoments(octants[k], e.m), {e.a, 0}, {0, e.b});
    segments->push_back({begin, Rotated(scaled, e.phi), Segment::Base::kBegin});
  }
}

// The vertex where a piece begins: the end of the piece before if that has smaller numbers, hence smaller rounding
// errors. So a nearly straight arc, whose radius is huge, does not spoil the corners of the rest.
Vec2 VertexBetween(const OutlinePiece& before, const OutlinePiece& piece) {
  return Reach(before) < Reach(piece) ? CurvePoint(before.edge, before.s_end) : CurvePoint(piece.edge, piece.s_begin);
}

std::vector<Segment> SegmentsOf(const OutlineLoop& loop) {
  std::vector<Segment> segments;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const OutlinePiece& piece = loop[k];
    const Vec2 begin = VertexBetween(loop[(k + loop.size() - 1) % loop.size()], piece);
    const auto add = [&](const AreaMoments& moments, Segment::Base base) {
      segments.push_back({begin, moments, base});
    };
    std::visit(Overloaded{[&](const StraightEdge&) { add({}, Segment::Base::kBegin); },
                          [&](const ArcEdge& e) {
                            add(EllipseMoments(e.radius, e.radius, 0, piece.s_begin, piece.s_end),
                                Segment::Base::kChordMiddle);
                          },
                          [&](const EllipseEdge& e) {
                            add(EllipseMoments(e.a, e.b, e.phi, piece.s_begin, piece.s_end),
                                Segment::Base::kChordMiddle);
                          },
                          [&](const SuperellipseEdge& e) { AddSegments(e, begin, piece, &segments); },
                          [&](const BezierEdge& e) {
                            add(BezierMoments(BezierPiece(e, piece.s_begin, piece.s_end)), Segment::Base::kBegin);
                          }},
               piece.edge);
  }
  return segments;
}

// The triangle (base, p, q), p and q from the base.
AreaMoments TriangleMoments(Vec2 p, Vec2 q) {
  AreaMoments m;
  m.area = Cross(p, q) / 2;
  m.first = (m.area / 3) * (p + q);
  m.xx = m.area / 6 * (p.x * p.x + p.x * q.x + q.x * q.x);
  m.yy = m.area / 6 * (p.y * p.y + p.y * q.y + q.y * q.y);
  m.xy = m.area / 12 * (2 * p.x * p.y + p.x * q.y + q.x * p.y + 2 * q.x * q.y);
  return m;
}

AreaMoments Sum(const std::vector<Segment>& segments, Vec2 base) {
  AreaMoments sum;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& segment = segments[k];
    const Vec2 begin = segment.begin - base;
    const Vec2 end = segments[(k + 1) % segments.size()].begin - base;
    const Vec2 moments_base = segment.base == Segment::Base::kBegin ? begin : begin + 0.5 * (end - begin);
    sum = sum + TriangleMoments(begin, end) + Moved(segment.moments, moments_base);
  }
  return sum;
}

using OutlineSegments = std::vector<std::vector<Segment>>;

AreaMoments Sum(const OutlineSegments& loops, Vec2 base) {
  AreaMoments sum;
  for (const auto& segments : loops) sum = sum + Sum(segments, base);
  return sum;
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

AreaMoments LoopMoments(const OutlineLoop& loop, Vec2 base) { return Sum(SegmentsOf(loop), base); }

AreaMoments OutlineMoments(const Outline& outline, Vec2 base) {
  AreaMoments sum;
  for (const OutlineLoop& loop : outline.loops) sum = sum + LoopMoments(loop, base);
  return sum;
}

MassProperties ComputeMassProperties(const Outline& outline, double density) {
  if (!(density > 0) || !std::isfinite(density)) {
    throw InputError("outline '" + outline.name + "': the density must be finite and > 0");
  }
  OutlineSegments loops;
  for (const OutlineLoop& loop : outline.loops) loops.push_back(SegmentsOf(loop));
  if (loops.empty() || loops[0].empty()) throw InputError("outline '" + outline.name + "' has no edges");
  // Three passes: about any point of the boundary, then about the centre found so, where nothing cancels.
  MassProperties result;
  result.center = loops[0][0].begin;
  AreaMoments moments;
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    moments = Sum(loops, result.center);
    result.area = moments.area;
    if (!(result.area > 0)) break;
    const Vec2 offset = (1 / moments.area) * moments.first;
    if (pass + 1 < kPasses) result.center = result.center + offset;
  }
  result.mass = density * moments.area;
  result.inertia = density * moments.polar();
  if (!(result.area > 0 && result.inertia > 0 && result.mass > 0) || !std::isfinite(result.mass) ||
      !std::isfinite(result.inertia) || !IsFinite(result.center)) {
    throw InputError("outline '" + outline.name + "': mass and inertia are not positive and finite");
  }
  return result;
}

Outline Centered(const Outline& outline) { return Transformed(outline, 0, -ComputeMassProperties(outline, 1).center); }

Body MakeBody(const Outline& outline, double density) {
  RequireValid(outline);
  const MassProperties properties = ComputeMassProperties(outline, density);
  Body body;
  body.name = outline.name;
  body.mass = properties.mass;
  body.inertia = properties.inertia;
  body.x = properties.center;
  body.outline = AllPieces(Centered(outline));
  return body;
}

}  // namespace lcpbench
