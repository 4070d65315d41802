#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/path.h"
#include "model/scene_file/fields.h"
#include "model/scene_file/scene_file.h"
#include "model/scene_file/shape_reader.h"

namespace lcpbench {
namespace {

/// The shapes of a scene file by their names.
using NamedShapes = std::map<std::string, SceneShape>;

bool IsZero(Vec2 p) { return p.x == 0 && p.y == 0; }

bool IsInRange(Vec2 p) { return std::abs(p.x) <= kLargestNumber && std::abs(p.y) <= kLargestNumber; }

Vec2 InRange(Vec2 point, const JsonField& field) {
  if (!IsInRange(point)) field.Fail("more than 1e30 m from the body's centre of mass: " + Text(point));
  return point;
}

/// The bodies of a scene file, and what joints and loads need to speak of them by their names and drawings.
struct SceneBodies {
  std::vector<Body> bodies;
  /// origins[i]: the body frame's origin in the frame that bodies[i] is drawn in: its centre of mass, (0, 0) if fixed.
  std::vector<Vec2> origins;
  std::map<std::string, int> index_of;

  Body& operator[](int index) { return bodies[static_cast<std::size_t>(index)]; }
  const Body& operator[](int index) const { return bodies[static_cast<std::size_t>(index)]; }

  /// The body that a field names.
  int Find(const JsonField& name) const {
    const auto found = index_of.find(name.String());
    if (found == index_of.end()) name.Mismatch("the name of a body");
    return found->second;
  }
  /// The point of the drawing that a field states, in body coordinates.
  Vec2 ReadPoint(const JsonField& field, int body) const {
    const Vec2 drawn = ReadVector(field);
    const Vec2 origin = origins[static_cast<std::size_t>(body)];
    return IsZero(origin) ? drawn : InRange(drawn - origin, field);
  }
  /// A body-frame point in the world.
  /// The body-frame point that lies now where a field states, in the world.
  Vec2 ReadPlace(const JsonField& field, int body) const {
    const Rotation r = SinCos((*this)[body].theta);
    return InRange(Rotate({r.cos, -r.sin}, ReadVector(field) - (*this)[body].x), field);
  }
};

// Null for a body without a shape. A named one is not copied: shapes may be long, and shared by many bodies.
const SceneShape* FindShape(const JsonField& body, const std::string& body_name, const NamedShapes& shapes,
                            SceneShape* own) {
  if (!body.Has("shape")) return nullptr;
  const JsonField field = body["shape"];
  if (!field.IsString()) {
    *own = ReadShape(field, body_name);
    return own;
  }
  const auto found = shapes.find(field.String());
  if (found == shapes.end()) field.Mismatch("the name of one of the file's \"shapes\", or a shape");
  return &found->second;
}

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
  for (const char* key : {"acceleration", "angular_acceleration", "surface_speed"}) {
    if (field.Has(key) && !body->fixed)
      field[key].Fail("is prescribed for fixed bodies only; others follow their loads");
  }
  body->acceleration = ReadVector(field, "acceleration", {});
  body->alpha = ReadNumber(field, "angular_acceleration", 0);
  body->surface_speed = ReadNumber(field, "surface_speed", 0);
  // A body whose frame is the drawing's keeps its numbers to the sign of zero.
  if (IsZero(origin)) return;
  const Vec2 arm = Rotate(SinCos(body->theta), origin);
  body->x = body->x + arm;
  body->v = body->v + body->omega * Perp(arm);
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

double ReadFriction(const JsonField& field) {
  const double mu = ReadNonNegative(field);
  if (mu > kMostFriction) field.Mismatch("a number in 0..1e6");
  return mu;
}

Body ReadBody(const JsonField& field, const NamedShapes& shapes, Vec2* origin) {
  field.RequireOnlyKeys({"name", "shape", "fixed", "density", "mass", "inertia", "center_of_mass", "position", "angle",
                         "velocity", "angular_velocity", "acceleration", "angular_acceleration", "friction",
                         "surface_speed"});
  Body body;
  body.name = ReadName(field["name"]);
  body.fixed = field.Has("fixed") && field["fixed"].Boolean();
  if (field.Has("friction")) body.friction = ReadFriction(field["friction"]);
  SceneShape own;
  const SceneShape* shape = FindShape(field, body.name, shapes, &own);
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

/// @param most_edges  of all bodies together, so that many bodies of one long shape stay an error
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

// Edges of the body's shape by their numbers, or edges of the joint's own, in the body's frame.
std::vector<OutlineEdge> ReadJointPath(const JsonField& field, int body, const SceneBodies& bodies) {
  const auto numbered = [&](const JsonField& number) {
    const std::vector<OutlineEdge>& outline = bodies[body].outline;
    if (outline.empty()) number.Mismatch("an edge as an object: the body has no shape");
    return outline[static_cast<std::size_t>(number.IndexBelow(outline.size()))];
  };
  std::vector<OutlineEdge> path;
  if (field.IsArray() && field.Size() > 0 && field.Item(0).IsNumber()) {
    for (const JsonField& number : field.Items()) path.push_back(numbered(number));
    return path;
  }
  if (!field.IsArray() && !field.IsObject()) return {numbered(field)};
  path = field.IsArray() ? ReadPath(field) : std::vector{ReadEdge(field, std::nullopt).piece};
  const Vec2 origin = bodies.origins[static_cast<std::size_t>(body)];
  for (OutlineEdge& piece : path) {
    if (!IsZero(origin)) piece = Transformed(piece, 0, -origin);
    if (!(Reach(piece) <= kLargestNumber)) field.Fail("lengths must lie below 1e30");
  }
  return path;
}

// An edge has the ends that its shape or its own numbers give it; one that states no range stands for the whole curve.
bool HasEnds(const JsonField& field, const std::vector<OutlineEdge>& path) {
  if (path.size() > 1 || field.IsArray()) return true;
  if (field.IsObject()) {
    const JsonField form = field.Members().front().second;
    return form.Has("s_begin") || form.Has("s_end");
  }
  // A closed curve runs on into itself.
  const bool is_angle = std::visit([](const auto& curve) { return curve.kIsAngle; }, path[0].edge);
  return !(is_angle && IsClosed(path));
}

// Stated, or else the distance of the two points.
double ReadLength(const JsonField& field, const Constraint& joint, const SceneBodies& bodies) {
  if (field.Has("length")) return ReadPositive(field["length"]);
  const Vec2 p1 = WorldPoint(bodies[joint.body1], std::get<Vertex>(joint.feature1).p);
  const Vec2 p2 = WorldPoint(bodies[joint.body2], std::get<Vertex>(joint.feature2).p);
  const double length = Norm(p1 - p2);
  if (!(length >= 1 / kLargestNumber && length <= kLargestNumber)) {
    field.Fail("the points coincide (distance " + Text(length) +
               "): expected \"length\", or points apart from each other");
  }
  return length;
}

// The features of a path joint, with its path where that has ends.
void ReadPathJoint(const JsonField& field, const SceneBodies& bodies, Constraint* joint) {
  field.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "edge1", "edge2", "s1", "s2", "nominal_gap"});
  const bool edge_on_1 = field.Has("edge1");
  if (edge_on_1 == field.Has("edge2") || edge_on_1 == field.Has("point1") || !edge_on_1 == field.Has("point2")) {
    field.Fail("expected point1 and edge2, or edge1 and point2");
  }
  const JsonField edge = field[edge_on_1 ? "edge1" : "edge2"];
  std::vector<OutlineEdge> path = ReadJointPath(edge, edge_on_1 ? joint->body1 : joint->body2, bodies);
  (edge_on_1 ? joint->feature1 : joint->feature2) = ToFeature(path[0].edge);
  (edge_on_1 ? joint->feature2 : joint->feature1) = Vertex{edge_on_1 ? bodies.ReadPoint(field["point2"], joint->body2)
                                                                     : bodies.ReadPoint(field["point1"], joint->body1)};
  if (field.Has("s1")) joint->s1 = ReadNumber(field["s1"]);
  if (field.Has("s2")) joint->s2 = ReadNumber(field["s2"]);
  joint->nominal_gap = ReadNumber(field, "nominal_gap", 0);
  if (!HasEnds(edge, path)) return;
  joint->path = std::move(path);
  if (const std::string why = WhyInvalidPath(*joint); !why.empty()) edge.Fail(why);
  PutOnPath(bodies.bodies, joint);
}

Constraint ReadJoint(const JsonField& field, const SceneBodies& bodies) {
  Constraint joint;
  joint.type = field["type"].Choice(kJointTypes);
  joint.body1 = bodies.Find(field["body1"]);
  joint.body2 = bodies.Find(field["body2"]);
  if (joint.body1 == joint.body2) field["body2"].Fail("expected another body than body1");
  if (joint.type == ConstraintType::kPathJoint) {
    ReadPathJoint(field, bodies, &joint);
    return joint;
  }
  const bool is_pin = joint.type == ConstraintType::kPin;
  const bool at_place = is_pin && field.Has("at");
  if (at_place) {
    field.RequireOnlyKeys({"type", "body1", "body2", "at", "torque_limit", "speed"});
  } else if (is_pin) {
    field.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "at", "torque_limit", "speed"});
  } else {
    field.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "length"});
  }
  const auto read_end = [&](int body, const char* point) -> Feature {
    return Vertex{at_place ? bodies.ReadPlace(field["at"], body) : bodies.ReadPoint(field[point], body)};
  };
  joint.feature1 = read_end(joint.body1, "point1");
  joint.feature2 = read_end(joint.body2, "point2");
  if (!is_pin) joint.length = ReadLength(field, joint, bodies);
  if (field.Has("torque_limit")) joint.torque_limit = ReadNonNegative(field["torque_limit"]);
  joint.speed = ReadNumber(field, "speed", 0);
  if (field.Has("speed") && !field.Has("torque_limit")) field["speed"].Fail("needs \"torque_limit\" beside it");
  return joint;
}

