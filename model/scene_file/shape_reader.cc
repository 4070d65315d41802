#include "model/scene_file/shape_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "model/scene_file/fields.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
// How far a stated point may be from a stated curve, relative to the curve's size: as outlines may be open.
constexpr double kOnCurve = 1e-9;

// Material lies on the left: inside a curve that turns left.
Side ReadTurn(const JsonField& object) {
  return object["turns"].Choice<Side>({{"left", Side::kConvex}, {"right", Side::kConcave}});
}

// From one angle to the other in the sense that the curve turns; from an angle to itself, all the way round.
template <class Curve>
OutlinePiece Swept(const Curve& curve, double s_begin, double s_end) {
  if (curve.side == Side::kConvex && !(s_end > s_begin)) s_end += kFullTurn;
  if (curve.side == Side::kConcave && !(s_end < s_begin)) s_end -= kFullTurn;
  return {curve, s_begin, s_end};
}

Vec2 Begin(const JsonField& edge, std::optional<Vec2> begin) {
  if (!begin)
    edge.Fail("expected a point to begin at: a path's start, or a form of the edge that states its own begin");
  return *begin;
}

// The centre of the circle of that radius through p and q, seen from an arc that turns and is the long one or not.
Vec2 CenterThrough(const JsonField& edge, Vec2 p, Vec2 q, double radius, Side side, bool is_long) {
  const Vec2 half = 0.5 * (q - p);
  const double length = Norm(half);
  if (!(length > 0)) edge.Fail("zero-length edge: it ends where it begins, " + Text(p));
  const double square = (radius - length) * (radius + length);
  // A half circle: its ends may be further apart than its diameter by rounding.
  if (square < -kOnCurve * radius * radius) {
    edge.Fail("the curve is too small to reach from " + Text(p) + " to " + Text(q));
  }
  const double height = std::sqrt(std::max(square, 0.0));
  const bool center_on_left = (side == Side::kConvex) != is_long;
  return p + half + ((center_on_left ? height : -height) / length) * Perp(half);
}

bool ReadLong(const JsonField& edge) { return edge.Has("long") && edge["long"].Boolean(); }

DrawnEdge Whole(const OutlinePiece& piece) { return {piece, CurvePoint(piece.edge, piece.s_end)}; }

// A form that states the whole curve, but for its side: from s_begin to s_end, or all of it in the sense of "turns".
template <class Curve>
DrawnEdge ReadRange(const JsonField& edge, Curve curve) {
  if (!edge.Has("s_begin") && !edge.Has("s_end")) {
    curve.side = ReadTurn(edge);
    return Whole(curve.side == Side::kConvex ? OutlinePiece{curve, 0, kFullTurn} : OutlinePiece{curve, kFullTurn, 0});
  }
  const double begin = ReadNumber(edge["s_begin"]);
  const double end = ReadNumber(edge["s_end"]);
  curve.side = begin < end ? Side::kConvex : Side::kConcave;
  if (edge.Has("turns") && ReadTurn(edge) != curve.side) {
    edge["turns"].Fail("a curve turns left where s_begin < s_end, and right where s_begin > s_end");
  }
  return Whole({curve, begin, end});
}

DrawnEdge ReadLine(const JsonField& line, std::optional<Vec2> begin) {
  line.RequireOnlyKeys({"from", "to", "s_begin", "s_end"});
  const Vec2 a = line.Has("from") ? ReadVector(line["from"]) : Begin(line, begin);
  const Vec2 b = ReadVector(line["to"]);
  return Whole({StraightEdge{a, b}, ReadNumber(line, "s_begin", 0), ReadNumber(line, "s_end", 1)});
}

DrawnEdge ArcAbout(Vec2 center, double radius, Vec2 p, Vec2 q, Side side) {
  return {Swept(ArcEdge{center, radius, side}, AngleOf(p - center), AngleOf(q - center)), q};
}

