#include <algorithm>
#include <cmath>
#include <optional>

#include "model/scenes/parts.h"
#include "model/scenes/picture_parts.h"
#include "model/scenes/svg_text.h"

namespace lcpbench {
namespace {

const Body& BodyOf(const Picture& picture, int index) { return picture.system.bodies[static_cast<std::size_t>(index)]; }

Vec2 PageOf(const Picture& picture, const Attachment& at) {
  return picture.layout.ToPage(ToWorld(BodyOf(picture, at.body), at.point));
}

/// The path that a path joint's vertex is kept on.
void AppendJointPath(const Picture& picture, const Constraint& joint, std::string* out) {
  for (const bool second : {false, true}) {
    const std::optional<OutlineEdge> path = WholeCurve(second ? joint.feature2 : joint.feature1);
    if (!path) continue;
    const Body& body = BodyOf(picture, second ? joint.body2 : joint.body1);
    *out += "<path d=\"" + PiecePath(*path, picture.layout.MapOf(body), "M") + "\" fill=\"none\" stroke=\"" +
            std::string(kSoftInkColor) + "\" stroke-width=\"" + Px(std::max(0.5, 0.7 * picture.line)) +
            "\" stroke-dasharray=\"6 3 1 3\"/>\n";
  }
}

void AppendJoint(const Picture& picture, const RowInfo& row, const Constraint& joint, std::string* out) {
  const Vec2 p1 = picture.layout.ToPage(row.p1);
  const Vec2 p2 = picture.layout.ToPage(row.p2);
  const double radius = std::max(1.2, 0.8 * picture.connector);
  switch (joint.type) {
    case ConstraintType::kContact:
      return;
    case ConstraintType::kPin:
      if (row.axis == 'x') *out += PinShape(0.5 * (p1 + p2), radius) + "\n";
      return;
    case ConstraintType::kPathJoint:
      *out += SliderShape(0.5 * (p1 + p2), {row.n.x, -row.n.y}, radius) + "\n";
      return;
    case ConstraintType::kRod:
      *out += RodShape(p1, p2, 0.6 * picture.connector) + "\n";
      return;
    case ConstraintType::kRope:
      *out += RopeShape(p1, p2, joint.length * picture.layout.scale, picture.connector) + "\n";
      return;
  }
}

bool SameEnds(const Spring& spring, const Damper& damper) {
  const auto same = [](const Attachment& a, const Attachment& b) {
    return a.body == b.body && a.point.x == b.point.x && a.point.y == b.point.y;
  };
  return (same(spring.end1, damper.end1) && same(spring.end2, damper.end2)) ||
         (same(spring.end1, damper.end2) && same(spring.end2, damper.end1));
}

/// Beside each other where they share both ends, as they often do.
void AppendSpringsAndDampers(const Picture& picture, std::string* out) {
  const auto aside = [&](Vec2 from, Vec2 to, double by) {
    const double length = Norm(to - from);
    return length > 0 ? (by * 1.3 * picture.connector / length) * Perp(to - from) : Vec2{};
  };
  const auto& [springs, dampers] = std::tie(picture.loads->springs, picture.loads->dampers);
  for (const Spring& spring : springs) {
    const bool shared =
        std::any_of(dampers.begin(), dampers.end(), [&](const Damper& damper) { return SameEnds(spring, damper); });
    const Vec2 from = PageOf(picture, spring.end1);
    const Vec2 to = PageOf(picture, spring.end2);
    const Vec2 shift = aside(from, to, shared ? 1 : 0);
    *out += SpringShape(from + shift, to + shift, picture.connector) + "\n";
  }
  for (const Damper& damper : dampers) {
    // The same side for a damper whose ends are named the other way round.
    double side = 0;
    for (const Spring& spring : springs) {
      if (SameEnds(spring, damper)) side = spring.end1.body == damper.end1.body ? -1 : 1;
    }
    const Vec2 from = PageOf(picture, damper.end1);
    const Vec2 to = PageOf(picture, damper.end2);
    const Vec2 shift = aside(from, to, side);
    *out += DamperShape(from + shift, to + shift, picture.connector) + "\n";
  }
}

std::string Stroke(double width, std::string_view color = kInkColor, std::string_view fill = "none") {
  return "\" fill=\"" + std::string(fill) + "\" stroke=\"" + std::string(color) + "\" stroke-width=\"" + Px(width) +
         "\"/>";
}

double StrokeOf(double half) { return std::clamp(0.3 * half, 0.5, 1.5); }

/// Across from-to, with the length of a pixel.
struct Axes {
  Vec2 along;
  Vec2 across;
  double length;
};
Axes AxesOf(Vec2 from, Vec2 to) {
  const double length = Norm(to - from);
  const Vec2 along = length > 0 ? (1 / length) * (to - from) : Vec2{1, 0};
  return {along, Perp(along), length};
}

}  // namespace

std::string SpringShape(Vec2 from, Vec2 to, double half) {
  const auto [along, across, length] = AxesOf(from, to);
  constexpr int kCoils = 6;
  // A sixth of the length on either side stays straight.
  std::string path = "<path d=\"M" + Px(from);
  for (int k = 0; k <= 2 * kCoils; ++k) {
    const double share = 1.0 / 6 + (2.0 / 3) * k / (2 * kCoils);
    const double side = k == 0 || k == 2 * kCoils ? 0 : (k % 2 == 0 ? -1 : 1);
    path += "L" + Px(from + (share * length) * along + (side * half) * across);
  }
  return path + "L" + Px(to) + Stroke(StrokeOf(half));
}

std::string DamperShape(Vec2 from, Vec2 to, double half) {
  const auto [along, across, length] = AxesOf(from, to);
  const Vec2 bottom = from + (0.35 * length) * along;
  const Vec2 piston = from + (0.52 * length) * along;
  const Vec2 rim = from + (0.65 * length) * along;
  const Vec2 side = half * across;
  return "<path d=\"M" + Px(from) + "L" + Px(bottom) + "M" + Px(rim + side) + "L" + Px(bottom + side) + "L" +
         Px(bottom - side) + "L" + Px(rim - side) + "M" + Px(piston + 0.7 * side) + "L" + Px(piston - 0.7 * side) +
         "M" + Px(piston) + "L" + Px(to) + Stroke(StrokeOf(half));
}

std::string RodShape(Vec2 from, Vec2 to, double half) {
  const std::string line = "<path d=\"M" + Px(from) + "L" + Px(to);
  return line + Stroke(2 * half) + line + Stroke(2 * half - std::min(1.6, half), "#FFFFFF") + PinShape(from, half) +
         PinShape(to, half);
}

std::string RopeShape(Vec2 from, Vec2 to, double length, double half) {
  const double span = Norm(to - from);
  // The sag of a shallow parabola of that length; slack on the screen only where it can be seen.
  const double slack = std::min(length - span, span);
  const double sag = slack > 1e-3 * span ? std::sqrt(0.375 * span * slack) : 0;
  const Vec2 control = 0.5 * (from + to) + Vec2{0, 2 * sag};
  const double dot = std::max(0.8, 0.35 * half);
  return "<path d=\"M" + Px(from) + "Q" + Px(control) + " " + Px(to) + Stroke(StrokeOf(half)) + "<circle cx=\"" +
         Px(from.x) + "\" cy=\"" + Px(from.y) + "\" r=\"" + Px(dot) + "\"/><circle cx=\"" + Px(to.x) + "\" cy=\"" +
         Px(to.y) + "\" r=\"" + Px(dot) + "\"/>";
}

std::string PinShape(Vec2 at, double radius) {
  return "<circle cx=\"" + Px(at.x) + "\" cy=\"" + Px(at.y) + "\" r=\"" + Px(radius) +
         Stroke(StrokeOf(radius), kInkColor, "#FFFFFF");
}

std::string SliderShape(Vec2 at, Vec2 normal, double radius) {
  const Vec2 n = (0.8 * radius) * normal;
  const Vec2 t = (1.4 * radius) * Perp(normal);
  return "<path d=\"M" + Px(at + n + t) + "L" + Px(at + n - t) + "L" + Px(at - n - t) + "L" + Px(at - n + t) + "Z" +
         Stroke(StrokeOf(radius), kInkColor, "#FFFFFF");
}

void AppendConnectors(const Picture& picture, std::string* out) {
  for (const Constraint& joint : picture.system.constraints) {
    if (joint.type == ConstraintType::kPathJoint) AppendJointPath(picture, joint, out);
  }
  if (picture.loads != nullptr) AppendSpringsAndDampers(picture, out);
  for (const RowInfo& row : picture.lcp.rows) {
    AppendJoint(picture, row, picture.system.constraints[static_cast<std::size_t>(row.constraint)], out);
  }
}

}  // namespace lcpbench