// Every load that acts between two bodies is tried out: what it refuses at the start is an error of the file.
Loads ReadLoads(const JsonField& field, SceneBodies* bodies) {
  field.RequireOnlyKeys({"springs", "dampers", "thrusters", "wrenches", "attraction"});
  const auto attachment = [&](const JsonField& item, const char* body_key, const char* point_key) -> Attachment {
    const int body = bodies->Find(item[body_key]);
    return {body, item.Has(point_key) ? bodies->ReadPoint(item[point_key], body) : Vec2{}};
  };
  const auto for_each = [&field](const char* key, std::initializer_list<const char*> keys, const auto& read) {
    if (!field.Has(key)) return;
    for (const JsonField& item : field[key].Items()) {
      item.RequireOnlyKeys(keys);
      read(item);
    }
  };
  Loads loads;
  for_each("springs", {"body1", "point1", "body2", "point2", "stiffness", "rest_length"}, [&](const JsonField& item) {
    loads.springs.push_back({attachment(item, "body1", "point1"), attachment(item, "body2", "point2"),
                             ReadNonNegative(item["stiffness"]), ReadNonNegative(item["rest_length"])});
    AtField(item, [&] { ApplySpring(loads.springs.back(), bodies->bodies); });
  });
  for_each("dampers", {"body1", "point1", "body2", "point2", "coefficient"}, [&](const JsonField& item) {
    loads.dampers.push_back({attachment(item, "body1", "point1"), attachment(item, "body2", "point2"),
                             ReadNonNegative(item["coefficient"])});
    AtField(item, [&] { ApplyDamper(loads.dampers.back(), bodies->bodies); });
  });
  for_each("thrusters", {"body", "point", "force"}, [&](const JsonField& item) {
    loads.thrusters.push_back({attachment(item, "body", "point"), ReadVector(item["force"])});
  });
  for_each("wrenches", {"body", "point", "force", "torque"}, [&](const JsonField& item) {
    loads.wrenches.push_back(
        {attachment(item, "body", "point"), ReadVector(item, "force", {}), ReadNumber(item, "torque", 0)});
  });
  if (field.Has("attraction")) {
    const JsonField item = field["attraction"];
    item.RequireOnlyKeys({"strength", "softening"});
    loads.attraction = {ReadNumber(item["strength"]), item.Has("softening") ? ReadNonNegative(item["softening"]) : 0};
    AtField(item, [&] { ApplyMutualAttraction(*loads.attraction, bodies->bodies); });
  }
  ClearLoads(bodies->bodies);
  return loads;
}

