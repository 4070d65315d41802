#include "model/geometry/curve.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <variant>
#include <vector>

#include "model/geometry/overloaded.h"
#include "model/geometry/smooth_curve.h"
#include "model/geometry/trig.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

std::string Text(double value) { return NumberText(value); }

std::string Text(Vec2 p) { return "(" + Text(p.x) + ", " + Text(p.y) + ")"; }

std::string Text(Side side) { return side == Side::kConvex ? "convex" : "concave"; }

// What ellipse and superellipse share.
template <class Oval>
std::string OvalText(const Oval& oval, const char* kind) {
  return Text(oval.side) + " " + kind + " with center " + Text(oval.center) + ", semi-axes " + Text(oval.a) + " and " +
         Text(oval.b) + ", phi " + Text(oval.phi);
}

template <class Require, class Oval>
void CheckOval(const Require& require, const Oval& oval) {
  require(IsFinite(oval.center) && std::isfinite(oval.a) && std::isfinite(oval.b) && std::isfinite(oval.phi),
          "a number is not finite");
  require(oval.a > 0 && oval.b > 0, "the semi-axes must be > 0");
  const double greater = std::max(oval.a, oval.b);
  const double less = std::min(oval.a, oval.b);
  require(std::isfinite(greater / less / less), "the curvature overflows");
  require(less / greater / greater > 0, "the curvature underflows");
  require(greater / kMaxAspectRatio <= less, "aspect ratio " + Text(greater / less) + ", at most 1e6 is accepted");
}

// Where |c'| can vanish on [0, 1]: at zeros of c'_x and c'_y, or, where one of them only grazes zero, at its extremum.
bool IsRegular(const BezierEdge& edge) {
  constexpr double kLeastSpeed = 1e-10;
  std::array<Vec2, 3> e{};
  double largest = 0;
  for (size_t i = 0; i < e.size(); ++i) {
    e[i] = edge.P[i + 1] - edge.P[i];
    largest = std::max({largest, std::abs(e[i].x), std::abs(e[i].y)});
  }
  if (!(largest > 0)) return false;
  const auto speed = [&](double s) {
    const double r = 1 - s;
    return Norm((r * r / largest) * e[0] + (2 * r * s / largest) * e[1] + (s * s / largest) * e[2]);
  };
  std::vector<double> places = {0, 1};
  for (double Vec2::*axis : {&Vec2::x, &Vec2::y}) {
    const double a = (e[0].*axis - 2 * (e[1].*axis) + e[2].*axis) / largest;
    const double b = 2 * (e[1].*axis - e[0].*axis) / largest;
    const double c = e[0].*axis / largest;
    places.push_back(-b / (2 * a));
    const double root = std::sqrt(std::max(b * b - 4 * a * c, 0.0));
    const double q = -(b + std::copysign(root, b)) / 2;
    places.push_back(q / a);
    places.push_back(c / q);
  }
  return std::all_of(places.begin(), places.end(),
                     [&](double s) { return !(s >= 0 && s <= 1) || speed(s) > kLeastSpeed; });
}

}  // namespace

