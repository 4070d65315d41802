#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/geometry/feature.h"
#include "model/geometry/vec2.h"
#include "model/shape/outline.h"

namespace lcpbench {

// Numbers, names and elements as SVG takes them; independent of the locale.

/// Pixels, to 1/100.
std::string Px(double value);
/// "x y".
std::string Px(Vec2 p);
/// Three significant digits; without an exponent where that is readable.
std::string Short(double value);
/// The largest of 1, 2, 5 times a power of ten that is <= value > 0: lengths for scales.
double RoundDown(double value);
/// As XML character data or attribute value.
std::string Escape(std::string_view text);
/// Letters, digits and dashes: fit for an id and a url(#...).
std::string Identifier(std::string_view text);

/// How a shape is drawn.
struct Paint {
  std::string_view stroke = "none";
  double width = 0;  ///< of the stroke [px]
  std::string_view fill = "none";
  std::string_view more = "";  ///< further attributes
};
std::string SvgPath(const std::string& path, const Paint& paint);
std::string SvgCircle(Vec2 center, double radius, const Paint& paint);
/// An arrow with its head at `to`; nothing where it has no length.
std::string SvgArrow(Vec2 from, Vec2 to, double width, std::string_view color);
/// @param text  not escaped yet
/// @param more  further attributes
std::string SvgText(Vec2 at, double size, std::string_view text, std::string_view more);

// Outlines as path commands of SVG, which Path2D of browsers reads too: in the body's frame, y up, `unit` path units
// per metre.

/// Arcs and ellipses as A, Bezier curves as C, what SVG has no command for (superellipses, arcs too flat for a
/// renderer's floats) as a polygon within kFlatness of the curve. `move` leads to the piece's start: "M" or "L".
std::string PiecePath(const OutlineEdge& piece, double unit, std::string_view move);
/// Pieces that join, as one line that may stay open.
std::string PiecesPath(const std::vector<OutlineEdge>& pieces, double unit);

/// All loops, closed. Fill by the even-odd rule: holes stay empty.
std::string OutlinePath(const Outline& outline, double unit);

/// The band between the piece and its copy, moved `depth` path units into the material: for hatching, closed.
std::string BandPath(const OutlineEdge& piece, double unit, double depth);

/// Parameters from s_begin to s_end between which the piece is straight to within `flatness` [m].
std::vector<double> FlatParameters(const OutlineEdge& piece, double flatness);

/// Whether the outline encloses material of its own, and not, as a floor or the rim of a round track does, bounds the
/// material of the whole plane beyond: its first loop closes and runs counter-clockwise.
bool IsBounded(const Outline& outline);

/// The whole curve that an edge stands for, a straight edge and a Bezier curve from end to end; none for a vertex.
std::vector<OutlineEdge> WholeCurve(const Feature& feature);

/// Path units.
inline constexpr double kFlatness = 0.05;

}  // namespace lcpbench