// An edge with every number stated takes more bytes than this; the rest is for gears and for shapes used many times.
constexpr std::size_t kBytesPerEdge = 8;
constexpr std::size_t kFreeEdges = 100000;

void ReadMotion(const JsonField& field, SceneFile* scene) {
  field.RequireOnlyKeys({"level", "step", "restitution", "impact_law", "resting_speed"});
  if (field.Has("level")) {
    scene->level = field["level"].Choice<MotionLevel>(
        {{"acceleration", MotionLevel::kAcceleration}, {"velocity", MotionLevel::kVelocity}});
  }
  if (field.Has("step")) scene->step = ReadPositive(field["step"]);
  if (field.Has("restitution")) {
    const double restitution = field["restitution"].Number();
    if (!(restitution >= 0 && restitution <= 1)) field["restitution"].Mismatch("a number in 0..1");
    scene->restitution = restitution;
  }
  if (field.Has("impact_law")) scene->impact_law = field["impact_law"].Choice(kImpactLaws);
  if (field.Has("resting_speed")) scene->resting_speed = ReadNonNegative(field["resting_speed"]);
}

NamedShapes ReadShapes(const JsonField& field) {
  NamedShapes shapes;
  for (const auto& [name, shape] : field.Members()) {
    RequireName(name, shape);
    shapes.emplace(name, ReadShape(shape, name));
  }
  return shapes;
}

