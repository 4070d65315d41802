#pragma once

#include "model/geometry/curve.h"

namespace lcpbench {

/// (1 + q^m)^(1/m) for |q| <= 1 and even m >= 2, to a few units in the last place, by Newton's iteration in plain
/// arithmetic: the same bits everywhere.
double RootOfOnePlusPower(double q, int m);

/// What ellipses (m = 2) and superellipses share: the affine image of |x|^m + |y|^m = 1.
struct OvalShape {
  Vec2 center;
  double a = 1;
  double b = 1;
  int m = 2;
  double phi = 0;
  Side side = Side::kConvex;
  bool by_polar_angle = false;  ///< its s is the polar angle, not tau

  std::string WhyInvalid() const;
  double Reach(double angle) const;
  /// A point in the frame of the oval's axes.
  Vec2 InAxes(Vec2 p) const { return RotateBack(SinCos(phi), p - center); }
  /// Between its axes an oval's curvature rises or falls in one way, but for the superellipse's blunt corners.
  static std::vector<double> NormalCuts(double s_begin, double s_end);
  SpanPoint AtNormal(Vec2 n, const TurnedPiece& piece) const;
  /// tau of the point whose outward normal, in the oval's axes, is n: up to rounding and the library's pow and atan2.
  double TauWithNormal(Vec2 n) const;
  /// The curve at place = (cos tau, sin tau), as an affine image of the unit one: its axes turned by `turn`, its centre
  /// at `offset`. O(log m). The curvature is taken from the implicit equation X^m + Y^m = 1, X = |x|/a, Y = |y|/b,
  ///   kappa = (m-1) (X Y)^(m-2) / (a b)^2 / ((X^(m-1)/a)^2 + (Y^(m-1)/b)^2)^(3/2),
  /// which has no difference in it: at the flat points of m > 2 it is 0, not rounding noise.
  template <class T>
  CurveJet<T> Jet(VecOf<T> turn, VecOf<T> offset, VecOf<T> place) const;
};

/// center + R(phi) (a cos s, b sin s); semi-axes a, b > 0, in either order.
struct EllipseEdge {
  static constexpr const char* kName = "ellipse";
  static constexpr CurveKind kKind = CurveKind::kSearched;
  static constexpr bool kIsAngle = true;
  Vec2 center;
  double a = 1;
  double b = 1;
  double phi = 0;  ///< [rad] from the body's x axis to the semi-axis a
  Side side = Side::kConvex;

  static constexpr std::tuple kFields = {Field{"center", &EllipseEdge::center}, Field{"a", &EllipseEdge::a},
                                         Field{"b", &EllipseEdge::b}, Field{"phi", &EllipseEdge::phi},
                                         Field{"side", &EllipseEdge::side}};
  bool operator==(const EllipseEdge&) const = default;
  OvalShape Shape() const { return {center, a, b, 2, phi, side, false}; }
  std::string WhyInvalid() const { return Shape().WhyInvalid(); }
  double Reach(double angle) const { return Shape().Reach(angle); }

  Vec2 Point(double s) const;
  Vec2 Direction(double s) const;
  double AngleAt(Vec2 p) const {
    const Vec2 q = Shape().InAxes(p);
    return AngleOf({q.x / a, q.y / b});
  }
  SpanPoint AtNormal(Vec2 n, const TurnedPiece& piece) const { return Shape().AtNormal(n, piece); }
  std::vector<double> NormalCuts(double s_begin, double s_end) const { return OvalShape::NormalCuts(s_begin, s_end); }
  void AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const {
    segments->push_back({begin, EllipseMoments(a, b, phi, s_begin, s_end), Segment::Base::kChordMiddle});
  }
};

/// center + R(phi) r(s) (cos s, sin s), r(s) = ((cos s/a)^m + (sin s/b)^m)^(-1/m): s is the polar angle. m even, >= 2;
/// m = 2 is an ellipse (with another parameter), and for m > 2 the curvature is 0 where the curve crosses its axes.
struct SuperellipseEdge {
  static constexpr const char* kName = "superellipse";
  static constexpr CurveKind kKind = CurveKind::kSearched;
  static constexpr bool kIsAngle = true;
  Vec2 center;
  double a = 1;
  double b = 1;
  int m = 4;
  double phi = 0;  ///< [rad] as of the ellipse
  Side side = Side::kConvex;

  static constexpr std::tuple kFields = {
      Field{"center", &SuperellipseEdge::center}, Field{"a", &SuperellipseEdge::a},
      Field{"b", &SuperellipseEdge::b},           Field{"phi", &SuperellipseEdge::phi},
      Field{"m", &SuperellipseEdge::m},           Field{"side", &SuperellipseEdge::side}};
  bool operator==(const SuperellipseEdge&) const = default;
  OvalShape Shape() const { return {center, a, b, m, phi, side, true}; }
  std::string WhyInvalid() const;
  double Reach(double angle) const { return Shape().Reach(angle); }

  Vec2 Point(double s) const;
  /// From the gradient of the implicit equation, which keeps all digits at any aspect ratio.
  Vec2 Direction(double s) const;
  double AngleAt(Vec2 p) const { return AngleOf(Shape().InAxes(p)); }
  SpanPoint AtNormal(Vec2 n, const TurnedPiece& piece) const { return Shape().AtNormal(n, piece); }
  std::vector<double> NormalCuts(double s_begin, double s_end) const { return OvalShape::NormalCuts(s_begin, s_end); }
  /// Adaptive Gauss-Kronrod quadrature to a relative 1e-14, in the slope of the polar ray, in which the integrand is
  /// algebraic and does not know the aspect ratio.
  void AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const;
};

}  // namespace lcpbench
