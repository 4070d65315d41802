#include "benchmarks/drawing/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "benchmarks/drawing/picture_layout.h"
#include "benchmarks/drawing/svg_text.h"
#include "model/detection/detection.h"
#include "model/scenes/parts.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Bodies smaller than this show no centre of mass [px].
constexpr double kSmallBody = 24;

/// What a row is drawn as: grey disc where nothing is solved, filled disc, open diamond, open disc, the joint's symbol.
enum class RowKind { kPlain, kActive, kOpen, kDegenerate, kJoint };
inline constexpr std::array kRowKinds{RowKind::kPlain, RowKind::kActive, RowKind::kOpen, RowKind::kDegenerate,
                                      RowKind::kJoint};

/// Everything that the parts of a picture are drawn from. Sizes in pixels.
struct Picture {
  Picture(const ContactSystem& drawn, const AssembledLcp& assembled, const Eigen::VectorXd* forces,
          const Eigen::VectorXd* accelerations, const Loads* drawn_loads);

  const ContactSystem& system;
  const AssembledLcp& lcp;
  const Eigen::VectorXd* f;
  const Loads* loads;
  Layout layout;
  std::string id;  ///< prefix of all identifiers
  std::vector<RowKind> kinds;
  double line = 1;         ///< stroke width of edges
  double mark = 3;         ///< radius of a contact's mark
  double arrow = 1;        ///< stroke width of forces
  double hatch = 9;        ///< depth of the hatching of unbounded bodies
  double connector = 4;    ///< half width of springs, dampers and of rods' ends
  double arrow_scale = 0;  ///< [px/N]; 0 without forces

 private:
  void Classify(const Eigen::VectorXd* w);
};

/// Where springs and dampers are fastened, world frame.
std::vector<Vec2> EndsOf(const ContactSystem& system, const Loads* loads) {
  std::vector<Vec2> ends;
  const auto add = [&](const auto& connectors) {
    for (const auto& connector : connectors) {
      for (const Attachment& end : {connector.end1, connector.end2}) {
        ends.push_back(ToWorld(system.bodies[static_cast<std::size_t>(end.body)], end.point));
      }
    }
  };
  if (loads == nullptr) return ends;
  add(loads->springs);
  add(loads->dampers);
  return ends;
}

Picture::Picture(const ContactSystem& drawn, const AssembledLcp& assembled, const Eigen::VectorXd* forces,
                 const Eigen::VectorXd* accelerations, const Loads* drawn_loads)
    : system(drawn),
      lcp(assembled),
      f(forces),
      loads(drawn_loads),
      layout(MakeLayout(drawn, assembled, EndsOf(drawn, drawn_loads))),
      id(Identifier(drawn.name)) {
  Classify(accelerations);
  hatch = std::clamp(0.4 * layout.body_size, 4.0, 9.0);
  connector = std::clamp(0.09 * layout.body_size, 1.2, 6.0);
  // Neither small bodies nor crowded rows shall drown in marks.
  const double area =
      layout.width * layout.drawing_height() / static_cast<double>(std::max<std::size_t>(1, lcp.rows.size()));
  const double spacing = std::sqrt(area);
  const double crowd = layout.body_size > 0 ? std::min(layout.body_size, 1.5 * spacing) : 1.5 * spacing;
  mark = std::clamp(0.06 * crowd, 0.9, 4.5);
  line = std::clamp(0.045 * crowd, 0.4, 1.8);
  arrow = std::clamp(0.05 * crowd, 0.8, 2.2);
  if (f == nullptr) return;
  double largest = 0;
  for (Index i = 0; i < f->size(); ++i) {
    if (std::isfinite((*f)[i])) largest = std::max(largest, std::abs((*f)[i]));
  }
  if (largest > 0) arrow_scale = std::clamp(crowd, 8.0, 80.0) / largest;
}

