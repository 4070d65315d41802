#include "model/shape/outline_piece.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/contact/closest_points.h"
#include "model/geometry/overloaded.h"
#include "model/geometry/trig.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// The shortest text that reads back as the same double.
std::string Text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string Text(Vec2 p) { return "(" + Text(p.x) + ", " + Text(p.y) + ")"; }

const char* Text(Side side) { return side == Side::kConvex ? "convex" : "concave"; }

std::string AxesText(const char* kind, Side side, Vec2 center, double a, double b, double phi) {
  return std::string(Text(side)) + " " + kind + " with center " + Text(center) + ", semi-axes " + Text(a) + " and " +
         Text(b) + " and phi " + Text(phi);
}

Vec2 SuperellipsePoint(const SuperellipseEdge& e, double s) {
  const Rotation u = SinCos(s);
  const double c = u.cos / e.a;
  const double d = u.sin / e.b;
  // The larger term is taken out of the sum, so that no power over- or underflows harmfully.
  const double large = std::max(std::abs(c), std::abs(d));
  const double small = std::min(std::abs(c), std::abs(d));
  const double r = 1 / (large * RootOfOnePlusPower(small / large, e.m));
  return {r * u.cos, r * u.sin};
}

// Perpendicular to the gradient (c^(m-1) / a, d^(m-1) / b) of c^m + d^m, c = cos s / a, d = sin s / b.
Vec2 SuperellipseDirection(const SuperellipseEdge& e, double s) {
  const Rotation u = SinCos(s);
  const double c = u.cos / e.a;
  const double d = u.sin / e.b;
  const double large = std::max(std::abs(c), std::abs(d));
  const double scale = std::max(e.a, e.b);
  return {-IntegerPower(d / large, e.m - 1) * (scale / e.b), IntegerPower(c / large, e.m - 1) * (scale / e.a)};
}

Vec2 BezierPoint(const BezierEdge& e, double s) {
  const double t = 1 - s;
  return (t * t * t) * e.P[0] + (3 * t * t * s) * e.P[1] + (3 * t * s * s) * e.P[2] + (s * s * s) * e.P[3];
}

class PieceCheck {
 public:
  PieceCheck(const OutlinePiece& piece, const std::string& where) : piece_(piece), where_(where) {}

  void Run() const {
    Require(std::isfinite(piece_.s_begin) && std::isfinite(piece_.s_end), "a curve parameter is not finite");
    const std::string why = WhyInvalid(std::visit([](const auto& edge) -> Feature { return edge; }, piece_.edge));
    Require(why.empty(), why);
    std::visit([this](const auto& edge) { Check(edge); }, piece_.edge);
  }

 private:
  void Require(bool holds, const std::string& condition) const {
    if (!holds) throw InputError(where_ + " (" + DescribeCurve(piece_.edge) + "): " + condition);
  }

  void Check(const StraightEdge& /*e*/) const { CheckUnitRange(); }
  void Check(const ArcEdge& e) const { CheckAngles(e.side); }
  void Check(const EllipseEdge& e) const { CheckAngles(e.side); }
  void Check(const SuperellipseEdge& e) const { CheckAngles(e.side); }
  void Check(const BezierEdge& /*e*/) const { CheckUnitRange(); }

  void CheckUnitRange() const {
    Require(piece_.s_begin != piece_.s_end, "zero-length edge: s_begin = s_end");
    Require(piece_.s_begin < piece_.s_end, "the material is on the left of increasing s: expected s_begin < s_end");
    Require(piece_.s_begin >= 0 && piece_.s_end <= 1, "the parameter range must lie within 0..1");
  }

  void CheckAngles(Side side) const {
    // Angles of many turns would have lost their digits.
    constexpr double kMaxAngle = 1e3;
    constexpr double kFullTurn = 2 * std::numbers::pi * (1 + 4 * std::numeric_limits<double>::epsilon());
    Require(piece_.s_begin != piece_.s_end, "zero-length edge: s_begin = s_end");
    const bool forward = piece_.s_begin < piece_.s_end;
    Require(forward == (side == Side::kConvex), side == Side::kConvex
                                                    ? "a convex edge runs counter-clockwise: expected s_begin < s_end"
                                                    : "a concave edge runs clockwise: expected s_begin > s_end");
    Require(std::abs(piece_.s_begin) <= kMaxAngle && std::abs(piece_.s_end) <= kMaxAngle,
            "angles must lie within -1000..1000 rad");
    Require(std::abs(piece_.s_end - piece_.s_begin) <= kFullTurn, "the edge runs over more than one full turn");
  }

  const OutlinePiece& piece_;
  const std::string& where_;
};

}  // namespace

double IntegerPower(double x, int n) {
  double power = 1;
  double square = x;
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) power *= square;
    square *= square;
  }
  return power;
}

double RootOfOnePlusPower(double q, int m) {
  const double excess = IntegerPower(q, m);
  const double value = 1 + excess;
  if (m == 2) return std::sqrt(value);
  // From above (Bernoulli's inequality) Newton's iteration for y^m = value falls monotonically until rounding stops it.
  double y = 1 + excess / m;
  for (;;) {
    const double slope = IntegerPower(y, m - 1);
    const double next = y - (slope * y - value) / (m * slope);
    if (!(next < y)) return y;
    y = next;
  }
}

