#include "model/scene_file/shape_forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "model/shape/shapes.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
// How far a stated point may be from a stated curve, relative to the curve's size: as outlines may be open.
constexpr double kOnCurve = 1e-9;

// Calls visit(key, value) for the fields of a curve by their names in files.
template <class Curve, class Visit>
void ForEachMember(Curve& curve, const Visit& visit) {
  ForEachField(curve, [&](const std::string_view name, auto& value) {
    if constexpr (std::is_same_v<std::remove_const_t<Curve>, StraightEdge>) {
      visit(name == "a" ? "from" : "to", value);
    } else if constexpr (std::is_same_v<std::remove_const_t<Curve>, BezierEdge>) {
      visit("points", value);
    } else {
      visit(name == "side" ? "turns" : name.data(), value);
    }
  });
}

void Read(const JsonField& field, Vec2* point) { *point = ReadVector(field); }
void Read(const JsonField& field, double* length) { *length = ReadNumber(field, kPositive); }
void Read(const JsonField& field, int* number) { *number = field.Integer(); }
void Read(const JsonField& field, std::array<Vec2, 4>* points) {
  const std::vector<JsonField> items = field.Items(points->size());
  for (std::size_t k = 0; k < items.size(); ++k) Read(items[k], &(*points)[k]);
}

// Reads what ForEachMember visits, but for the side: how it is stated depends on the form.
// @param known  the key of what the form need not state
template <class Curve>
void ReadCurve(const JsonField& edge, Curve* curve, const std::string& known = "") {
  ForEachMember(*curve, [&](const char* key, auto& value) {
    const bool is_angle = key == std::string_view("phi");
    if ((is_angle || key == known) && !edge.Has(key)) return;
    if constexpr (std::is_same_v<decltype(value), double&>) {
      value = ReadNumber(edge[key], is_angle ? kAnyNumber : kPositive);
    } else if constexpr (!std::is_same_v<decltype(value), Side&>) {
      Read(edge[key], &value);
    }
  });
}

// Material lies on the left: inside a curve that turns left.
Side ReadTurn(const JsonField& object) { return object["turns"].Choice(kNames<Side>); }

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

// The same where s lies in [0, 1].
DrawnEdge ReadShare(const JsonField& edge, const OutlineCurve& curve) {
  return Whole({curve, ReadNumber(edge, "s_begin", 0), ReadNumber(edge, "s_end", 1)});
}

DrawnEdge ReadLine(const JsonField& line, std::optional<Vec2> begin) {
  line.RequireOnlyKeys({"from", "to", "s_begin", "s_end"});
  StraightEdge edge;
  if (!line.Has("from")) edge.a = Begin(line, begin);
  ReadCurve(line, &edge, "from");
  return ReadShare(line, edge);
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
      arc.Fail("begin and end are not equally far from the center, but " + NumberText(radius) + " and " +
               NumberText(other));
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
  ArcEdge circle;
  ReadCurve(arc, &circle);
  return ReadRange(arc, circle);
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
    edge.Fail("the point " + Text(p) + " is not on the " + oval.kName + ", but on one " + NumberText(size) +
              " times as large");
  }
  return oval.AngleAt(p);
}

// What ellipse and superellipse share: all of the curve stated, with a range of parameters or the points it joins.
template <class Oval>
DrawnEdge ReadStatedOval(const JsonField& edge, Oval oval, std::optional<Vec2> begin) {
  if (!edge.Has("to")) return ReadRange(edge, oval);
  const Vec2 p = Begin(edge, begin);
  const Vec2 q = ReadVector(edge["to"]);
  oval.side = ReadTurn(edge);
  return {Swept(oval, ParameterAt(oval, p, edge), ParameterAt(oval, q, edge)), q};
}

DrawnEdge ReadEllipse(const JsonField& edge, std::optional<Vec2> begin) {
  EllipseEdge e;
  ReadCurve(edge, &e, "center");
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
  ReadCurve(edge, &e);
  if (e.m < 2 || e.m % 2 != 0 || e.m > kMaxSuperellipseExponent) {
    edge["m"].Mismatch("an even integer in 2.." + std::to_string(kMaxSuperellipseExponent));
  }
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
  ReadCurve(edge, &bezier);
  return ReadShare(edge, bezier);
}