std::string NumberText(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string Describe(const Feature& feature) {
  return std::visit(
      Overloaded{[](const Vertex& v) { return "vertex " + Text(v.p); },
                 [](const StraightEdge& e) { return "straight edge from " + Text(e.a) + " to " + Text(e.b); },
                 [](const ArcEdge& e) {
                   return Text(e.side) + " arc with center " + Text(e.center) + " and radius " + Text(e.radius);
                 },
                 [](const EllipseEdge& e) { return OvalText(e, "ellipse"); },
                 [](const SuperellipseEdge& e) { return OvalText(e, "superellipse") + ", m " + std::to_string(e.m); },
                 [](const BezierEdge& e) {
                   return "Bezier curve of " + Text(e.P[0]) + ", " + Text(e.P[1]) + ", " + Text(e.P[2]) + ", " +
                          Text(e.P[3]);
                 }},
      feature);
}

std::string WhyInvalid(const Feature& feature) {
  std::string why;
  const auto require = [&](bool holds, const std::string& condition) {
    if (!holds && why.empty()) why = condition;
  };
  std::visit(Overloaded{[&](const Vertex& v) { require(IsFinite(v.p), "a coordinate is not finite"); },
                        [&](const StraightEdge& e) {
                          require(IsFinite(e.a) && IsFinite(e.b), "a coordinate is not finite");
                          const double length = Norm(e.b - e.a);
                          require(length > 0, "zero-length edge");
                          require(std::isfinite(length), "the edge's length overflows");
                        },
                        [&](const ArcEdge& e) {
                          require(IsFinite(e.center) && std::isfinite(e.radius), "a number is not finite");
                          require(e.radius > 0, "the radius must be > 0");
                          require(std::isfinite(1 / e.radius), "the curvature 1/radius overflows");
                        },
                        [&](const EllipseEdge& e) { CheckOval(require, e); },
                        [&](const SuperellipseEdge& e) {
                          CheckOval(require, e);
                          require(e.m >= 2 && e.m % 2 == 0 && e.m <= kMaxSuperellipseExponent,
                                  "the exponent m must be even and >= 2, and at most " +
                                      std::to_string(kMaxSuperellipseExponent));
                        },
                        [&](const BezierEdge& e) {
                          double largest = 0;
                          for (const Vec2& p : e.P) {
                            require(IsFinite(p), "a coordinate is not finite");
                            largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
                          }
                          require(std::isfinite(largest * largest), "the control points' distance overflows");
                          if (why.empty())
                            require(IsRegular(e), "the derivative vanishes, speed |c'| = 0, on the curve");
                        }},
             feature);
  return why;
}

void RequireValid(const Feature& feature) {
  const std::string why = WhyInvalid(feature);
  if (!why.empty()) throw InputError("invalid geometry, " + why + ": " + Describe(feature));
}

EdgePoint EvaluateEdge(const Feature& edge, double s) {
  if (!std::isfinite(s)) throw InputError("an edge is evaluated at a parameter that is not finite: " + Describe(edge));
  if (std::holds_alternative<Vertex>(edge)) throw InputError("a vertex has no parameter: " + Describe(edge));
  if (const auto* straight = std::get_if<StraightEdge>(&edge)) {
    const Vec2 along = straight->b - straight->a;
    const double length = Norm(along);
    return {straight->a + s * along, along, {0, 0}, {along.y / length, -along.x / length}, 0};
  }
  if (const auto* arc = std::get_if<ArcEdge>(&edge)) {
    const Rotation r = SinCos(s);
    const Vec2 radial = {r.cos, r.sin};
    const double sign = arc->side == Side::kConvex ? 1 : -1;
    return {arc->center + arc->radius * radial, arc->radius * Perp(radial), -arc->radius * radial, sign * radial,
            sign / arc->radius};
  }
  const SmoothCurve curve({edge, {}, {}});
  const CurvePlace<DoubleDouble> place = curve.FromParameter(s);
  CurveJet<DoubleDouble> jet = curve.At(place);
  if (const auto* oval = std::get_if<SuperellipseEdge>(&edge)) {
    // From derivatives by tau to derivatives by the polar angle s:
    // tan tau = (a/b) tan s, dtau/ds = (a/b) cos^2 tau + (b/a) sin^2 tau.
    const DoubleDouble a = oval->a;
    const DoubleDouble b = oval->b;
    const DoubleDouble rate = (a / b) * place.x * place.x + (b / a) * place.y * place.y;
    const DoubleDouble rate_by_tau = DoubleDouble(2) * (b / a - a / b) * place.x * place.y;
    jet.d2 = (rate * rate) * jet.d2 + (rate * rate_by_tau) * jet.d1;
    jet.d1 = rate * jet.d1;
  }
  return {ToVec2(jet.c), ToVec2(jet.d1), ToVec2(jet.d2), ToVec2(jet.N), ToDouble(jet.kappa)};
}

}  // namespace lcpbench
