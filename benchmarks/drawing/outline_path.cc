#include "benchmarks/drawing/outline_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "benchmarks/drawing/svg_text.h"
#include "model/geometry/feature.h"
#include "model/scenes/parts.h"

namespace lcpbench {
namespace {

/// Beyond this radius renderers, which compute with floats, place an arc visibly wrong [page units].
constexpr double kLargestArc = 1e5;

std::string PointAt(const OutlineEdge& piece, double unit, double s) { return Px(unit * CurvePoint(piece.edge, s)); }

/// An arc of an ellipse as SVG arcs of at most 120 degrees: which of the two possible arcs is meant is then beyond
/// doubt, however the end points are rounded.
std::string ArcPath(const OutlineEdge& piece, double unit, double a, double b, double phi) {
  const double range = piece.s_end - piece.s_begin;
  const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(range) / (2 * kPi / 3) - 1e-9)));
  const std::string radii = "A" + Px({unit * a, unit * b}) + " " +
                            (a == b ? "0" : Px(std::remainder(phi * 180 / kPi, 360))) + (range > 0 ? " 0 1 " : " 0 0 ");
  std::string path;
  for (int k = 1; k <= parts; ++k) path += radii + PointAt(piece, unit, piece.s_begin + range * k / parts);
  return path;
}

std::string PolygonPath(const OutlineEdge& piece, double unit) {
  std::string path;
  const std::vector<double> parameters = FlatParameters(piece, kFlatness / unit);
  for (std::size_t k = 1; k < parameters.size(); ++k) path += "L" + PointAt(piece, unit, parameters[k]);
  return path;
}

/// Appends the ends of flat parts from `begin`, which is there, to `end`.
void Flatten(const OutlineCurve& curve, double flatness, double begin, double end, int depth,
             std::vector<double>* parameters) {
  const Vec2 a = CurvePoint(curve, begin);
  const Vec2 chord = CurvePoint(curve, end) - a;
  const double length = Norm(chord);
  bool flat = true;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Vec2 p = CurvePoint(curve, begin + share * (end - begin)) - a;
    flat = flat && (length > 0 ? std::abs(Cross(chord, p)) / length : Norm(p)) <= flatness;
  }
  if (flat || depth == 0) {
    parameters->push_back(end);
  } else {
    const double middle = (begin + end) / 2;
    Flatten(curve, flatness, begin, middle, depth - 1, parameters);
    Flatten(curve, flatness, middle, end, depth - 1, parameters);
  }
}

/// The unit vector at s into the material, on the left of travel.
Vec2 Inward(const OutlineEdge& piece, double s) {
  const Vec2 along = CurveDirection(piece.edge, s);
  const double sign = piece.s_end > piece.s_begin ? 1 : -1;
  return (sign / std::max(Norm(along), std::numeric_limits<double>::min())) * Perp(along);
}

}  // namespace

std::vector<double> FlatParameters(const OutlineEdge& piece, double flatness) {
  if (std::holds_alternative<StraightEdge>(piece.edge)) return {piece.s_begin, piece.s_end};
  // Fine enough to start with that no turn of a Bezier curve or corner of a superellipse hides between samples.
  constexpr int kParts = 16;
  constexpr int kMaxDepth = 8;
  std::vector<double> parameters = {piece.s_begin};
  const double range = piece.s_end - piece.s_begin;
  for (int k = 0; k < kParts; ++k) {
    Flatten(piece.edge, flatness, piece.s_begin + range * k / kParts, piece.s_begin + range * (k + 1) / kParts,
            kMaxDepth, &parameters);
  }
  parameters.back() = piece.s_end;
  return parameters;
}

std::string PiecePath(const OutlineEdge& piece, double unit, std::string_view move) {
  const auto arc_or_polygon = [&](double a, double b, double phi) {
    return std::max(a, b) * unit > kLargestArc ? PolygonPath(piece, unit) : ArcPath(piece, unit, a, b, phi);
  };
  return std::string(move) + PointAt(piece, unit, piece.s_begin) +
         std::visit(Overloaded{[&](const StraightEdge& /*edge*/) { return "L" + PointAt(piece, unit, piece.s_end); },
                               [&](const ArcEdge& edge) { return arc_or_polygon(edge.radius, edge.radius, 0); },
                               [&](const EllipseEdge& edge) { return arc_or_polygon(edge.a, edge.b, edge.phi); },
                               [&](const SuperellipseEdge& /*edge*/) { return PolygonPath(piece, unit); },
                               [&](const BezierEdge& edge) {
                                 const auto P = BezierPiece(edge, piece.s_begin, piece.s_end);
                                 return "C" + Px(unit * P[1]) + " " + Px(unit * P[2]) + " " + Px(unit * P[3]);
                               }},
                    piece.edge);
}

std::string OutlinePath(const Outline& outline, double unit) {
  std::string path;
  for (const OutlineLoop& loop : outline.loops) {
    std::string_view move = "M";
    for (const OutlinePiece& piece : loop) {
      path += PiecePath(piece, unit, move);
      move = "L";
    }
    path += 'Z';
  }
  return path;
}

std::string BandPath(const OutlineEdge& piece, double unit, double depth) {
  const std::vector<double> parameters = FlatParameters(piece, kFlatness / unit);
  const bool closed =
      Norm(CurvePoint(piece.edge, piece.s_end) - CurvePoint(piece.edge, piece.s_begin)) * unit < kFlatness;
  std::string path = PiecePath(piece, unit, "M");
  for (std::size_t k = parameters.size(); k-- > 0;) {
    const double s = parameters[k];
    // A closed curve's band is a ring: two loops.
    path += k + 1 == parameters.size() && closed ? "ZM" : "L";
    path += Px(unit * CurvePoint(piece.edge, s) + depth * Inward(piece, s));
  }
  return path + "Z";
}

std::optional<OutlineEdge> WholeCurve(const Feature& feature) {
  return std::visit(
      [](const auto& edge) -> std::optional<OutlineEdge> {
        if constexpr (requires { edge.side; }) {
          const bool convex = edge.side == Side::kConvex;
          return OutlineEdge{edge, convex ? 0 : 2 * kPi, convex ? 2 * kPi : 0};
        } else if constexpr (requires { edge.kIsAngle; }) {
          return OutlineEdge{edge, 0, 1};
        } else {
          return std::nullopt;
        }
      },
      feature);
}

bool IsBounded(const Outline& outline) {
  if (outline.loops.empty() || outline.loops.front().empty()) return false;
  const OutlineLoop& loop = outline.loops.front();
  const Vec2 first = CurvePoint(loop.front().edge, loop.front().s_begin);
  const Vec2 last = CurvePoint(loop.back().edge, loop.back().s_end);
  double twice_area = 0;
  double size = 0;
  Vec2 before{};
  for (const OutlinePiece& piece : loop) {
    constexpr int kSamples = 16;
    for (int k = 1; k <= kSamples; ++k) {
      const Vec2 p = CurvePoint(piece.edge, piece.s_begin + (piece.s_end - piece.s_begin) * k / kSamples) - first;
      twice_area += Cross(before, p);
      size = std::max(size, Norm(p));
      before = p;
    }
  }
  constexpr double kClosed = 1e-6;
  return Norm(last - first) <= kClosed * size && twice_area > 0;
}

}  // namespace lcpbench
