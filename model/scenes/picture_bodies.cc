#include <algorithm>
#include <array>
#include <cmath>

#include "model/detection.h"
#include "model/scenes/parts.h"
#include "model/scenes/picture_parts.h"
#include "model/scenes/svg_text.h"

namespace lcpbench {
namespace {

// Bodies smaller than this show no centre of mass [px].
constexpr double kSmallBody = 24;

std::string PatternId(const Picture& picture, const Body& body) {
  return picture.id + (IsDriven(body) ? "-driven" : "-fixed");
}

std::string Tooltip(const Body& body) {
  std::string text = body.name + ", ";
  if (!body.fixed) text += Short(body.mass) + " kg, ";
  if (body.fixed && !IsDriven(body)) return text + "fixed";
  if (body.fixed) text += "driven, ";
  return text + "v = (" + Short(body.v.x) + ", " + Short(body.v.y) + ") m/s, " + Short(body.omega) + " rad/s";
}

void AppendCenterOfMass(Vec2 p, double arm, std::string* out) {
  *out += "<path d=\"M" + Px(p - Vec2{arm, 0}) + "h" + Px(2 * arm) + "M" + Px(p - Vec2{0, arm}) + "v" + Px(2 * arm) +
          "\" stroke=\"#888888\" stroke-width=\"0.8\"/>";
}

/// A body that only joints and loads hold.
void AppendPointMass(Vec2 p, double radius, std::string* out) {
  *out += "<circle cx=\"" + Px(p.x) + "\" cy=\"" + Px(p.y) + "\" r=\"" + Px(radius) + "\" fill=\"" +
          std::string(kBodyFill) + "\" stroke=\"#888888\"/>";
  AppendCenterOfMass(p, radius, out);
}

/// Where a driven body is going: an open circle with an arrow head for its spin, a straight arrow for its travel.
void AppendDrive(const Picture& picture, const Body& body, std::string* out) {
  constexpr double kReach = 13;  // [px]
  constexpr double kWidth = 1.6;
  const Vec2 at = picture.layout.ToPage(body.x);
  const double spin = body.omega != 0 ? body.omega : body.alpha;
  const Vec2 travel = Norm(body.v) > 0 ? body.v : body.acceleration;
  const std::string color(kDrivenFill[1]);
  if (spin != 0) {
    const double sign = spin > 0 ? 1 : -1;
    const auto point = [&](double degrees) {
      const Rotation turn = SinCos(sign * degrees * kPi / 180);
      return at + kReach * Vec2{turn.cos, -turn.sin};
    };
    *out += "<path d=\"M" + Px(point(30)) + "A" + Px(kReach) + " " + Px(kReach) + " 0 1 " + (sign > 0 ? "0 " : "1 ") +
            Px(point(300)) + "\" fill=\"none\" stroke=\"" + color + "\" stroke-width=\"" + Px(kWidth) + "\"/>";
    AppendArrow(point(295), point(335), kWidth, kDrivenFill[1], out);
  }
  if (Norm(travel) > 0) {
    const Vec2 along = (1 / Norm(travel)) * Vec2{travel.x, -travel.y};
    AppendArrow(at - kReach * along, at + (1.6 * kReach) * along, kWidth, kDrivenFill[1], out);
  }
}

void AppendFill(const Picture& picture, const Body& body, const PageMap& map, std::string* out) {
  const Outline outline = OutlineOf(body);
  const std::string pattern = "url(#" + PatternId(picture, body) + ")";
  if (!body.fixed || IsBounded(outline)) {
    *out += "<path d=\"" + OutlinePath(outline, map) + "\" fill-rule=\"evenodd\" fill=\"" +
            (body.fixed ? pattern : std::string(kBodyFill)) + "\"/>";
    return;
  }
  for (const OutlineEdge& piece : body.outline) {
    *out += "<path d=\"" + BandPath(piece, map, picture.hatch) + "\" fill-rule=\"evenodd\" fill=\"" + pattern + "\"/>";
  }
}

void AppendBody(const Picture& picture, const Body& body, std::string* out) {
  const PageMap map = picture.layout.MapOf(body);
  *out += "<g><title>" + Escape(Tooltip(body)) + "</title>";
  if (!body.outline.empty()) AppendFill(picture, body, map, out);
  std::array<std::string, kEdgeStyles.size()> paths;
  for (const OutlineEdge& piece : body.outline) {
    paths[static_cast<std::size_t>(KindOf(piece.edge))] += PiecePath(piece, map, "M");
  }
  for (std::size_t kind = 0; kind < paths.size(); ++kind) {
    if (paths[kind].empty()) continue;
    *out += "<path d=\"" + paths[kind] + "\" fill=\"none\" stroke=\"" + std::string(kEdgeStyles[kind].color) +
            "\" stroke-width=\"" + Px(body.fixed ? std::max(picture.line, 1.2) : picture.line) + "\"/>";
  }
  if (!body.fixed && body.outline.empty()) {
    AppendPointMass(map.origin, std::max(2.0, picture.connector), out);
  } else if (!body.fixed && picture.layout.scale * BoundsOf(body).extent() > kSmallBody) {
    AppendCenterOfMass(map.origin, std::clamp(0.04 * picture.layout.body_size, 1.5, 4.0), out);
  }
  if (IsDriven(body)) AppendDrive(picture, body, out);
  *out += "</g>\n";
}

}  // namespace

bool IsDriven(const Body& body) {
  return body.fixed && (Norm(body.v) > 0 || body.omega != 0 || Norm(body.acceleration) > 0 || body.alpha != 0);
}

void AppendPatterns(const Picture& picture, std::string* out) {
  for (const bool driven : {false, true}) {
    const auto& colors = driven ? kDrivenFill : kFixedFill;
    *out += "<pattern id=\"" + picture.id + (driven ? "-driven" : "-fixed") +
            "\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(" +
            (driven ? "-45" : "45") + ")\"><rect width=\"6\" height=\"6\" fill=\"" + std::string(colors[0]) +
            "\"/><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"6\" stroke=\"" + std::string(colors[1]) +
            "\" stroke-width=\"1.6\"/></pattern>\n";
  }
}

void AppendBodies(const Picture& picture, std::string* out) {
  for (const bool fixed : {true, false}) {
    for (const Body& body : picture.system.bodies) {
      if (body.fixed == fixed) AppendBody(picture, body, out);
    }
  }
}

}  // namespace lcpbench
