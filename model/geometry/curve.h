#pragma once

#include <string>

#include "model/geometry/feature.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// An edge at one parameter: everything that contact needs of it, in the body frame.
struct EdgePoint {
  Vec2 c;            ///< c(s) [m]
  Vec2 d1;           ///< c'(s), by the edge's own parameter (feature.h)
  Vec2 d2;           ///< c''(s)
  Vec2 N;            ///< outward unit normal, away from the material
  double kappa = 0;  ///< signed curvature [1/m]: > 0 convex, 0 straight, < 0 concave
};

/// Evaluates an edge at s: O(1), O(log m) for a superellipse. Evaluated with 32 digits and then rounded, so that all of
/// it is accurate to the last digit or two but for what the given s rounds away.
///   N = (c'_y, -c'_x)/|c'|,  kappa = (c' x c'')/|c'|^3  for material on the left, as of straight edges, Bezier curves
///   and convex ovals; both change sign for concave ones.   [MODEL.md section 1]
/// A superellipse's curvature is taken from its implicit equation X^m + Y^m = 1, X = |x|/a, Y = |y|/b,
///   kappa = (m-1) (X Y)^(m-2) / (a b)^2 / ((X^(m-1)/a)^2 + (Y^(m-1)/b)^2)^(3/2),
/// which has no difference in it: at the flat points of m > 2 it is 0, not rounding noise.
/// @param edge  any feature but a vertex, valid (RequireValid)
/// @param s     finite; beyond the ends of a straight edge or Bezier curve: of the line, of the polynomials
/// @throws InputError for a vertex and for an s that is not finite
EdgePoint EvaluateEdge(const Feature& edge, double s);

/// The largest m of a superellipse: beyond it the corners are sharper than any use of the curve.
inline constexpr int kMaxSuperellipseExponent = 1000;
/// How slender a (super)ellipse may be: the ratio of its semi-axes.
inline constexpr double kMaxAspectRatio = 1e6;

/// What a feature of a contact or a piece of an outline must satisfy, in words, where it does not; else empty: every
/// number is finite; lengths, radii and semi-axes are > 0 with finite curvatures; semi-axes differ by a factor of at
/// most kMaxAspectRatio; m is even and in 2..kMaxSuperellipseExponent; and a Bezier curve's speed |c'| vanishes nowhere
/// on [0, 1] (beyond 1e-10 of its largest control step).
std::string WhyInvalid(const Feature& feature);

/// @throws InputError naming the condition and the feature, unless WhyInvalid is empty
void RequireValid(const Feature& feature);

/// One line for error texts: the kind and its numbers.
std::string Describe(const Feature& feature);

/// The shortest text that reads back as the same double.
std::string NumberText(double value);

}  // namespace lcpbench
