#pragma once

#include <array>
#include <vector>

#include "model/geometry/double_double.h"
#include "model/geometry/feature.h"
#include "model/geometry/placed_shapes.h"

namespace lcpbench {

/// A place on a curve, free of trigonometric functions so that a search can move it in any arithmetic. Oval:
/// (cos tau, sin tau), with tau the parameter of the oval as an affine image of the unit one; Bezier: (s, 0).
template <class T>
struct CurvePlace {
  T x{};
  T y{};
};

/// A curve at a place: derivatives by tau (oval) or s (Bezier), arms from the body's centre of mass in world axes.
template <class T>
struct CurveJet {
  VecOf<T> c;
  VecOf<T> d1;
  VecOf<T> d2;
  VecOf<T> N;  ///< outward unit normal
  T kappa{};   ///< signed curvature
};

/// An ellipse, superellipse or Bezier curve of a body, prepared for many evaluations, in double
/// (brackets) and DoubleDouble (answers). Ovals are searched by tau, not by their own parameter: tau spreads over a
/// flat oval as evenly as over a round one, which a superellipse's polar angle does not.
class SmoothCurve {
 public:
  /// Whether `feature` is of a kind that is searched along: ellipse, superellipse, Bezier.
  static bool Holds(const Feature& feature);

  /// @param placed  its feature valid, of a kind that Holds
  /// @param angles  of the body (where its theta is given) and of an oval's axes, for DoubleDouble
  explicit SmoothCurve(const PlacedFeature& placed, Angles angles = Angles::kRounded);

  bool is_oval() const { return is_oval_; }
  /// Largest extent from the middle: the greater semi-axis, or the length of the control polygon [m].
  double size() const { return size_; }
  /// What counts as curved at all: a curve that can be flat somewhere has its curvature known only up to a small
  /// multiple of this [1/m]; 0 for ellipses, whose curvature cannot vanish.
  double curvature_floor() const { return curvature_floor_; }

  template <class T>
  CurveJet<T> At(const CurvePlace<T>& place) const;

  /// The place of the edge's own parameter s.
  CurvePlace<DoubleDouble> FromParameter(double s) const;
  /// The edge's own parameter; an angle in (-pi, pi], from the library's atan2: for information.
  double Parameter(const CurvePlace<DoubleDouble>& place) const;

  /// The place of tau or s.
  CurvePlace<double> Place(double tau) const;
  /// Moves by `step` in tau (exactly by 2 atan(step/2), which needs no trigonometry) or s (held to the curve's
  /// neighbourhood, kBezierMargin beyond its ends).
  CurvePlace<DoubleDouble> Moved(const CurvePlace<DoubleDouble>& place, DoubleDouble step) const;

  /// The values of tau or s with outward normal n (at most one of them on a monotone piece), for starting from: up to
  /// rounding and the library's pow and atan2.
  std::vector<double> WithNormal(Vec2 n) const;

  /// The piece, between inflections, that s lies on; an oval is one piece. Within a piece the normal turns one way.
  int Piece(double tau) const;
  /// Ends and inflections of a Bezier curve; empty for an oval.
  const std::vector<double>& ends() const { return ends_; }

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
    void Set(const PlacedFeature& placed, Angles angles);
  };
  template <class T>
  const Frame<T>& FrameOf() const;
  template <class T>
  CurveJet<T> OvalAt(const CurvePlace<T>& place) const;
  template <class T>
  CurveJet<T> BezierAt(T s) const;

  bool is_oval_ = true;
  bool by_polar_angle_ = false;  // superellipse: its own parameter is the polar angle, not tau
  double a_ = 1;
  double b_ = 1;
  int m_ = 2;
  double sign_ = 1;  // -1 concave
  double size_ = 1;
  double curvature_floor_ = 0;
  std::vector<double> ends_;
  Frame<double> frame_;
  Frame<DoubleDouble> wide_frame_;
};

}  // namespace lcpbench