struct CurveForm {
  const char* key;
  DrawnEdge (*read)(const JsonField& edge, std::optional<Vec2> begin);
};
// In the order of OutlineCurve.
constexpr CurveForm kCurves[] = {{"line", ReadLine},
                                 {"arc", ReadArc},
                                 {"ellipse", ReadEllipse},
                                 {"superellipse", ReadSuperellipse},
                                 {"bezier", ReadBezier}};
static_assert(std::size(kCurves) == std::variant_size_v<OutlineCurve>);

// The form whose key is the only one of an object.
const auto& OnlyForm(const JsonField& object, const auto& forms) {
  std::vector<const char*> keys;
  std::string names;
  for (const auto& form : forms) {
    keys.push_back(form.key);
    names += (names.empty() ? "" : ", ") + std::string(form.key);
  }
  object.RequireOnlyKeys(keys);
  const auto members = object.Members();
  if (members.size() != 1) object.Mismatch("an object with exactly one of the keys " + names);
  return *std::ranges::find_if(forms, [&](const auto& form) { return form.key == members[0].first; });
}

}  // namespace

DrawnEdge ReadEdge(const JsonField& edge, std::optional<Vec2> begin) {
  const CurveForm& curve = OnlyForm(edge, kCurves);
  const JsonField form = edge[curve.key];
  DrawnEdge drawn = curve.read(form, begin);
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
  if (field.Has("teeth")) Read(field["teeth"], &gear.teeth);
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

// Reads a ready-made outline by its parameters in the order of the function's: an exponent, or lengths and angles > 0.
template <class... Parameters, class... Keys>
auto Made(Outline (*make)(Parameters...), Keys... keys) {
  return [make, keys...](const JsonField& field) {
    field.RequireOnlyKeys({keys...});
    std::tuple<Parameters...> values;
    std::apply([&](auto&... value) { (Read(field[keys], &value), ...); }, values);
    return AtField(field, [&] { return std::apply(make, values); });
  };
}

struct ShapeForm {
  const char* key;
  std::function<Outline(const JsonField& field)> read;
};
const std::vector<ShapeForm>& ShapeForms() {
  static const std::vector<ShapeForm> forms{{"path", {}},  // this and the next one: see ReadShape
                                            {"chains", {}},
                                            {"disc", Made(Disc, "radius")},
                                            {"box", Made(Box, "width", "height")},
                                            {"rounded_box", Made(RoundedBox, "width", "height", "corner_radius")},
                                            {"capsule", Made(Capsule, "length", "radius")},
                                            {"half_disc", Made(HalfDisc, "radius")},
                                            {"d_shape", Made(DShape, "straight", "radius")},
                                            {"ring", Made(Ring, "outer_radius", "inner_radius")},
                                            {"ellipse", Made(Ellipse, "a", "b")},
                                            {"superellipse", Made(Superellipse, "a", "b", "m")},
                                            {"gear", ReadGear},
                                            {"cam", Made(Cam, "base_radius", "nose_radius", "distance")},
                                            {"bowl", Made(Bowl, "outer_radius", "inner_radius", "half_opening")}};
  return forms;
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
    const ShapeForm& form = OnlyForm(field, ShapeForms());
    shape.outline = form.read(field[form.key]);
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

OrderedJson ToJson(const OutlineCurve& curve) {
  OrderedJson form;
  const auto write = [&](const char* key, const auto& value) { form[key] = ToJson(value); };
  std::visit([&](const auto& e) { ForEachMember(e, write); }, curve);
  return {{kCurves[curve.index()].key, form}};
}

OrderedJson ToJson(const OutlineLoop& loop) {
  OrderedJson path = OrderedJson::array();
  for (const OutlinePiece& piece : loop) {
    OrderedJson& form = path.emplace_back(ToJson(piece.edge)).begin().value();
    form.erase("turns");  // the range says it
    const bool has_default = !std::visit([](const auto& e) { return e.kIsAngle; }, piece.edge);
    if (has_default && IsDefault(piece.s_begin) && piece.s_end == 1) continue;
    form["s_begin"] = piece.s_begin;
    form["s_end"] = piece.s_end;
  }
  return path;
}

}  // namespace lcpbench
