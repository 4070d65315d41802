#include "benchmarks/drawing/svg.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <variant>

#include "model/contact/path.h"
#include "model/geometry/feature.h"
#include "model/scenes/parts.h"

namespace lcpbench {
namespace {

std::string Text(double value, std::chars_format format, int decimals) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, decimals);
  return {buffer.data(), end.ptr};
}

/// Fixed notation without trailing zeros.
std::string Number(double value, int decimals) {
  if (std::abs(value) > 1e15) return "0";
  std::string text = Text(value, std::chars_format::fixed, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string Attributes(const Paint& paint) {
  std::string text = "\" fill=\"" + std::string(paint.fill) + '"';
  if (paint.width > 0) text += " stroke=\"" + std::string(paint.stroke) + "\" stroke-width=\"" + Px(paint.width) + '"';
  return text + std::string(paint.more) + "/>";
}

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

std::string Px(double value) { return Number(value, 2); }

std::string Px(Vec2 p) { return Px(p.x) + " " + Px(p.y); }

std::string Short(double value) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-3 || size >= 1e6) return Text(value, std::chars_format::scientific, 2);
  return Number(value, std::max(0, 2 - static_cast<int>(std::floor(std::log10(size)))));
}

double RoundDown(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  return (value >= 5 * decade ? 5 : value >= 2 * decade ? 2 : 1) * decade;
}

std::string Escape(std::string_view text) {
  constexpr std::string_view kSpecial = "&<>\"";
  constexpr std::array kNames = {"&amp;", "&lt;", "&gt;", "&quot;"};
  std::string escaped;
  for (const char c : text) {
    const std::size_t at = kSpecial.find(c);
    escaped += at == std::string_view::npos ? std::string(1, c) : kNames[at];
  }
  return escaped;
}

std::string Identifier(std::string_view text) {
  std::string id = "s" + std::string(text);
  std::replace_if(
      id.begin(), id.end(), [](unsigned char c) { return c >= 0x80 || std::isalnum(c) == 0; }, '-');
  return id;
}

std::string SvgPath(const std::string& path, const Paint& paint) {
  return "<path d=\"" + path + Attributes(paint) + "\n";
}

std::string SvgCircle(Vec2 center, double radius, const Paint& paint) {
  return "<circle cx=\"" + Px(center.x) + "\" cy=\"" + Px(center.y) + "\" r=\"" + Px(radius) + Attributes(paint) + "\n";
}

std::string SvgArrow(Vec2 from, Vec2 to, double width, std::string_view color) {
  const double length = Norm(to - from);
  if (!(length > 0)) return "";
  const Vec2 unit = (1 / length) * (to - from);
  const double head = std::min(4 * width, 0.6 * length);
  const Vec2 neck = to - head * unit;
  const Vec2 side = (0.45 * head) * Perp(unit);
  return SvgPath("M" + Px(from) + "L" + Px(neck), {color, width, "none", " stroke-linecap=\"butt\""}) +
         SvgPath("M" + Px(to) + "L" + Px(neck + side) + "L" + Px(neck - side) + "Z", {.fill = color});
}

std::string SvgText(Vec2 at, double size, std::string_view text, std::string_view more) {
  return "<text x=\"" + Px(at.x) + "\" y=\"" + Px(at.y) + "\" font-size=\"" + Px(size) + '"' + std::string(more) + ">" +
         Escape(text) + "</text>\n";
}

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

std::string PiecesPath(const std::vector<OutlineEdge>& pieces, double unit) {
  std::string path;
  for (const OutlineEdge& piece : pieces) path += PiecePath(piece, unit, path.empty() ? "M" : "L");
  return path;
}

std::string OutlinePath(const Outline& outline, double unit) {
  std::string path;
  for (const OutlineLoop& loop : outline.loops) path += PiecesPath(loop, unit) + 'Z';
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

std::vector<OutlineEdge> WholeCurve(const Feature& feature) {
  return std::visit(
      [](const auto& edge) -> std::vector<OutlineEdge> {
        if constexpr (requires { edge.side; }) {
          const bool convex = edge.side == Side::kConvex;
          return {{edge, convex ? 0 : 2 * kPi, convex ? 2 * kPi : 0}};
        } else if constexpr (requires { edge.kIsAngle; }) {
          return {{edge, 0, 1}};
        } else {
          return {};
        }
      },
      feature);
}

bool IsBounded(const Outline& outline) {
  if (outline.loops.empty() || outline.loops.front().empty()) return false;
  const OutlineLoop& loop = outline.loops.front();
  return IsClosed(loop) && LoopMoments(loop, CurvePoint(loop.front().edge, loop.front().s_begin)).area > 0;
}

}  // namespace lcpbench