DrawnEdge ReadBulgingArc(const JsonField& arc, Vec2 p) {
  arc.RequireOnlyKeys({"to", "bulge"});
  const Vec2 q = ReadVector(arc["to"]);
  const double bulge = ReadNumber(arc["bulge"]);
  constexpr double kStrongest = 1e6;
  if (!(std::abs(bulge) <= kStrongest) || bulge == 0) {
    arc["bulge"].Mismatch("a number other than 0 within -1e6..1e6, tan(sweep / 4)");
  }
  const Vec2 half = 0.5 * (q - p);
  const double length = Norm(half);
  if (!(length > 0)) arc.Fail("zero-length edge: it ends where it begins, " + Text(p));
  // With t = tan(sweep / 4), tan(sweep / 2) = 2 t / (1 - t^2) and sin(sweep / 2) = 2 t / (1 + t^2).
  const Vec2 center = p + half + ((1 - bulge) * (1 + bulge) / (2 * bulge)) * Perp(half);
  const double radius = length * (1 + bulge * bulge) / (2 * std::abs(bulge));
  return ArcAbout(center, radius, p, q, bulge > 0 ? Side::kConvex : Side::kConcave);
}

// Reads the forms that begin where the edge before ends.
DrawnEdge ReadArcFrom(const JsonField& arc, Vec2 p) {
  if (arc.Has("bulge")) return ReadBulgingArc(arc, p);
  if (arc.Has("sweep")) {
    arc.RequireOnlyKeys({"center", "sweep"});
    const Vec2 center = ReadVector(arc["center"]);
    const double sweep = ReadNumber(arc["sweep"]);
    const double s_begin = AngleOf(p - center);
    const ArcEdge edge{center, Norm(p - center), sweep < 0 ? Side::kConcave : Side::kConvex};
    return Whole({edge, s_begin, s_begin + sweep});
  }
  const Vec2 q = ReadVector(arc["to"]);
  if (arc.Has("center")) {
    arc.RequireOnlyKeys({"to", "center", "turns"});
    const Vec2 center = ReadVector(arc["center"]);
    const double radius = Norm(p - center);
    const double other = Norm(q - center);
    if (!(std::abs(radius - other) <= kOnCurve * std::max(radius, other))) {
      arc.Fail("begin and end are not equally far from the center, but " + Text(radius) + " and " + Text(other));
    }
    return ArcAbout(center, radius, p, q, ReadTurn(arc));
  }
  arc.RequireOnlyKeys({"to", "radius", "turns", "long"});
  const double radius = ReadNumber(arc["radius"], kPositive);
  const Side side = ReadTurn(arc);
  return ArcAbout(CenterThrough(arc, p, q, radius, side, ReadLong(arc)), radius, p, q, side);
}

DrawnEdge ReadArc(const JsonField& arc, std::optional<Vec2> begin) {
  arc.RequireOnlyKeys({"to", "bulge", "radius", "turns", "long", "center", "sweep", "s_begin", "s_end"});
  if (arc.Has("bulge") || arc.Has("sweep") || arc.Has("to")) return ReadArcFrom(arc, Begin(arc, begin));
  arc.RequireOnlyKeys({"center", "radius", "s_begin", "s_end", "turns"});
  const Vec2 center = ReadVector(arc["center"]);
  return ReadRange(arc, ArcEdge{center, ReadNumber(arc["radius"], kPositive), Side::kConvex});
}

Vec2 Scaled(const EllipseEdge& e, Vec2 in_axes) { return {in_axes.x / e.a, in_axes.y / e.b}; }

// How many times as large the oval through a point is, given in the frame of its axes.
double SizeAt(const EllipseEdge& e, Vec2 q) { return Norm(Scaled(e, q)); }
double SizeAt(const SuperellipseEdge& e, Vec2 q) {
  const double c = std::abs(q.x) / e.a;
  const double d = std::abs(q.y) / e.b;
  const double large = std::max(c, d);
  return large > 0 ? large * RootOfOnePlusPower(std::min(c, d) / large, e.m) : 0;
}

