#include "benchmarks/drawing/picture_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "benchmarks/drawing/svg_text.h"
#include "model/geometry/feature.h"
#include "model/geometry/overloaded.h"
#include "model/scenes/parts.h"

namespace lcpbench {
namespace {

/// Beyond this radius renderers, which compute with floats, place an arc visibly wrong [page units].
constexpr double kLargestArc = 1e5;

/// An arc of an ellipse as SVG arcs of at most 120 degrees: which of the two possible arcs is meant is then beyond
/// doubt, however the end points are rounded.
std::string ArcPath(const OutlineEdge& piece, const PageMap& map, double a, double b, double phi) {
  const double range = piece.s_end - piece.s_begin;
  const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(range) / (2 * kPi / 3) - 1e-9)));
  const double degrees = (map.y_down ? -1 : 1) * (phi + map.theta) * 180 / kPi;
  const std::string radii = "A" + Px(map.scale * a) + " " + Px(map.scale * b) + " " +
                            (a == b ? "0" : Px(std::remainder(degrees, 360))) +
                            ((range > 0) == map.y_down ? " 0 0 " : " 0 1 ");
  std::string path;
  for (int k = 1; k <= parts; ++k) {
    path += radii + Px(map(CurvePoint(piece.edge, piece.s_begin + range * k / parts)));
  }
  return path;
}

std::string PolygonPath(const OutlineEdge& piece, const PageMap& map) {
  std::string path;
  const std::vector<double> parameters = FlatParameters(piece, kFlatness / map.scale);
  for (std::size_t k = 1; k < parameters.size(); ++k) path += "L" + Px(map(CurvePoint(piece.edge, parameters[k])));
  return path;
}

double DistanceToChord(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 chord = b - a;
  const double length = Norm(chord);
  return length > 0 ? std::abs(Cross(chord, p - a)) / length : Norm(p - a);
}

class Flattening {
 public:
  Flattening(const OutlineCurve& curve, double flatness) : curve_(curve), flatness_(flatness) {}

  void Add(double begin, double end, int depth) {
    const Vec2 a = CurvePoint(curve_, begin);
    const Vec2 b = CurvePoint(curve_, end);
    bool flat = true;
    for (const double share : {0.25, 0.5, 0.75}) {
      flat = flat && DistanceToChord(CurvePoint(curve_, begin + share * (end - begin)), a, b) <= flatness_;
    }
    if (flat || depth == 0) {
      parameters.push_back(end);
    } else {
      const double middle = (begin + end) / 2;
      Add(begin, middle, depth - 1);
      Add(middle, end, depth - 1);
    }
  }

  std::vector<double> parameters;

 private:
  const OutlineCurve& curve_;
  double flatness_;
};

/// The unit vector at s into the material, on the left of travel.
Vec2 Inward(const OutlineEdge& piece, double s) {
  const Vec2 along = CurveDirection(piece.edge, s);
  const double sign = piece.s_end > piece.s_begin ? 1 : -1;
  return (sign / std::max(Norm(along), std::numeric_limits<double>::min())) * Perp(along);
}

}  // namespace

EdgeKind KindOf(const OutlineCurve& curve) {
  return std::visit(Overloaded{[](const StraightEdge& /*edge*/) { return EdgeKind::kStraight; },
                               [](const ArcEdge& edge) {
                                 return edge.side == Side::kConvex ? EdgeKind::kConvexArc : EdgeKind::kConcaveArc;
                               },
                               [](const EllipseEdge& /*edge*/) { return EdgeKind::kEllipse; },
                               [](const SuperellipseEdge& /*edge*/) { return EdgeKind::kSuperellipse; },
                               [](const BezierEdge& /*edge*/) { return EdgeKind::kBezier; }},
                    curve);
}

Vec2 ToWorld(const Body& body, Vec2 p) { return body.x + Rotate(SinCos(body.theta), p); }