void Picture::Classify(const Eigen::VectorXd* w) {
  const auto n = static_cast<Index>(lcp.rows.size());
  kinds.assign(lcp.rows.size(), RowKind::kPlain);
  const bool solved = f != nullptr && w != nullptr && n > 0;
  // In one unit, sqrt(A_ii) f and w / sqrt(A_ii), so that rows and the two sides compare.
  Eigen::VectorXd force(solved ? n : 0);
  Eigen::VectorXd motion(solved ? n : 0);
  for (Index i = 0; i < force.size(); ++i) {
    const double diagonal = lcp.problem.DiagonalA()[i];
    const double root = diagonal > 0 ? std::sqrt(diagonal) : 1;
    force[i] = root * (*f)[i];
    motion[i] = (*w)[i] / root;
  }
  constexpr double kZero = 1e-9;
  const double threshold = solved ? kZero * std::max(force.cwiseAbs().maxCoeff(), motion.cwiseAbs().maxCoeff()) : 0;
  for (Index i = 0; i < n; ++i) {
    RowKind& kind = kinds[static_cast<std::size_t>(i)];
    if (lcp.rows[static_cast<std::size_t>(i)].bilateral) {
      kind = RowKind::kJoint;
    } else if (solved) {
      kind = std::max(force[i], motion[i]) <= threshold ? RowKind::kDegenerate
             : force[i] > motion[i]                     ? RowKind::kActive
                                                        : RowKind::kOpen;
    }
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

void AppendArrow(Vec2 from, Vec2 to, double width, std::string_view color, std::string* out) {
  const Vec2 along = to - from;
  const double length = Norm(along);
  if (!(length > 0)) return;
  const Vec2 unit = (1 / length) * along;
  const double head = std::min(4 * width, 0.6 * length);
  const Vec2 neck = to - head * unit;
  const Vec2 side = (0.45 * head) * Perp(unit);
  *out += "<path d=\"M" + Px(from) + "L" + Px(neck) + "\" stroke=\"" + std::string(color) + "\" stroke-width=\"" +
          Px(width) + "\" stroke-linecap=\"butt\"/><path d=\"M" + Px(to) + "L" + Px(neck + side) + "L" +
          Px(neck - side) + "Z\" fill=\"" + std::string(color) + "\"/>\n";
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

std::string MarkShape(RowKind kind, double radius) {
  const std::string stroke = "\" stroke-width=\"" + Px(std::max(0.5, 0.3 * radius)) + "\"/>";
  const std::string disc = "<circle r=\"" + Px(radius) + "\" fill=\"";
  switch (kind) {
    case RowKind::kPlain:
      return disc + "#777777\"/>";
    case RowKind::kActive:
      return disc + std::string(kForceColor) + "\"/>";
    case RowKind::kDegenerate:
      return disc + "#FFFFFF\" stroke=\"" + std::string(kForceColor) + stroke;
    case RowKind::kOpen: {
      const std::string h = Px(1.35 * radius);
      return "<path d=\"M0 -" + h + "L" + h + " 0L0 " + h + "L-" + h + " 0Z\" fill=\"#FFFFFF\" stroke=\"" +
             std::string(kInkColor) + stroke;
    }
    case RowKind::kJoint:
      break;
  }
  return {};
}

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

void AppendConnectors(const Picture& picture, std::string* out) {
  for (const Constraint& joint : picture.system.constraints) {
    if (joint.type == ConstraintType::kPathJoint) AppendJointPath(picture, joint, out);
  }
  if (picture.loads != nullptr) AppendSpringsAndDampers(picture, out);
  for (const RowInfo& row : picture.lcp.rows) {
    AppendJoint(picture, row, picture.system.constraints[static_cast<std::size_t>(row.constraint)], out);
  }
}

/// One force on the page; the two rows of a pin give one.
struct Force {
  Vec2 from;
  Vec2 to;
  double newtons = 0;
};

bool IsContact(const Picture& picture, const RowInfo& row) {
  return picture.system.constraints[static_cast<std::size_t>(row.constraint)].type == ConstraintType::kContact;
}

/// Whether the force on body 2 is shown: of a fixed body it would say nothing.
bool OnBody2(const Picture& picture, const RowInfo& row) {
  const Constraint& constraint = picture.system.constraints[static_cast<std::size_t>(row.constraint)];
  return picture.system.bodies[static_cast<std::size_t>(constraint.body1)].fixed;
}

/// Where the row's force acts on the body it is shown on.
Vec2 PointOf(const Picture& picture, const RowInfo& row) {
  const ConstraintType type = picture.system.constraints[static_cast<std::size_t>(row.constraint)].type;
  const bool distant = type == ConstraintType::kRod || type == ConstraintType::kRope;
  return picture.layout.ToPage(distant ? (OnBody2(picture, row) ? row.p2 : row.p1) : 0.5 * (row.p1 + row.p2));
}

std::vector<Force> CollectForces(const Picture& picture) {
  std::vector<Force> forces;
  if (picture.arrow_scale == 0) return forces;
  const auto& rows = picture.lcp.rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Vec2 total = (*picture.f)[static_cast<Index>(i)] * rows[i].n;
    if (rows[i].axis == 'x' && i + 1 < rows.size() && rows[i + 1].axis == 'y') {
      total = total + (*picture.f)[static_cast<Index>(i + 1)] * rows[i + 1].n;
      ++i;
    }
    if (OnBody2(picture, rows[i])) total = -total;
    const Vec2 length = picture.arrow_scale * Vec2{total.x, -total.y};
    constexpr double kVisible = 0.5;  // [px]
    if (!IsFinite(length) || Norm(length) < kVisible) continue;
    const Vec2 from = PointOf(picture, rows[i]);
    forces.push_back({from, from + length, Norm(total)});
  }
  return forces;
}

void AppendNormal(const Picture& picture, const RowInfo& row, std::string* out) {
  const Vec2 p = PointOf(picture, row);
  const Vec2 half = (2.2 * picture.mark) * Vec2{row.n.x, -row.n.y};
  *out += "<path d=\"M" + Px(p - half) + "L" + Px(p + half) + "\" stroke=\"" + std::string(kInkColor) +
          "\" stroke-width=\"" + Px(std::max(0.4, 0.6 * picture.line)) + "\"/>\n";
}

std::string MarkId(const Picture& picture, RowKind kind) {
  return picture.id + "-mark" + std::to_string(static_cast<int>(kind));
}

/// An axis-parallel box on the page, for keeping labels apart.
struct Box {
  Vec2 low;
  Vec2 high;
  bool Meets(const Box& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
  }
};

/// Values beside the arrows' heads, each where it meets nothing else; left out where there is no such place.
class ForceLabels {
 public:
  ForceLabels(const Picture& picture, const std::vector<Force>& forces) {
    page_ = {{0, 0}, {picture.layout.width * picture.layout.strips, picture.layout.height}};
    for (const Force& force : forces) {
      // A slanted arrow as a chain of boxes; the box of the whole would shut out half the picture.
      constexpr int kPieces = 8;
      for (int k = 0; k <= kPieces; ++k) {
        const Vec2 p = force.from + (static_cast<double>(k) / kPieces) * (force.to - force.from);
        taken_.push_back({p - Vec2{3, 3}, p + Vec2{3, 3}});
      }
    }
    for (const RowInfo& row : picture.lcp.rows) {
      const Vec2 p = PointOf(picture, row);
      const Vec2 reach{1.5 * picture.mark, 1.5 * picture.mark};
      taken_.push_back({p - reach, p + reach});
    }
  }

  void Append(const Force& force, std::string* out) {
    constexpr double kHeight = 12;
    constexpr double kCharacter = 6.2;
    const std::string text = Short(force.newtons) + " N";
    const Vec2 half{kCharacter * static_cast<double>(text.size()) / 2 + 1, kHeight / 2};
    const Vec2 along = (1 / Norm(force.to - force.from)) * (force.to - force.from);
    const double beyond = std::abs(along.x) * half.x + std::abs(along.y) * half.y + 4;
    const double beside = std::abs(along.y) * half.x + std::abs(along.x) * half.y + 6;
    for (const Vec2 offset : {beyond * along, beside * Perp(along), -beside * Perp(along)}) {
      const Vec2 at = force.to + offset;
      const Box box{at - half, at + half};
      const bool inside = box.low.x >= page_.low.x && box.low.y >= page_.low.y && box.high.x <= page_.high.x &&
                          box.high.y <= page_.high.y;
      if (!inside || std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.Meets(other); })) {
        continue;
      }
      taken_.push_back(box);
      *out += "<text x=\"" + Px(at.x) + "\" y=\"" + Px(at.y + 4) +
              "\" text-anchor=\"middle\" font-size=\"11\" fill=\"#9A4300\" stroke=\"#FFFFFF\" stroke-width=\"2.5\" "
              "paint-order=\"stroke\">" +
              text + "</text>\n";
      return;
    }
  }

 private:
  Box page_;
  std::vector<Box> taken_;
};