// The parameter of a point that lies on the curve.
template <class Oval>
double ParameterAt(const Oval& oval, Vec2 p, const JsonField& edge) {
  const double size = SizeAt(oval, oval.Shape().InAxes(p));
  if (!(std::abs(size - 1) <= kOnCurve)) {
    edge.Fail("the point " + Text(p) + " is not on the " + oval.kName + ", but on one " + Text(size) +
              " times as large");
  }
  return oval.AngleAt(p);
}

// What ellipse and superellipse share: all of the curve stated, with a range of parameters or the points it joins.
template <class Oval>
DrawnEdge ReadStatedOval(const JsonField& edge, Oval oval, std::optional<Vec2> begin) {
  oval.center = ReadVector(edge["center"]);
  if (!edge.Has("to")) return ReadRange(edge, oval);
  const Vec2 p = Begin(edge, begin);
  const Vec2 q = ReadVector(edge["to"]);
  oval.side = ReadTurn(edge);
  return {Swept(oval, ParameterAt(oval, p, edge), ParameterAt(oval, q, edge)), q};
}

DrawnEdge ReadEllipse(const JsonField& edge, std::optional<Vec2> begin) {
  EllipseEdge e;
  e.a = ReadNumber(edge["a"], kPositive);
  e.b = ReadNumber(edge["b"], kPositive);
  e.phi = ReadNumber(edge, "phi", 0);
  if (edge.Has("center")) {
    edge.RequireOnlyKeys({"center", "a", "b", "phi", "to", "turns", "s_begin", "s_end"});
    return ReadStatedOval(edge, e, begin);
  }
  edge.RequireOnlyKeys({"to", "a", "b", "phi", "turns", "long"});
  const Vec2 p = Begin(edge, begin);
  const Vec2 q = ReadVector(edge["to"]);
  e.side = ReadTurn(edge);
  // On the unit circle that the ellipse is the image of.
  const Vec2 u = Scaled(e, e.Shape().InAxes(p));
  const Vec2 v = Scaled(e, e.Shape().InAxes(q));
  const Vec2 middle = CenterThrough(edge, u, v, 1, e.side, ReadLong(edge));
  e.center = Rotate(SinCos(e.phi), {e.a * middle.x, e.b * middle.y});
  return {Swept(e, AngleOf(u - middle), AngleOf(v - middle)), q};
}

DrawnEdge ReadSuperellipse(const JsonField& edge, std::optional<Vec2> begin) {
  edge.RequireOnlyKeys({"center", "a", "b", "m", "phi", "to", "turns", "s_begin", "s_end"});
  SuperellipseEdge e;
  e.a = ReadNumber(edge["a"], kPositive);
  e.b = ReadNumber(edge["b"], kPositive);
  e.m = edge["m"].Integer();
  if (e.m < 2 || e.m % 2 != 0 || e.m > kMaxSuperellipseExponent) {
    edge["m"].Mismatch("an even integer in 2.." + std::to_string(kMaxSuperellipseExponent));
  }
  e.phi = ReadNumber(edge, "phi", 0);
  return ReadStatedOval(edge, e, begin);
}

DrawnEdge ReadBezier(const JsonField& edge, std::optional<Vec2> begin) {
  edge.RequireOnlyKeys({"control1", "control2", "to", "points", "s_begin", "s_end"});
  BezierEdge bezier;
  if (!edge.Has("points")) {
    edge.RequireOnlyKeys({"control1", "control2", "to"});
    bezier.P = {Begin(edge, begin), ReadVector(edge["control1"]), ReadVector(edge["control2"]), ReadVector(edge["to"])};
    return {{bezier, 0, 1}, bezier.P[3]};
  }
  edge.RequireOnlyKeys({"points", "s_begin", "s_end"});
  const std::vector<JsonField> points = edge["points"].Items(bezier.P.size());
  for (std::size_t k = 0; k < points.size(); ++k) bezier.P[k] = ReadVector(points[k]);
  return Whole({bezier, ReadNumber(edge, "s_begin", 0), ReadNumber(edge, "s_end", 1)});
}

}  // namespace

