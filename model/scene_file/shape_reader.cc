#include "model/scene_file/shape_reader.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include "model/scene_file/edge_reader.h"
#include "model/scene_file/fields.h"
#include "model/shape/outline_checks.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

// Edges join if the gap is below this, relative to the lengths they are computed from: as in OutlineOf (detection.h).
constexpr double kJoined = 1e-9;
// More would be circles for all purposes, and a short file should not ask for much memory.
constexpr int kMostTeeth = 1000;

struct Path {
  OutlineLoop edges;
  Vec2 begin;
  Vec2 end;
};

Path ReadPath(const JsonField& field) {
  Path path;
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
  Path path = ReadPath(field);
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
  const auto read = [&](const char* key, double* value) {
    if (field.Has(key)) *value = ReadPositive(field[key]);
  };
  read("root_radius", &gear.root_radius);
  read("tip_radius", &gear.tip_radius);
  read("tip_share", &gear.tip_share);
  read("foot_share", &gear.foot_share);
  read("flank_radius", &gear.flank_radius);
  return AtField(field, [&] { return Gear(gear); });
}

Outline ReadSuperellipseShape(const JsonField& field) {
  field.RequireOnlyKeys({"a", "b", "m"});
  const double a = ReadPositive(field["a"]);
  const double b = ReadPositive(field["b"]);
  const int m = field["m"].Integer();
  return AtField(field, [&] { return Superellipse(a, b, m); });
}

// A ready-made outline whose parameters are all lengths or angles > 0, in the order of the function's.
template <auto shape, class... Keys>
Outline ReadParameters(const JsonField& field, Keys... keys) {
  field.RequireOnlyKeys({keys...});
  const std::array<double, sizeof...(keys)> values{ReadPositive(field[keys])...};
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
  for (const JsonField& chain : field["chains"].Items()) outline.loops.push_back(ReadPath(chain).edges);
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