void AppendMarks(const Picture& picture, std::string* out) {
  // Once each: a scene may have thousands of rows.
  for (const RowKind kind : kRowKinds) {
    if (kind == RowKind::kJoint) continue;
    *out += "<g id=\"" + MarkId(picture, kind) + "\">" + MarkShape(kind, picture.mark) + "</g>\n";
  }
}

void AppendRows(const Picture& picture, std::string* out) {
  const auto& rows = picture.lcp.rows;
  for (const RowInfo& row : rows) {
    if (IsContact(picture, row)) AppendNormal(picture, row, out);
  }
  std::vector<Force> forces = CollectForces(picture);
  for (const Force& force : forces) AppendArrow(force.from, force.to, picture.arrow, kForceColor, out);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!IsContact(picture, rows[i])) continue;
    const Vec2 p = PointOf(picture, rows[i]);
    *out += "<use href=\"#" + MarkId(picture, picture.kinds[i]) + "\" x=\"" + Px(p.x) + "\" y=\"" + Px(p.y) + "\"/>\n";
  }
  // The largest first: they say most.
  constexpr std::size_t kMaxLabels = 40;
  constexpr double kSmallestLabelled = 30;  // body size [px]
  const bool readable = picture.layout.body_size == 0 || picture.layout.body_size >= kSmallestLabelled;
  if (forces.size() > kMaxLabels || !readable) return;
  ForceLabels labels(picture, forces);
  std::stable_sort(forces.begin(), forces.end(), [](const Force& a, const Force& b) { return a.newtons > b.newtons; });
  for (const Force& force : forces) labels.Append(force, out);
}