void RequireVersion(const JsonField& file) {
  const JsonField version = file["lcpbench_scene"];
  if (version.Integer() != kSceneFileVersion) version.Mismatch(std::to_string(kSceneFileVersion));
}

}  // namespace

SceneFile ParseScene(std::string_view text, const std::string& where) {
  const nlohmann::json document = ParseJsonDocument(text, where);
  const JsonField file(document, where);
  // First of all: another version may have other keys.
  RequireVersion(file);
  file.RequireOnlyKeys({"lcpbench_scene", "name", "description", "gravity", "motion", "shapes", "bodies", "joints",
                        "loads", "friction"});
  SceneFile scene;
  scene.world.name = file.Has("name") ? ReadName(file["name"]) : std::filesystem::path(where).stem().string();
  if (file.Has("description")) static_cast<void>(file["description"].String());
  if (file.Has("motion")) ReadMotion(file["motion"], &scene);
  const NamedShapes shapes = file.Has("shapes") ? ReadShapes(file["shapes"]) : NamedShapes{};
  SceneBodies bodies = ReadBodies(file["bodies"], shapes, kFreeEdges + text.size() / kBytesPerEdge);
  if (file.Has("joints")) {
    for (const JsonField& item : file["joints"].Items()) scene.world.joints.push_back(ReadJoint(item, bodies));
  }
  if (file.Has("friction")) {
    for (const JsonField& item : file["friction"].Items()) {
      item.RequireOnlyKeys({"body1", "body2", "friction"});
      scene.world.friction.push_back(
          {bodies.Find(item["body1"]), bodies.Find(item["body2"]), ReadFriction(item["friction"])});
    }
  }
  if (file.Has("loads")) scene.world.loads = ReadLoads(file["loads"], &bodies);
  scene.world.loads.gravity = ReadVector(file, "gravity", {});
  scene.world.bodies = std::move(bodies.bodies);
  AtField(file, [&] { RequireValid(scene.world); });
  return scene;
}

SceneFile ReadSceneFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  constexpr std::size_t kChunk = std::size_t{1} << 20;
  std::string text;
  while (file) {
    const std::size_t length = text.size();
    text.resize(length + kChunk);
    file.read(text.data() + length, static_cast<std::streamsize>(kChunk));
    text.resize(length + static_cast<std::size_t>(file.gcount()));
    if (text.size() > kMaxSceneFileBytes) throw InputError(path + ": longer than 512 MiB");
  }
  if (file.bad()) throw InputError(path + ": cannot be read");
  return ParseScene(text, path);
}

}  // namespace lcpbench
