#include "model/scene_file/body_reader.h"

#include <optional>
#include <utility>

#include "model/scene_file/fields.h"
#include "model/trig.h"

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
  return body;
}

}  // namespace

int SceneBodies::Find(const JsonField& name) const {
  const auto found = index_of.find(name.String());
  if (found == index_of.end()) name.Mismatch("the name of a body");
  return found->second;
}

Vec2 SceneBodies::BodyPoint(int body, Vec2 drawn) const {
  const Vec2 origin = origins[static_cast<std::size_t>(body)];
  return IsZero(origin) ? drawn : drawn - origin;
}

Vec2 SceneBodies::WorldPoint(int body, Vec2 point) const {
  return (*this)[body].x + Rotate(SinCos((*this)[body].theta), point);
}

Vec2 SceneBodies::PointAt(int body, Vec2 world) const {
  const Rotation r = SinCos((*this)[body].theta);
  return Rotate({r.cos, -r.sin}, world - (*this)[body].x);
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