// All in pixels.
constexpr double kLine = 24;
constexpr double kArrow = 70;
constexpr double kBar = 90;
constexpr double kCharacterWidth = 6.6;

/// Draws a symbol whose left end, at half height, is at the given point.
using DrawSymbol = std::function<std::string(Vec2)>;

/// Places items from left to right, in as many lines as they need.
class Flow {
 public:
  Flow(double top, std::string* out) : y_(top + kLine / 2), out_(out) {}

  void Add(double symbol_width, const std::string& text, const DrawSymbol& draw) {
    const double width = symbol_width + 8 + kCharacterWidth * static_cast<double>(text.size());
    if (x_ > kPagePadding && x_ + width > kPageWidth - kPagePadding) {
      x_ = kPagePadding;
      y_ += kLine;
    }
    *out_ += draw({x_, y_}) + "<text x=\"" + Px(x_ + symbol_width + 7) + "\" y=\"" + Px(y_ + 4.5) +
             "\" font-size=\"13\" fill=\"" + std::string(kInkColor) + "\">" + Escape(text) + "</text>\n";
    x_ += width + 20;
  }

  double bottom() const { return y_ + kLine / 2; }

 private:
  double x_ = kPagePadding;
  double y_;
  std::string* out_;
};

std::string Counted(const char* name, std::size_t count) {
  return std::string(name) + " (" + std::to_string(count) + ")";
}

void AddEdges(const Picture& picture, Flow* flow) {
  std::array<bool, kEdgeStyles.size()> shown{};
  for (const Body& body : picture.system.bodies) {
    for (const OutlineEdge& piece : body.outline) shown[static_cast<std::size_t>(KindOf(piece.edge))] = true;
  }
  for (std::size_t kind = 0; kind < shown.size(); ++kind) {
    if (!shown[kind]) continue;
    flow->Add(24, std::string(kEdgeStyles[kind].name), [&](Vec2 p) {
      return "<path d=\"M" + Px(p) + "h24\" stroke=\"" + std::string(kEdgeStyles[kind].color) +
             "\" stroke-width=\"2.4\"/>";
    });
  }
}

