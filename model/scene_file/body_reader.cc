#include "model/scene_file/body_reader.h"

#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "model/geometry/trig.h"
#include "model/scene_file/fields.h"

namespace lcpbench {
namespace {

bool IsZero(Vec2 p) { return p.x == 0 && p.y == 0; }

// By reference where it is named: shapes may be long, and shared by many bodies.
class ShapeOf {
 public:
  ShapeOf(const JsonField& body, const std::string& body_name, const NamedShapes& shapes) {
    if (!body.Has("shape")) return;
    const JsonField field = body["shape"];
    if (!field.IsString()) {
      inline_ = ReadShape(field, body_name);
      return;
    }
    const auto found = shapes.find(field.String());
    if (found == shapes.end()) field.Mismatch("the name of one of the file's \"shapes\", or a shape");
    named_ = &found->second;
  }

  /// Null for a body without a shape.
  const SceneShape* get() const { return inline_ ? &*inline_ : named_; }

 private:
  std::optional<SceneShape> inline_;
  const SceneShape* named_ = nullptr;
};

// Mass, inertia and, returned, the body frame's origin in the drawing.
Vec2 ReadMass(const JsonField& field, const SceneShape* shape, Body* body) {
  const bool is_region = shape != nullptr && shape->is_region;
  const Vec2 centroid = is_region && !body->fixed ? shape->per_density.center : Vec2{};
  if (field.Has("density")) {
    for (const char* other : {"mass", "inertia", "center_of_mass"}) {
      if (field.Has(other)) field[other].Fail("does not go with \"density\", which determines it");
    }
    const double density = ReadPositive(field["density"]);
    if (!is_region) field["density"].Fail("a body without a closed shape has no area: state mass and inertia");
    body->mass = density * shape->per_density.area;
    body->inertia = density * shape->per_density.inertia;
    return centroid;
  }
  if (field.Has("mass")) body->mass = ReadPositive(field["mass"]);
  if (field.Has("inertia")) body->inertia = ReadPositive(field["inertia"]);
  if (body->fixed) {
    if (field.Has("center_of_mass")) field["center_of_mass"].Fail("a fixed body has none: its frame is the drawing's");
    return {};
  }
  if (!field.Has("mass"))
    field.Fail("expected \"density\" or \"mass\": only a fixed body (\"fixed\": true) needs neither");
  if (!field.Has("inertia")) {
    if (field.Has("center_of_mass")) field["center_of_mass"].Fail("needs \"inertia\" beside it, about that point");
    if (!is_region) field.Fail("expected \"inertia\": a body without a shape has none of its own");
    body->inertia = body->mass / shape->per_density.area * shape->per_density.inertia;
    return centroid;
  }
  return ReadVector(field, "center_of_mass", centroid);
}

void ReadState(const JsonField& field, Vec2 origin, Body* body) {
  body->x = ReadVector(field, "position", {});
  body->theta = ReadNumber(field, "angle", 0);
  body->v = ReadVector(field, "velocity", {});
  body->omega = ReadNumber(field, "angular_velocity", 0);
  for (const char* key : {"acceleration", "angular_acceleration"}) {
    if (field.Has(key) && !body->fixed)
      field[key].Fail("is prescribed for fixed bodies only; others follow their loads");
  }
  body->acceleration = ReadVector(field, "acceleration", {});
  body->alpha = ReadNumber(field, "angular_acceleration", 0);
  // A body whose frame is the drawing's keeps its numbers to the sign of zero.
  if (IsZero(origin)) return;
  const Vec2 arm = Rotate(SinCos(body->theta), origin);
  body->x = body->x + arm;
  body->v = body->v + body->omega * Perp(arm);
}

bool IsInRange(Vec2 p) { return std::abs(p.x) <= kLargestNumber && std::abs(p.y) <= kLargestNumber; }

Vec2 InRange(Vec2 point, const JsonField& field) {
  if (!IsInRange(point)) field.Fail("more than 1e30 m from the body's centre of mass: " + Text(point));
  return point;
}

// What is derived from numbers in range may lie outside: of every body that is read, all numbers can be written.
void RequireInRange(const Body& body, const JsonField& field) {
  const auto positive = [](double value) { return value >= 1 / kLargestNumber && value <= kLargestNumber; };
  if (!positive(body.mass)) field.Fail("the mass must lie within 1e-30..1e30, but is " + Text(body.mass));
  if (!positive(body.inertia)) field.Fail("the inertia must lie within 1e-30..1e30, but is " + Text(body.inertia));
  if (!IsInRange(body.x)) field.Fail("the position of the centre of mass must lie within -1e30..1e30");
  if (!IsInRange(body.v)) field.Fail("the velocity of the centre of mass must lie within -1e30..1e30");
  for (const OutlineEdge& edge : body.outline) {
    const auto* arc = std::get_if<ArcEdge>(&edge.edge);
    if (!(Reach(edge) <= kLargestNumber) || (arc != nullptr && !positive(arc->radius))) {
      field.Fail("lengths must lie within 1e-30..1e30, but not those of its " + Describe(ToFeature(edge.edge)));
    }
  }
}

Body ReadBody(const JsonField& field, const NamedShapes& shapes, Vec2* origin) {
  field.RequireOnlyKeys({"name", "shape", "fixed", "density", "mass", "inertia", "center_of_mass", "position", "angle",
                         "velocity", "angular_velocity", "acceleration", "angular_acceleration"});
  Body body;
  body.name = ReadName(field["name"]);
  body.fixed = field.Has("fixed") && field["fixed"].Boolean();
  const ShapeOf shape_of(field, body.name, shapes);
  const SceneShape* shape = shape_of.get();
  if (shape != nullptr && !shape->is_region && !body.fixed) {
    field["shape"].Fail("open outline: only a fixed body may have \"chains\", a movable one needs a closed shape");
  }
  *origin = ReadMass(field, shape, &body);
  ReadState(field, *origin, &body);
  if (shape != nullptr) {
    body.outline = AllPieces(IsZero(*origin) ? shape->outline : Transformed(shape->outline, 0, -*origin));
  }
  RequireInRange(body, field);
  return body;
}

}  // namespace

int SceneBodies::Find(const JsonField& name) const {
  const auto found = index_of.find(name.String());
  if (found == index_of.end()) name.Mismatch("the name of a body");
  return found->second;
}

Vec2 SceneBodies::ReadPoint(const JsonField& field, int body) const {
  const Vec2 drawn = ReadVector(field);
  const Vec2 origin = origins[static_cast<std::size_t>(body)];
  return IsZero(origin) ? drawn : InRange(drawn - origin, field);
}

Vec2 SceneBodies::WorldPoint(int body, Vec2 point) const {
  return (*this)[body].x + Rotate(SinCos((*this)[body].theta), point);
}

Vec2 SceneBodies::ReadPlace(const JsonField& field, int body) const {
  const Rotation r = SinCos((*this)[body].theta);
  return InRange(Rotate({r.cos, -r.sin}, ReadVector(field) - (*this)[body].x), field);
}

SceneBodies ReadBodies(const JsonField& field, const NamedShapes& shapes, std::size_t most_edges) {
  SceneBodies result;
  std::size_t edges = 0;
  for (const JsonField& item : field.Items()) {
    Vec2 origin;
    Body body = ReadBody(item, shapes, &origin);
    edges += body.outline.size();
    if (edges > most_edges) {
      item.Fail("more than " + std::to_string(most_edges) + " edges in all, the most for a file of this length");
    }
    if (!result.index_of.emplace(body.name, static_cast<int>(result.bodies.size())).second) {
      item["name"].Fail("another body has the same name");
    }
    result.bodies.push_back(std::move(body));
    result.origins.push_back(origin);
  }
  return result;
}

}  // namespace lcpbench