Vec2 CurvePoint(const OutlineCurve& curve, double s) {
  return std::visit(
      Overloaded{[s](const StraightEdge& e) {
                   if (s == 1) return e.b;
                   return e.a + s * (e.b - e.a);
                 },
                 [s](const ArcEdge& e) {
                   const Rotation u = SinCos(s);
                   return e.center + Vec2{e.radius * u.cos, e.radius * u.sin};
                 },
                 [s](const EllipseEdge& e) {
                   const Rotation u = SinCos(s);
                   return e.center + Rotate(SinCos(e.phi), {e.a * u.cos, e.b * u.sin});
                 },
                 [s](const SuperellipseEdge& e) { return e.center + Rotate(SinCos(e.phi), SuperellipsePoint(e, s)); },
                 [s](const BezierEdge& e) { return BezierPoint(e, s); }},
      curve);
}

Vec2 CurveDirection(const OutlineCurve& curve, double s) {
  return std::visit(
      Overloaded{[](const StraightEdge& e) { return e.b - e.a; },
                 [s](const ArcEdge& /*e*/) {
                   const Rotation u = SinCos(s);
                   return Vec2{-u.sin, u.cos};
                 },
                 [s](const EllipseEdge& e) {
                   const Rotation u = SinCos(s);
                   return Rotate(SinCos(e.phi), {-e.a * u.sin, e.b * u.cos});
                 },
                 [s](const SuperellipseEdge& e) { return Rotate(SinCos(e.phi), SuperellipseDirection(e, s)); },
                 [s](const BezierEdge& e) {
                   const double t = 1 - s;
                   return (t * t) * (e.P[1] - e.P[0]) + (2 * t * s) * (e.P[2] - e.P[1]) + (s * s) * (e.P[3] - e.P[2]);
                 }},
      curve);
}

std::array<Vec2, 4> BezierPiece(const BezierEdge& edge, double s0, double s1) {
  // The blossom: each of the three steps of de Casteljau's algorithm with its own parameter.
  const auto blossom = [&edge](double u, double v, double w) {
    const auto mix = [](Vec2 p, Vec2 q, double t) { return (1 - t) * p + t * q; };
    const auto& P = edge.P;
    const Vec2 a = mix(P[0], P[1], u);
    const Vec2 b = mix(P[1], P[2], u);
    const Vec2 c = mix(P[2], P[3], u);
    return mix(mix(a, b, v), mix(b, c, v), w);
  };
  return {blossom(s0, s0, s0), blossom(s0, s0, s1), blossom(s0, s1, s1), blossom(s1, s1, s1)};
}

double Reach(const OutlinePiece& piece) {
  const auto largest = [](Vec2 p) { return std::max(std::abs(p.x), std::abs(p.y)); };
  const double angle = std::max({1.0, std::abs(piece.s_begin), std::abs(piece.s_end)});
  const auto oval = [&](const auto& e) {
    return largest(e.center) + std::max(angle, std::abs(e.phi)) * std::max(e.a, e.b);
  };
  return std::visit(
      Overloaded{[&](const StraightEdge& e) { return std::max(largest(e.a), largest(e.b)); },
                 [&](const ArcEdge& e) { return largest(e.center) + angle * e.radius; },
                 [&](const EllipseEdge& e) { return oval(e); }, [&](const SuperellipseEdge& e) { return oval(e); },
                 [&](const BezierEdge& e) {
                   double reach = 0;
                   for (const Vec2 p : e.P) reach = std::max(reach, largest(p));
                   return reach;
                 }},
      piece.edge);
}

OutlinePiece Transformed(const OutlinePiece& piece, double angle, Vec2 shift) {
  const Rotation rotation = SinCos(angle);
  const auto move = [&](Vec2 c) { return Rotate(rotation, c) + shift; };
  OutlinePiece moved = piece;
  std::visit(Overloaded{[&](StraightEdge& e) {
                          e.a = move(e.a);
                          e.b = move(e.b);
                        },
                        [&](ArcEdge& e) {
                          e.center = move(e.center);
                          moved.s_begin += angle;
                          moved.s_end += angle;
                        },
                        [&](EllipseEdge& e) {
                          e.center = move(e.center);
                          e.phi += angle;
                        },
                        [&](SuperellipseEdge& e) {
                          e.center = move(e.center);
                          e.phi += angle;
                        },
                        [&](BezierEdge& e) {
                          for (Vec2& p : e.P) p = move(p);
                        }},
             moved.edge);
  return moved;
}

std::string DescribeCurve(const OutlineCurve& curve) {
  return std::visit(
      Overloaded{[](const StraightEdge& e) { return Describe(e); }, [](const ArcEdge& e) { return Describe(e); },
                 [](const EllipseEdge& e) { return AxesText("ellipse", e.side, e.center, e.a, e.b, e.phi); },
                 [](const SuperellipseEdge& e) {
                   return AxesText("superellipse", e.side, e.center, e.a, e.b, e.phi) + ", m = " + std::to_string(e.m);
                 },
                 [](const BezierEdge& e) {
                   return "Bezier edge " + Text(e.P[0]) + " " + Text(e.P[1]) + " " + Text(e.P[2]) + " " + Text(e.P[3]);
                 }},
      curve);
}

void RequireValidPiece(const OutlinePiece& piece, const std::string& where) { PieceCheck(piece, where).Run(); }

}  // namespace lcpbench