void AddBodies(const Picture& picture, Flow* flow) {
  for (const bool driven : {false, true}) {
    const auto count = std::count_if(picture.system.bodies.begin(), picture.system.bodies.end(), [&](const Body& body) {
      return body.fixed && !body.outline.empty() && IsDriven(body) == driven;
    });
    if (count == 0) continue;
    flow->Add(24, driven ? "driven" : "fixed", [&](Vec2 p) {
      return "<rect x=\"" + Px(p.x) + "\" y=\"" + Px(p.y - 6) + "\" width=\"24\" height=\"12\" fill=\"url(#" +
             picture.id + (driven ? "-driven" : "-fixed") + ")\"/>";
    });
  }
}

void AddContacts(const Picture& picture, Flow* flow) {
  static constexpr std::array<const char*, 4> kNames{"contact and normal", "active, f > 0", "separating, w > 0",
                                                     "f = w = 0"};
  std::array<std::size_t, kRowKinds.size()> counts{};
  for (std::size_t i = 0; i < picture.lcp.rows.size(); ++i) {
    const auto constraint = static_cast<std::size_t>(picture.lcp.rows[i].constraint);
    if (picture.system.constraints[constraint].type == ConstraintType::kContact) {
      ++counts[static_cast<std::size_t>(picture.kinds[i])];
    }
  }
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    if (counts[kind] == 0) continue;
    flow->Add(12, Counted(kNames[kind], counts[kind]), [&](Vec2 p) {
      return "<g transform=\"translate(" + Px(p + Vec2{6, 0}) + ")\"><path d=\"M0 -9v18\" stroke=\"" +
             std::string(kInkColor) + "\" stroke-width=\"1\"/>" + MarkShape(static_cast<RowKind>(kind), 4.2) + "</g>";
    });
  }
}

void AddConnectors(const Picture& picture, Flow* flow) {
  constexpr double kLength = 34;
  constexpr double kHalf = 4;
  const auto count = [&](ConstraintType type) {
    return static_cast<std::size_t>(std::count_if(picture.system.constraints.begin(), picture.system.constraints.end(),
                                                  [&](const Constraint& joint) { return joint.type == type; }));
  };
  const auto add = [&](double width, const char* name, std::size_t number, const DrawSymbol& draw) {
    if (number > 0) flow->Add(width, Counted(name, number), draw);
  };
  const Vec2 across{kLength, 0};
  add(10, "pin", count(ConstraintType::kPin), [&](Vec2 p) { return PinShape(p + Vec2{5, 0}, 4); });
  add(16, "path joint", count(ConstraintType::kPathJoint), [&](Vec2 p) {
    return SliderShape(p + Vec2{8, 0}, {0, 1}, 5);
  });
  add(kLength, "rod", count(ConstraintType::kRod), [&](Vec2 p) { return RodShape(p, p + across, 2.4); });
  add(kLength, "rope", count(ConstraintType::kRope), [&](Vec2 p) {
    return RopeShape(p - Vec2{0, 3}, p + across - Vec2{0, 3}, 1.08 * kLength, kHalf);
  });
  if (picture.loads == nullptr) return;
  add(kLength, "spring", picture.loads->springs.size(), [&](Vec2 p) { return SpringShape(p, p + across, kHalf); });
  add(kLength, "damper", picture.loads->dampers.size(), [&](Vec2 p) { return DamperShape(p, p + across, kHalf); });
}

void AddScales(const Picture& picture, Flow* flow) {
  if (picture.arrow_scale > 0) {
    const double force = RoundDown(kArrow / picture.arrow_scale);
    const double length = force * picture.arrow_scale;
    flow->Add(length, Short(force) + " N", [&](Vec2 p) {
      std::string symbol;
      AppendArrow(p, p + Vec2{length, 0}, picture.arrow, kForceColor, &symbol);
      return symbol;
    });
  }
  if (picture.loads != nullptr && Norm(picture.loads->gravity) > 0) {
    const Vec2 g = picture.loads->gravity;
    const Vec2 half = (9 / Norm(g)) * Vec2{g.x, -g.y};
    flow->Add(18, "gravity " + Short(Norm(g)) + " m/s\u00B2", [&](Vec2 p) {
      std::string symbol;
      AppendArrow(p + Vec2{9, 0} - half, p + Vec2{9, 0} + half, 1.4, kInkColor, &symbol);
      return symbol;
    });
  }
  const double distance = RoundDown(kBar / picture.layout.scale);
  const double bar = distance * picture.layout.scale;
  flow->Add(bar, Short(distance) + " m", [&](Vec2 p) {
    return "<path d=\"M" + Px(p) + "m0 -4v8m0 -4h" + Px(bar) + "m0 -4v8\" stroke=\"" + std::string(kInkColor) +
           "\" stroke-width=\"1.4\" fill=\"none\"/>";
  });
}

