#pragma once

#include <array>
#include <string>
#include <variant>

#include "model/geometry/curve.h"
#include "model/geometry/feature.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// The name under which outlines, their checks and their mass properties speak of a piece.
using OutlinePiece = OutlineEdge;

/// x^n by repeated multiplication, n >= 0: the same bits everywhere.
double IntegerPower(double x, int n);

/// (1 + q^m)^(1/m) for |q| <= 1 and even m >= 2, to a few units in the last place, by Newton's iteration in plain
/// arithmetic: the same bits everywhere.
double RootOfOnePlusPower(double q, int m);

/// The curve's point at s. Formulas as at the declarations; sines and cosines correctly rounded.
Vec2 CurvePoint(const OutlineCurve& curve, double s);

/// A vector in the direction of dp/ds, of unspecified length > 0; 0 where a Bezier curve's derivative vanishes. For the
/// superellipse taken from the gradient of its implicit equation, which keeps all digits at any aspect ratio.
Vec2 CurveDirection(const OutlineCurve& curve, double s);

/// The control points of a Bezier curve's piece s0..s1, by de Casteljau's algorithm.
std::array<Vec2, 4> BezierPiece(const BezierEdge& edge, double s0, double s1);

/// The lengths that the piece's points are computed from [m]: their rounding errors are a few epsilon of it.
double Reach(const OutlinePiece& piece);

/// c -> R(rotation) c + shift. `angle` is the rotation's angle [rad], added to the curve parameters of arcs and to phi.
OutlinePiece Transformed(const OutlinePiece& piece, double angle, Vec2 shift);

/// One line for error texts: the kind and its numbers.
std::string DescribeCurve(const OutlineCurve& curve);

/// @throws InputError, beginning with `where`, unless the edge is valid (WhyInvalid, curve.h) and the parameter range
/// is
///         one the kind allows, in the sense of travel that its side demands
void RequireValidPiece(const OutlinePiece& piece, const std::string& where);

}  // namespace lcpbench