DrawnEdge ReadEdge(const JsonField& edge, std::optional<Vec2> begin) {
  const std::string kind = OnlyKey(edge, {"line", "arc", "ellipse", "superellipse", "bezier"});
  const JsonField form = edge[kind.c_str()];
  const DrawnEdge drawn = [&] {
    if (kind == "line") return ReadLine(form, begin);
    if (kind == "arc") return ReadArc(form, begin);
    if (kind == "ellipse") return ReadEllipse(form, begin);
    if (kind == "superellipse") return ReadSuperellipse(form, begin);
    return ReadBezier(form, begin);
  }();
  AtField(form, [&] { RequireValidPiece(drawn.piece, "edge"); });
  return drawn;
}

namespace {

// Edges join if the gap is below this, relative to the lengths they are computed from: as in OutlineOf (detection.h).
constexpr double kJoined = 1e-9;
// More would be circles for all purposes, and a short file should not ask for much memory.
constexpr int kMostTeeth = 1000;

struct DrawnPath {
  OutlineLoop edges;
  Vec2 begin;
  Vec2 end;
};

DrawnPath ReadDrawnPath(const JsonField& field) {
  DrawnPath path;
  std::optional<Vec2> pen;
  for (const JsonField& item : field.Items()) {
    if (item.IsArray()) {
      const Vec2 point = ReadVector(item);
      if (pen) {
        const OutlinePiece piece{StraightEdge{*pen, point}, 0, 1};
        AtField(item, [&] { RequireValidPiece(piece, "edge"); });
        path.edges.push_back(piece);
      } else {
        path.begin = point;
      }
      pen = point;
      continue;
    }
    const DrawnEdge edge = ReadEdge(item, pen);
    const Vec2 begin = CurvePoint(edge.piece.edge, edge.piece.s_begin);
    if (!pen) path.begin = begin;
    if (pen && !(Norm(begin - *pen) <= kJoined * Reach(edge.piece))) {
      item.Fail("the edge begins at " + Text(begin) + ", but what comes before it ends at " + Text(*pen));
    }
    path.edges.push_back(edge.piece);
    pen = edge.end;
  }
  if (path.edges.empty()) field.Fail("expected a path: a point to begin at and at least one edge");
  path.end = *pen;
  return path;
}

OutlineLoop ReadClosedPath(const JsonField& field) {
  DrawnPath path = ReadDrawnPath(field);
  double reach = 0;
  for (const OutlinePiece& piece : path.edges) reach = std::max(reach, Reach(piece));
  if (!(Norm(path.end - path.begin) <= kJoined * reach)) {
    field.Fail("open outline: it ends at " + Text(path.end) + ", but begins at " + Text(path.begin) +
               " (curves that stay open are \"chains\", for fixed bodies)");
  }
  return std::move(path.edges);
}

Outline ReadGear(const JsonField& field) {
  field.RequireOnlyKeys({"teeth", "root_radius", "tip_radius", "tip_share", "foot_share", "flank_radius"});
  GearShape gear;
  if (field.Has("teeth")) gear.teeth = field["teeth"].Integer();
  if (gear.teeth < 3 || gear.teeth > kMostTeeth) {
    field["teeth"].Mismatch("an integer in 3.." + std::to_string(kMostTeeth));
  }
  gear.root_radius = ReadNumber(field, "root_radius", gear.root_radius, kPositive);
  gear.tip_radius = ReadNumber(field, "tip_radius", gear.tip_radius, kPositive);
  gear.tip_share = ReadNumber(field, "tip_share", gear.tip_share, kPositive);
  gear.foot_share = ReadNumber(field, "foot_share", gear.foot_share, kPositive);
  gear.flank_radius = ReadNumber(field, "flank_radius", gear.flank_radius, kPositive);
  return AtField(field, [&] { return Gear(gear); });
}

Outline ReadSuperellipseShape(const JsonField& field) {
  field.RequireOnlyKeys({"a", "b", "m"});
  const double a = ReadNumber(field["a"], kPositive);
  const double b = ReadNumber(field["b"], kPositive);
  const int m = field["m"].Integer();
  return AtField(field, [&] { return Superellipse(a, b, m); });
}

// A ready-made outline whose parameters are all lengths or angles > 0, in the order of the function's.
template <auto shape, class... Keys>
Outline ReadParameters(const JsonField& field, Keys... keys) {
  field.RequireOnlyKeys({keys...});
  const std::array<double, sizeof...(keys)> values{ReadNumber(field[keys], kPositive)...};
  return AtField(field, [&] { return std::apply(shape, values); });
}

Outline ReadReadyMade(const std::string& kind, const JsonField& field) {
  if (kind == "disc") return ReadParameters<&Disc>(field, "radius");
  if (kind == "box") return ReadParameters<&Box>(field, "width", "height");
  if (kind == "rounded_box") return ReadParameters<&RoundedBox>(field, "width", "height", "corner_radius");
  if (kind == "capsule") return ReadParameters<&Capsule>(field, "length", "radius");
  if (kind == "half_disc") return ReadParameters<&HalfDisc>(field, "radius");
  if (kind == "d_shape") return ReadParameters<&DShape>(field, "straight", "radius");
  if (kind == "ring") return ReadParameters<&Ring>(field, "outer_radius", "inner_radius");
  if (kind == "ellipse") return ReadParameters<&Ellipse>(field, "a", "b");
  if (kind == "superellipse") return ReadSuperellipseShape(field);
  if (kind == "gear") return ReadGear(field);
  if (kind == "cam") return ReadParameters<&Cam>(field, "base_radius", "nose_radius", "distance");
  return ReadParameters<&Bowl>(field, "outer_radius", "inner_radius", "half_opening");
}

Outline ReadChains(const JsonField& field) {
  field.RequireOnlyKeys({"chains"});
  Outline outline;
  for (const JsonField& chain : field["chains"].Items()) outline.loops.push_back(ReadPath(chain));
  return outline;
}

Outline ReadDrawn(const JsonField& field) {
  field.RequireOnlyKeys({"path", "holes"});
  Outline outline;
  outline.loops.push_back(ReadClosedPath(field["path"]));
  if (field.Has("holes")) {
    for (const JsonField& hole : field["holes"].Items()) outline.loops.push_back(ReadClosedPath(hole));
  }
  return outline;
}

}  // namespace

OutlineLoop ReadPath(const JsonField& field) { return ReadDrawnPath(field).edges; }

SceneShape ReadShape(const JsonField& field, const std::string& name) {
  SceneShape shape;
  if (field.Has("chains")) {
    shape.outline = ReadChains(field);
    shape.is_region = false;
  } else if (field.Has("path")) {
    shape.outline = ReadDrawn(field);
  } else {
    const std::string kind = OnlyKey(field, {"path", "chains", "disc", "box", "rounded_box", "capsule", "half_disc",
                                             "d_shape", "ring", "ellipse", "superellipse", "gear", "cam", "bowl"});
    shape.outline = ReadReadyMade(kind, field[kind.c_str()]);
  }
  shape.outline.name = name;
  if (shape.is_region) {
    AtField(field, [&] {
      RequireValid(shape.outline);
      shape.per_density = ComputeMassProperties(shape.outline, 1);
    });
  }
  return shape;
}

}  // namespace lcpbench
