#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/drawing/picture_style.h"
#include "model/contact/body.h"
#include "model/geometry/feature.h"
#include "model/geometry/trig.h"
#include "model/geometry/vec2.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Where a body-frame point is drawn: origin + scale R p, then mirrored where the page's y axis points down.
struct PageMap {
  Vec2 origin;        ///< page, of the body frame's origin
  double scale = 1;   ///< page units per metre
  Rotation rotation;  ///< of the body
  double theta = 0;   ///< its angle [rad]
  bool y_down = true;

  Vec2 operator()(Vec2 p) const {
    const Vec2 turned = scale * Rotate(rotation, p);
    return origin + Vec2{turned.x, y_down ? -turned.y : turned.y};
  }
};

/// A fixed body that moves, or begins to, as prescribed.
bool IsDriven(const Body& body);

Vec2 ToWorld(const Body& body, Vec2 p);

/// The piece as path commands of SVG, which Path2D of browsers reads too: arcs and ellipses as A, Bezier curves as C,
/// what SVG has no command for (superellipses, arcs too flat for a renderer's floats) as a polygon within kFlatness of
/// the curve. `move` is the command that leads to its start: "M" or "L".
std::string PiecePath(const OutlineEdge& piece, const PageMap& map, std::string_view move);

/// All loops, closed. Fill by the even-odd rule: holes stay empty.
std::string OutlinePath(const Outline& outline, const PageMap& map);

/// The band between the piece and its copy, moved `depth` page units into the material: for hatching, closed.
std::string BandPath(const OutlineEdge& piece, const PageMap& map, double depth);

/// Parameters from s_begin to s_end between which the piece is straight to within `flatness` [m].
std::vector<double> FlatParameters(const OutlineEdge& piece, double flatness);

/// Whether the outline encloses material of its own, and not, as a floor or the rim of a round track does, bounds the
/// material of the whole plane beyond: its first loop closes and runs counter-clockwise.
bool IsBounded(const Outline& outline);

/// The whole curve that an edge stands for, a straight edge and a Bezier curve from end to end; none for a vertex.
std::optional<OutlineEdge> WholeCurve(const Feature& feature);

/// Page units.
inline constexpr double kFlatness = 0.05;

}  // namespace lcpbench
