#pragma once

#include <array>
#include <optional>
#include <tuple>
#include <vector>

#include "model/geometry/double_double.h"
#include "model/geometry/feature.h"

namespace lcpbench {

/// A body's feature placed in the world: a body-frame point c is at x + R(theta) c.
struct PlacedFeature {
  const Feature& feature;
  Vec2 x;             ///< the body's centre of mass [m]
  Rotation rotation;  ///< SinCos(theta)
  /// Where given, pairs whose contact point depends strongly on the angle are placed by it to twice the digits.
  std::optional<double> theta = std::nullopt;
};

/// The (cos, sin) of a rotation by theta; a double has room for rounded angles only.
template <class T>
VecOf<T> TurnOf(Rotation rotation, std::optional<double> theta, Angles angles) {
  if constexpr (std::is_same_v<T, DoubleDouble>) {
    if (angles == Angles::kExact && theta) return ExactRotation(*theta);
  }
  return LiftRotation<T>(rotation);
}

/// A place on a curve, free of trigonometric functions so that a search can move it in any arithmetic. Oval:
/// (cos tau, sin tau), with tau the parameter of the oval as an affine image of the unit one; Bezier: (s, 0).
template <class T>
using CurvePlace = VecOf<T>;

/// A curve of kSearched (IsSearched, feature.h) of a body, prepared for many evaluations, in double (brackets) and
/// DoubleDouble (answers). Ovals are searched by tau, not by their own parameter: tau spreads over a flat oval as
/// evenly as over a round one, which a superellipse's polar angle does not.
class SmoothCurve {
 public:
  /// @param placed  its feature valid
  /// @param angles  of the body (where its theta is given) and of an oval's axes, for DoubleDouble
  explicit SmoothCurve(const PlacedFeature& placed, Angles angles = Angles::kRounded);

  bool is_oval() const { return is_oval_; }
  /// Largest extent from the middle: the greater semi-axis, or the length of the control polygon [m].
  double size() const { return size_; }
  /// What counts as curved at all: a curve that can be flat somewhere has its curvature known only up to a small
  /// multiple of this [1/m]; 0 for ellipses, whose curvature cannot vanish.
  double curvature_floor() const { return curvature_floor_; }

  template <class T>
  CurveJet<T> At(const CurvePlace<T>& place) const {
    const auto& frame = std::get<Frame<T>>(frames_);
    return is_oval_ ? oval_.Jet(frame.turn, frame.offset, place) : BezierEdge::Jet(frame.P, place.x);
  }

  /// The place of the edge's own parameter s.
  CurvePlace<DoubleDouble> FromParameter(double s) const;
  /// The edge's own parameter; an angle in (-pi, pi], from the library's atan2: for information.
  double Parameter(const CurvePlace<DoubleDouble>& place) const;
  /// The place of tau or s.
  CurvePlace<double> Place(double tau) const;
  CurvePlace<DoubleDouble> WidePlace(double tau) const;
  /// Moves by `step` in tau (exactly by 2 atan(step/2), which needs no trigonometry) or s (held to the curve's
  /// neighbourhood, kBezierMargin beyond its ends).
  CurvePlace<DoubleDouble> Moved(const CurvePlace<DoubleDouble>& place, DoubleDouble step) const;
  /// Whether a place is on the curve: a Bezier curve has ends.
  bool Holds(const CurvePlace<DoubleDouble>& place) const {
    return is_oval_ || (place.x.hi >= -kEndSlack && place.x.hi <= 1 + kEndSlack);
  }

  /// The values of tau or s with outward normal n (at most one of them on a monotone piece), for starting from: up to
  /// rounding and the library's pow and atan2.
  std::vector<double> WithNormal(Vec2 n) const;
  /// The piece, between inflections, that s lies on; an oval is one piece. Within a piece the normal turns one way.
  int Piece(double tau) const;

  /// The values of tau or s that the curve is sampled at to bracket stationary points, ascending: kSamples spread
  /// evenly, ends and inflections, and those with the given outward normals. An oval's first comes again at the end, a
  /// turn later.
  std::vector<double> Samples(const std::vector<Vec2>& outward_normals) const;
  /// The normals that face its evenly spread points and its ends.
  std::vector<Vec2> FacingNormals() const;

  static constexpr int kSamples = 128;
  static constexpr double kBezierMargin = 0.25;
  /// How far beyond s = 0 or 1 a closest point still counts as the end's own.
  static constexpr double kEndSlack = 1e-6;

 private:
  // The curve in world axes, once for each arithmetic.
  template <class T>
  struct Frame {
    VecOf<T> turn;              // oval: (cos, sin) of theta + phi
    VecOf<T> offset;            // oval: its centre
    std::array<VecOf<T>, 4> P;  // Bezier
  };
  template <class T>
  void SetFrame(const PlacedFeature& placed, const BezierEdge& bezier, Angles angles);

  bool is_oval_ = true;
  OvalShape oval_;
  double size_ = 1;
  double curvature_floor_ = 0;
  std::vector<double> ends_;  // and inflections of a Bezier curve
  std::tuple<Frame<double>, Frame<DoubleDouble>> frames_;
};

}  // namespace lcpbench
