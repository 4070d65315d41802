#pragma once

#include <string>
#include <variant>

#include "model/geometry/arc.h"
#include "model/geometry/bezier.h"
#include "model/geometry/oval.h"
#include "model/geometry/straight_edge.h"

namespace lcpbench {

/// Lambdas as one visitor for std::visit.
template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// A corner of an outline, or a point of attachment.
struct Vertex {
  static constexpr const char* kName = "vertex";
  Vec2 p;

  static constexpr std::tuple kFields = {Field{"p", &Vertex::p}};
  bool operator==(const Vertex&) const = default;
  static std::string WhyInvalid() { return ""; }
};

/// The edges that outlines are made of: a closed set. A curve is a struct of its numbers, in a file of its own, with
///   kName, kKind     its name in records; how closest points of it are found
///   kIsAngle         s is an angle [rad], of a curve with a side; else s lies in [0, 1]
///   kFields          all its numbers with their names, in a fixed order. A Vec2 is a point of the body frame,
///                    `phi` an angle from the body's x axis; a curve of angles without phi takes s from that axis
///   WhyInvalid       what its numbers, finite, must satisfy, in words, where they do not; else ""
///   Reach            the lengths that its points are computed from [m]: their rounding errors are a few epsilon of it
///   Point, Direction at s: the point; a vector in the direction of dp/ds of unspecified length > 0, 0 where a Bezier
///                    curve's derivative vanishes. The same bits everywhere
///   AngleAt          of kIsAngle: the s of a point of the curve, by AngleOf
///   AtNormal         of a piece turned into the world's axes: the point with outward normal n, its curvature and place
///   NormalCuts       of kSearched: values of s that cut a piece into parts that turn one way and by at most a quarter
///                    turn, in the sense of travel, with both ends
///   EnclosedCuts, Enclose  of curves that turn either way: see below
///   AppendMoments    the moments of the region between a piece and its chord (area_moments.h)
/// Curves of kSearched also give SmoothCurve (smooth_curve.h) what it asks. Everything else reaches these through one
/// std::visit, so that a curve that lacks one of them does not compile.
using OutlineCurve = std::variant<StraightEdge, ArcEdge, EllipseEdge, SuperellipseEdge, BezierEdge>;

/// Body-frame features of an outline. Features are meant locally, around a contact point: a straight edge stands for
/// its line, an arc for its circle, an ellipse or superellipse for the whole oval; a Bezier curve ends at s = 0 and 1.
using Feature = std::variant<Vertex, StraightEdge, ArcEdge, EllipseEdge, SuperellipseEdge, BezierEdge>;

/// The piece s_begin..s_end of an edge, by the parameter s of its declaration: one part of a body's outline. The
/// material lies on the left of the direction of travel: s_begin < s_end on straight and Bezier edges and on convex
/// curves, s_begin > s_end on concave curves.
struct OutlineEdge {
  OutlineCurve edge;
  double s_begin = 0;
  double s_end = 1;
  bool operator==(const OutlineEdge&) const = default;
};
/// The name under which outlines, their checks and their mass properties speak of a piece.
using OutlinePiece = OutlineEdge;

Feature ToFeature(const OutlineCurve& curve);
inline bool IsVertex(const Feature& feature) { return std::holds_alternative<Vertex>(feature); }
/// Whether closest points are found by a search along the feature, from and to a parameter s.
bool IsSearched(const Feature& feature);

inline Vec2 CurvePoint(const OutlineCurve& curve, double s) {
  return std::visit([s](const auto& e) { return e.Point(s); }, curve);
}
inline Vec2 CurveDirection(const OutlineCurve& curve, double s) {
  return std::visit([s](const auto& e) { return e.Direction(s); }, curve);
}
/// The lengths that the piece's points are computed from [m].
double Reach(const OutlinePiece& piece);

/// Values of s that cut a piece into two parts or more that Enclose can hold, in the sense of travel, with both ends:
/// equal parts of at most a quarter turn of an angle, unless the curve says otherwise; empty for a Bezier curve whose
/// derivative vanishes on the way.
std::vector<double> EnclosedCuts(const OutlinePiece& piece);
/// Encloses a part that turns one way by the triangle of its chord and end tangents, unless the curve says otherwise.
Enclosure Enclose(const OutlineCurve& curve, double s_begin, double s_end);

/// c -> R(rotation) c + shift. `angle` is the rotation's angle [rad], added to phi, or to the curve parameters of arcs.
OutlinePiece Transformed(const OutlinePiece& piece, double angle, Vec2 shift);

/// Visits all Vec2 of a feature or curve, which are its points of the body frame.
template <class Curve, class Visit>
void ForEachPoint(Curve& curve, const Visit& visit) {
  const auto take = [&](const char* /*name*/, auto& value) {
    if constexpr (requires { value.x; }) visit(value);
    if constexpr (requires { value[0].x; }) {
      for (auto& p : value) visit(p);
    }
  };
  std::visit([&](auto& e) { ForEachField(e, take); }, curve);
}

/// All numbers of a feature in the order of its kFields, the side as 0 (convex) or 1, after the kind's own number.
std::vector<double> NumbersOf(const Feature& feature);

/// What a feature of a contact or a piece of an outline must satisfy, in words, where it does not; else empty: every
/// number is finite; lengths, radii and semi-axes are > 0 with finite curvatures; semi-axes differ by a factor of at
/// most kMaxAspectRatio; m is even and in 2..kMaxSuperellipseExponent; and a Bezier curve's speed |c'| vanishes nowhere
/// on [0, 1] (beyond 1e-10 of its largest control step).
std::string WhyInvalid(const Feature& feature);

/// @throws InputError naming the condition and the feature, unless WhyInvalid is empty
void RequireValid(const Feature& feature);

/// The same of a piece: its edge, and a parameter range that the kind allows, in the sense of travel that its side
/// demands.
std::string WhyInvalid(const OutlinePiece& piece);

/// @throws InputError, beginning with `where`, unless WhyInvalid is empty
void RequireValidPiece(const OutlinePiece& piece, const std::string& where);

/// "(x, y)", for error texts: numbers that read back as the same.
std::string Text(Vec2 p);

/// One line for error texts: the kind and its numbers.
std::string Describe(const Feature& feature);

}  // namespace lcpbench
