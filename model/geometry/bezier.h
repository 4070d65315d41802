#pragma once

#include <array>

#include "model/geometry/curve.h"

namespace lcpbench {

/// The cubic Bezier curve of the control points P, s in [0, 1], material on the left of increasing s. It may turn
/// either way, so the sign of its curvature varies along it. Its speed |c'| must not vanish.
struct BezierEdge {
  static constexpr const char* kName = "bezier";
  static constexpr CurveKind kKind = CurveKind::kSearched;
  static constexpr bool kIsAngle = false;
  std::array<Vec2, 4> P;

  static constexpr std::tuple kFields = {Field{"P", &BezierEdge::P}};
  bool operator==(const BezierEdge&) const = default;
  std::string WhyInvalid() const;
  double Reach(double /*angle*/) const;

  Vec2 Point(double s) const;
  Vec2 Direction(double s) const;
  /// The point of the piece with that normal, or nearest to it.
  SpanPoint AtNormal(Vec2 n, const TurnedPiece& piece) const;
  /// At inflections, and until each part turns by less than 90 degrees.
  std::vector<double> NormalCuts(double s_begin, double s_end) const;
  /// Until each part turns by less than 90 degrees, once at least; empty where the derivative vanishes on the way: no
  /// piece around that point is turned by so little.
  std::vector<double> EnclosedCuts(double s_begin, double s_end) const;
  Enclosure Enclose(double s_begin, double s_end, Vec2 begin, Vec2 end) const;
  /// Gauss-Legendre quadrature of a degree that makes it exact for these polynomials.
  void AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const;

  /// 0, the inflections, 1.
  std::vector<double> Inflections() const;
  /// The values of s in -slack..1 + slack with outward normal n: at most one of them between inflections.
  std::vector<double> WithNormal(Vec2 n, double slack) const;
  /// The curve of the control points P at s, by de Casteljau's scheme.
  template <class T>
  static CurveJet<T> Jet(const std::array<VecOf<T>, 4>& P, T s);
};

/// The control points of a Bezier curve's piece s0..s1, by de Casteljau's algorithm.
std::array<Vec2, 4> BezierPiece(const BezierEdge& edge, double s0, double s1);

}  // namespace lcpbench
