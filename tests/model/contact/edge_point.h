#pragma once

#include <variant>

#include "model/geometry/smooth_curve.h"

namespace lcpbench::testing {

/// An edge at one parameter: everything that contact needs of it, in the body frame.
struct EdgePoint {
  Vec2 c;            ///< c(s) [m]
  Vec2 d1;           ///< c'(s), by the edge's own parameter (feature.h)
  Vec2 d2;           ///< c''(s)
  Vec2 N;            ///< outward unit normal, away from the material
  double kappa = 0;  ///< signed curvature [1/m]: > 0 convex, 0 straight, < 0 concave
};

/// An edge at s: the model's evaluation of general curves (SmoothCurve) in 32 digits, and closed forms of the others.
///   N = (c'_y, -c'_x)/|c'|,  kappa = (c' x c'')/|c'|^3  for material on the left, as of straight edges, Bezier curves
///   and convex ovals; both change sign for concave ones.   [docs/model.md section 1]
/// @param edge  any feature but a vertex, valid (RequireValid)
/// @param s     finite; beyond the ends of a straight edge or Bezier curve: of the line, of the polynomials
inline EdgePoint EvaluateEdge(const Feature& edge, double s) {
  if (const auto* straight = std::get_if<StraightEdge>(&edge)) {
    const Vec2 along = straight->Direction(s);
    return {straight->Point(s), along, {0, 0}, -Perp(Unit(along)), 0};
  }
  if (const auto* arc = std::get_if<ArcEdge>(&edge)) {
    const Vec2 radial = LiftRotation<double>(SinCos(s));
    const double sign = SignOf(arc->side);
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

}  // namespace lcpbench::testing