double AppendLegend(const Picture& picture, double top, std::string* out) {
  Flow flow(top, out);
  AddEdges(picture, &flow);
  AddBodies(picture, &flow);
  AddContacts(picture, &flow);
  AddConnectors(picture, &flow);
  AddScales(picture, &flow);
  return flow.bottom() - top;
}

constexpr double kTitleHeight = 40;  // [px]

std::string Count(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

void AppendTitle(const Picture& picture, const std::string& caption, std::string* out) {
  const auto movable = std::count_if(picture.system.bodies.begin(), picture.system.bodies.end(),
                                     [](const Body& body) { return !body.fixed; });
  std::string text = Count(static_cast<std::size_t>(movable), "movable body", "movable bodies") + ", " +
                     Count(picture.lcp.rows.size(), "row", "rows");
  if (!caption.empty()) text += ", " + caption;
  *out += "<text x=\"" + Px(kPagePadding) + "\" y=\"26\" font-size=\"16\" font-weight=\"bold\" fill=\"" +
          std::string(kInkColor) + "\">" + Escape(picture.system.name) +
          "<tspan font-weight=\"normal\" font-size=\"13\" dx=\"14\" fill=\"#555555\">" + Escape(text) +
          "</tspan></text>\n";
}

/// The scene once, as a definition that every strip is a window on.
void AppendScene(const Picture& picture, std::string* out) {
  *out += "<defs>\n";
  AppendPatterns(picture, out);
  AppendMarks(picture, out);
  *out += "<g id=\"" + picture.id + "-scene\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n";
  AppendBodies(picture, out);
  AppendConnectors(picture, out);
  AppendRows(picture, out);
  *out += "</g>\n</defs>\n";
}

std::string Render(const Picture& picture, const std::string& caption) {
  const Layout& layout = picture.layout;
  std::string legend;
  const double legend_top = kTitleHeight + layout.drawing_height() + 14;
  const double page_height = legend_top + AppendLegend(picture, legend_top, &legend) + kPagePadding;

  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Px(kPageWidth) + " " +
                    Px(page_height) + "\" width=\"" + Px(kPageWidth) + "\" height=\"" + Px(page_height) +
                    "\" font-family=\"Helvetica, Arial, sans-serif\">\n";
  out += "<title>" + Escape(picture.system.name) + "</title>\n";
  AppendScene(picture, &out);
  out += "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n";
  AppendTitle(picture, caption, &out);
  for (int strip = 0; strip < layout.strips; ++strip) {
    const double x = (kPageWidth - layout.width) / 2;
    const double y = kTitleHeight + strip * (layout.height + kStripGap);
    out += "<svg x=\"" + Px(x) + "\" y=\"" + Px(y) + "\" width=\"" + Px(layout.width) + "\" height=\"" +
           Px(layout.height) + "\" viewBox=\"" + Px(strip * layout.width) + " 0 " + Px(layout.width) + " " +
           Px(layout.height) + "\" overflow=\"hidden\"><use href=\"#" + picture.id + "-scene\"/></svg>\n";
  }
  return out + legend + "</svg>\n";
}

}  // namespace

std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w, const PictureExtras& extras) {
  const auto rows = static_cast<Index>(lcp.rows.size());
  for (const Eigen::VectorXd* values : {f, w}) {
    if (values != nullptr && values->size() != rows) {
      throw InputError("picture of " + system.name + ": expected " + std::to_string(rows) + " values, found " +
                       std::to_string(values->size()));
    }
  }
  return Render(Picture(system, lcp, f, w, extras.loads), extras.caption);
}

}  // namespace lcpbench