std::vector<double> FlatParameters(const OutlineEdge& piece, double flatness) {
  if (std::holds_alternative<StraightEdge>(piece.edge)) return {piece.s_begin, piece.s_end};
  // Fine enough to start with that no turn of a Bezier curve or corner of a superellipse hides between samples.
  constexpr int kParts = 16;
  constexpr int kMaxDepth = 8;
  Flattening flattening(piece.edge, flatness);
  flattening.parameters.push_back(piece.s_begin);
  const double range = piece.s_end - piece.s_begin;
  for (int k = 0; k < kParts; ++k) {
    flattening.Add(piece.s_begin + range * k / kParts, piece.s_begin + range * (k + 1) / kParts, kMaxDepth);
  }
  flattening.parameters.back() = piece.s_end;
  return flattening.parameters;
}

std::string PiecePath(const OutlineEdge& piece, const PageMap& map, std::string_view move) {
  std::string path = std::string(move) + Px(map(CurvePoint(piece.edge, piece.s_begin)));
  path += std::visit(
      Overloaded{[&](const StraightEdge& /*edge*/) { return "L" + Px(map(CurvePoint(piece.edge, piece.s_end))); },
                 [&](const ArcEdge& edge) {
                   return edge.radius * map.scale > kLargestArc ? PolygonPath(piece, map)
                                                                : ArcPath(piece, map, edge.radius, edge.radius, 0);
                 },
                 [&](const EllipseEdge& edge) {
                   return std::max(edge.a, edge.b) * map.scale > kLargestArc
                              ? PolygonPath(piece, map)
                              : ArcPath(piece, map, edge.a, edge.b, edge.phi);
                 },
                 [&](const SuperellipseEdge& /*edge*/) { return PolygonPath(piece, map); },
                 [&](const BezierEdge& edge) {
                   const auto P = BezierPiece(edge, piece.s_begin, piece.s_end);
                   return "C" + Px(map(P[1])) + " " + Px(map(P[2])) + " " + Px(map(P[3]));
                 }},
      piece.edge);
  return path;
}

std::string OutlinePath(const Outline& outline, const PageMap& map) {
  std::string path;
  for (const OutlineLoop& loop : outline.loops) {
    std::string_view move = "M";
    for (const OutlinePiece& piece : loop) {
      path += PiecePath(piece, map, move);
      move = "L";
    }
    path += 'Z';
  }
  return path;
}

std::string BandPath(const OutlineEdge& piece, const PageMap& map, double depth) {
  const std::vector<double> parameters = FlatParameters(piece, kFlatness / map.scale);
  const bool closed =
      Norm(CurvePoint(piece.edge, piece.s_end) - CurvePoint(piece.edge, piece.s_begin)) * map.scale < kFlatness;
  std::string path = PiecePath(piece, map, "M");
  for (std::size_t k = parameters.size(); k-- > 0;) {
    const double s = parameters[k];
    // A closed curve's band is a ring: two loops.
    path += k + 1 == parameters.size() && closed ? "ZM" : "L";
    path += Px(map(CurvePoint(piece.edge, s) + (depth / map.scale) * Inward(piece, s)));
  }
  return path + "Z";
}

std::optional<OutlineEdge> WholeCurve(const Feature& feature) {
  const auto round = [](const auto& edge) {
    const bool convex = edge.side == Side::kConvex;
    return std::optional<OutlineEdge>({edge, convex ? 0 : 2 * kPi, convex ? 2 * kPi : 0});
  };
  return std::visit(
      Overloaded{[](const Vertex& /*vertex*/) { return std::optional<OutlineEdge>(); },
                 [](const StraightEdge& edge) {
                   return std::optional<OutlineEdge>({edge, 0, 1});
                 },
                 [](const BezierEdge& edge) {
                   return std::optional<OutlineEdge>({edge, 0, 1});
                 },
                 [&](const ArcEdge& edge) { return round(edge); }, [&](const EllipseEdge& edge) { return round(edge); },
                 [&](const SuperellipseEdge& edge) { return round(edge); }},
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
