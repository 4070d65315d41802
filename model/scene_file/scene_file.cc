#include "model/scene_file/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/path.h"
#include "model/detection/detection.h"
#include "model/geometry/feature.h"
#include "model/motion/make_motion.h"
#include "model/scene_file/fields.h"
#include "model/scene_file/shape_forms.h"
#include "model/shape/outline.h"
#include "support/number_text.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

using Json = OrderedJson;

// Whether a member is in every file that is read (kRequired), and whether a 0, unless it is -0, is left out of what is
// written (kOptional). Where a member is absent, the value stays as it is; none is never written.
enum class Need { kRequired, kStated, kOptional };
using enum Need;

// The point of an end; the end itself stands for its body. Bodies are named, points are those of their drawings.
template <class T>
struct PointOf {
  Attachment T::*end;
};

// A member of an object of scene files, for both directions.
template <class T>
struct Member {
  const char* key;
  std::variant<double T::*, std::optional<double> T::*, Vec2 T::*, int T::*, Attachment T::*, PointOf<T>,
               ConstraintType T::*, std::optional<MotionLevel> T::*, std::optional<ImpactLaw> T::*>
      value;
  Need need = kRequired;
  const Range* range = &kAnyNumber;
};

// In the order of written files.
constexpr Member<Spring> kSpring[] = {{"body1", &Spring::end1},
                                      {"point1", PointOf<Spring>{&Spring::end1}, kStated},
                                      {"body2", &Spring::end2},
                                      {"point2", PointOf<Spring>{&Spring::end2}, kStated},
                                      {"stiffness", &Spring::stiffness, kRequired, &kNonNegative},
                                      {"rest_length", &Spring::rest_length, kRequired, &kNonNegative}};
constexpr Member<Damper> kDamper[] = {{"body1", &Damper::end1},
                                      {"point1", PointOf<Damper>{&Damper::end1}, kStated},
                                      {"body2", &Damper::end2},
                                      {"point2", PointOf<Damper>{&Damper::end2}, kStated},
                                      {"coefficient", &Damper::coefficient, kRequired, &kNonNegative}};
constexpr Member<Thruster> kThruster[] = {
    {"body", &Thruster::at}, {"point", PointOf<Thruster>{&Thruster::at}, kStated}, {"force", &Thruster::force}};
constexpr Member<Wrench> kWrench[] = {{"body", &Wrench::at},
                                      {"point", PointOf<Wrench>{&Wrench::at}, kStated},
                                      {"force", &Wrench::force, kOptional},
                                      {"torque", &Wrench::torque, kOptional}};
constexpr Member<MutualAttraction> kAttraction[] = {
    {"strength", &MutualAttraction::strength}, {"softening", &MutualAttraction::softening, kStated, &kNonNegative}};
constexpr Member<PairFriction> kPairFriction[] = {{"body1", &PairFriction::body1},
                                                  {"body2", &PairFriction::body2},
                                                  {"friction", &PairFriction::mu, kRequired, &kCoefficient}};
// The members of a body besides name, shape and mass; the last three are for fixed bodies only.
constexpr Member<Body> kSurface[] = {{"friction", &Body::friction, kOptional, &kCoefficient}};
constexpr Member<Body> kState[] = {{"position", &Body::x, kOptional},
                                   {"angle", &Body::theta, kOptional},
                                   {"velocity", &Body::v, kOptional},
                                   {"angular_velocity", &Body::omega, kOptional}};
constexpr Member<Body> kPrescribed[] = {{"acceleration", &Body::acceleration, kOptional},
                                        {"angular_acceleration", &Body::alpha, kOptional},
                                        {"surface_speed", &Body::surface_speed, kOptional}};
// The members that all joints have besides ends, points or edges; others depend on the type.
constexpr Member<Constraint> kJoint[] = {
    {"type", &Constraint::type}, {"body1", &Constraint::body1}, {"body2", &Constraint::body2}};
constexpr Member<Constraint> kPin[] = {{"torque_limit", &Constraint::torque_limit, kOptional, &kNonNegative},
                                       {"speed", &Constraint::speed, kOptional}};
constexpr Member<Constraint> kPath[] = {{"s1", &Constraint::s1, kStated},
                                        {"s2", &Constraint::s2, kStated},
                                        {"nominal_gap", &Constraint::nominal_gap, kOptional}};
constexpr Member<Constraint> kRodOrRope[] = {{"length", &Constraint::length, kStated, &kPositive}};
constexpr Member<SceneFile> kMotion[] = {{"level", &SceneFile::level, kStated},
                                         {"step", &SceneFile::step, kStated, &kPositive},
                                         {"restitution", &SceneFile::restitution, kStated, &kShare},
                                         {"impact_law", &SceneFile::impact_law, kStated},
                                         {"resting_speed", &SceneFile::resting_speed, kStated, &kNonNegative}};
constexpr Member<Loads> kGravity[] = {{"gravity", &Loads::gravity, kOptional}};

// Calls visit(key, list, members) for the loads of each kind that a world may have many of.
template <class AnyLoads, class Visit>
void ForEachKind(AnyLoads* loads, const Visit& visit) {
  visit("springs", &loads->springs, kSpring);
  visit("dampers", &loads->dampers, kDamper);
  visit("thrusters", &loads->thrusters, kThruster);
  visit("wrenches", &loads->wrenches, kWrench);
}

// Calls visit(members) with those of a type of joints.
template <class Visit>
void WithMembers(ConstraintType type, const Visit& visit) {
  if (type == ConstraintType::kPin) return visit(kPin);
  type == ConstraintType::kPathJoint ? visit(kPath) : visit(kRodOrRope);
}

bool IsZero(Vec2 p) { return p.x == 0 && p.y == 0; }

Vec2 InRange(Vec2 point, const JsonField& field) {
  if (!kAnyNumber.Holds(point)) field.Fail("more than 1e30 m from the body's centre of mass: " + Text(point));
  return point;
}

/// The bodies of a scene file, and what joints and loads need to speak of them by their names and drawings.
struct SceneBodies {
  std::vector<Body>& bodies;
  std::size_t most_edges;  ///< of all bodies together, so that many bodies of one long shape stay an error
  /// origins[i]: the body frame's origin in the frame that bodies[i] is drawn in: its centre of mass, (0, 0) if fixed.
  std::vector<Vec2> origins = {};
  std::map<std::string, int> index_of = {};

  const Body& operator[](int index) const { return bodies[static_cast<std::size_t>(index)]; }
  Vec2 OriginOf(int index) const { return origins[static_cast<std::size_t>(index)]; }

  /// The body that a field names.
  int Find(const JsonField& name) const {
    const auto found = index_of.find(name.String());
    if (found == index_of.end()) name.Mismatch("the name of a body");
    return found->second;
  }
  /// The point of the drawing that a field states, in body coordinates.
  Vec2 ReadPoint(const JsonField& field, int body) const {
    const Vec2 drawn = ReadVector(field);
    return IsZero(OriginOf(body)) ? drawn : InRange(drawn - OriginOf(body), field);
  }
  /// The body-frame point that lies now where a field states, in the world.
  Vec2 ReadPlace(const JsonField& field, int body) const {
    return InRange(BodyPoint((*this)[body], ReadVector(field)), field);
  }
};

template <class T>
void ReadMembers(const JsonField& object, const auto& members, const SceneBodies* bodies, T* read) {
  for (const Member<T>& member : members) {
    if (member.need != kRequired && !object.Has(member.key)) continue;
    const JsonField field = object[member.key];
    std::visit(
        Overloaded{[&](double T::*value) { read->*value = ReadNumber(field, *member.range); },
                   [&](std::optional<double> T::*value) { read->*value = ReadNumber(field, *member.range); },
                   [&](Vec2 T::*value) { read->*value = ReadVector(field); },
                   [&](int T::*body) { read->*body = bodies->Find(field); },
                   [&](Attachment T::*end) { (read->*end).body = bodies->Find(field); },
                   [&](PointOf<T> at) { (read->*at.end).point = bodies->ReadPoint(field, (read->*at.end).body); },
                   [&](ConstraintType T::*value) { read->*value = field.Choice(kNames<ConstraintType>); },
                   [&]<class E>(std::optional<E> T::*value) { read->*value = field.Choice(kNames<E>); }},
        member.value);
  }
}

// Keys that are known to an object, a table's behind others.
using Keys = std::vector<const char*>;
void AddKeys(const auto& members, Keys* keys) {
  for (const auto& member : members) keys->push_back(member.key);
}

// A load that acts between bodies is tried out: what it refuses at the start is an error of the file.
void Try(const Spring& spring, const SceneBodies& bodies) { ApplySpring(spring, bodies.bodies); }
void Try(const Damper& damper, const SceneBodies& bodies) { ApplyDamper(damper, bodies.bodies); }
void Try(const MutualAttraction& pull, const SceneBodies& bodies) { ApplyMutualAttraction(pull, bodies.bodies); }
void Try(const auto& /*unused*/, const SceneBodies& /*unused*/) {}

// An object that has the members of a table, and no others.
void ReadObject(const JsonField& field, const auto& members, const SceneBodies& bodies, auto* object) {
  Keys keys;
  AddKeys(members, &keys);
  field.RequireOnlyKeys(keys);
  ReadMembers(field, members, &bodies, object);
  AtField(field, [&] { Try(*object, bodies); });
}

void ReadList(const JsonField& field, const char* key, const auto& members, const SceneBodies& bodies, auto* list) {
  if (!field.Has(key)) return;
  for (const JsonField& item : field[key].Items()) ReadObject(item, members, bodies, &list->emplace_back());
}

// Mass, inertia and, returned, the body frame's origin in the drawing.
Vec2 ReadMass(const JsonField& field, const SceneShape* shape, Body* body) {
  const bool is_region = shape != nullptr && shape->is_region;
  const Vec2 centroid = is_region && !body->fixed ? shape->per_density.center : Vec2{};
  if (field.Has("density")) {
    for (const char* other : {"mass", "inertia", "center_of_mass"}) {
      if (field.Has(other)) field[other].Fail("does not go with \"density\", which determines it");
    }
    const double density = ReadNumber(field["density"], kPositive);
    if (!is_region) field["density"].Fail("a body without a closed shape has no area: state mass and inertia");
    body->mass = density * shape->per_density.area;
    body->inertia = density * shape->per_density.inertia;
    return centroid;
  }
  body->mass = ReadNumber(field, "mass", body->mass, kPositive);
  body->inertia = ReadNumber(field, "inertia", body->inertia, kPositive);
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
  }
  return field.Has("center_of_mass") ? ReadVector(field["center_of_mass"]) : centroid;
}

// What is derived from numbers in range may lie outside: of every body that is read, all numbers can be written.
void RequireInRange(const Body& body, const JsonField& field) {
  if (!kPositive.Holds(body.mass)) field.Fail("the mass must lie within 1e-30..1e30, but is " + NumberText(body.mass));
  if (!kPositive.Holds(body.inertia))
    field.Fail("the inertia must lie within 1e-30..1e30, but is " + NumberText(body.inertia));
  if (!kAnyNumber.Holds(body.x)) field.Fail("the position of the centre of mass must lie within -1e30..1e30");
  if (!kAnyNumber.Holds(body.v)) field.Fail("the velocity of the centre of mass must lie within -1e30..1e30");
  for (const OutlineEdge& edge : body.outline) {
    const auto* arc = std::get_if<ArcEdge>(&edge.edge);
    if (!(Reach(edge) <= kLargestNumber) || (arc != nullptr && !kPositive.Holds(arc->radius))) {
      field.Fail("lengths must lie within 1e-30..1e30, but not those of its " + Describe(ToFeature(edge.edge)));
    }
  }
}

/// The shapes of a scene file by their names.
using NamedShapes = std::map<std::string, SceneShape>;

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

Body ReadBody(const JsonField& field, const NamedShapes& shapes, Vec2* origin) {
  Keys keys = {"name", "shape", "fixed", "density", "mass", "inertia", "center_of_mass"};
  AddKeys(kState, &keys);
  AddKeys(kSurface, &keys);
  AddKeys(kPrescribed, &keys);
  field.RequireOnlyKeys(keys);
  Body body;
  body.name = ReadName(field["name"]);
  body.fixed = field.Has("fixed") && field["fixed"].Boolean();
  ReadMembers(field, kSurface, nullptr, &body);
  SceneShape own;
  const SceneShape* shape = FindShape(field, body.name, shapes, &own);
  if (shape != nullptr && !shape->is_region && !body.fixed) {
    field["shape"].Fail("open outline: only a fixed body may have \"chains\", a movable one needs a closed shape");
  }
  *origin = ReadMass(field, shape, &body);
  ReadMembers(field, kState, nullptr, &body);
  for (const Member<Body>& member : kPrescribed) {
    if (!field.Has(member.key) || body.fixed) continue;
    field[member.key].Fail("is prescribed for fixed bodies only; others follow their loads");
  }
  ReadMembers(field, kPrescribed, nullptr, &body);
  // A body whose frame is the drawing's keeps its numbers to the sign of zero.
  if (!IsZero(*origin)) {
    const Vec2 arm = Rotate(SinCos(body.theta), *origin);
    body.x = body.x + arm;
    body.v = body.v + body.omega * Perp(arm);
  }
  if (shape != nullptr) {
    body.outline = AllPieces(IsZero(*origin) ? shape->outline : Transformed(shape->outline, 0, -*origin));
  }
  RequireInRange(body, field);
  return body;
}

void ReadBodies(const JsonField& field, const NamedShapes& shapes, SceneBodies* bodies) {
  std::size_t edges = 0;
  for (const JsonField& item : field.Items()) {
    Body body = ReadBody(item, shapes, &bodies->origins.emplace_back());
    edges += body.outline.size();
    if (edges > bodies->most_edges) {
      item.Fail("more than " + std::to_string(bodies->most_edges) +
                " edges in all, the most for a file of this length");
    }
    if (!bodies->index_of.emplace(body.name, static_cast<int>(bodies->bodies.size())).second) {
      item["name"].Fail("another body has the same name");
    }
    bodies->bodies.push_back(std::move(body));
  }
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
  const Vec2 origin = bodies.OriginOf(body);
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

// The features of a path joint, with its path where that has ends.
void ReadPathEnds(const JsonField& field, const SceneBodies& bodies, Constraint* joint) {
  const bool edge_on_1 = field.Has("edge1");
  if (edge_on_1 == field.Has("edge2") || edge_on_1 == field.Has("point1") || !edge_on_1 == field.Has("point2")) {
    field.Fail("expected point1 and edge2, or edge1 and point2");
  }
  const JsonField edge = field[edge_on_1 ? "edge1" : "edge2"];
  std::vector<OutlineEdge> path = ReadJointPath(edge, edge_on_1 ? joint->body1 : joint->body2, bodies);
  (edge_on_1 ? joint->feature1 : joint->feature2) = ToFeature(path[0].edge);
  (edge_on_1 ? joint->feature2 : joint->feature1) = Vertex{edge_on_1 ? bodies.ReadPoint(field["point2"], joint->body2)
                                                                     : bodies.ReadPoint(field["point1"], joint->body1)};
  ReadMembers(field, kPath, &bodies, joint);
  if (!HasEnds(edge, path)) return;
  joint->path = std::move(path);
  if (const std::string why = WhyInvalidPath(*joint); !why.empty()) edge.Fail(why);
  PutOnPath(bodies.bodies, joint);
}

// The points of another joint, and what follows from them.
void ReadPoints(const JsonField& field, const SceneBodies& bodies, Constraint* joint) {
  const bool is_pin = joint->type == ConstraintType::kPin;
  const auto read_end = [&](int body, const char* point) {
    return is_pin && field.Has("at") ? bodies.ReadPlace(field["at"], body) : bodies.ReadPoint(field[point], body);
  };
  const Vec2 p1 = read_end(joint->body1, "point1");
  const Vec2 p2 = read_end(joint->body2, "point2");
  joint->feature1 = Vertex{p1};
  joint->feature2 = Vertex{p2};
  if (!is_pin) joint->length = Norm(WorldPoint(bodies[joint->body1], p1) - WorldPoint(bodies[joint->body2], p2));
  WithMembers(joint->type, [&](const auto& members) { ReadMembers(field, members, &bodies, joint); });
  if (!is_pin && !kPositive.Holds(joint->length)) {
    field.Fail("the points coincide (distance " + NumberText(joint->length) +
               "): expected \"length\", or points apart from each other");
  }
  if (field.Has("speed") && !field.Has("torque_limit")) field["speed"].Fail("needs \"torque_limit\" beside it");
}

Constraint ReadJoint(const JsonField& field, const SceneBodies& bodies) {
  Constraint joint;
  ReadMembers(field, kJoint, &bodies, &joint);
  if (joint.body1 == joint.body2) field["body2"].Fail("expected another body than body1");
  const bool is_path = joint.type == ConstraintType::kPathJoint;
  const bool is_pin = joint.type == ConstraintType::kPin;
  Keys keys;
  AddKeys(kJoint, &keys);
  if (!is_pin || !field.Has("at")) keys.insert(keys.end(), {"point1", "point2"});
  if (is_path) keys.insert(keys.end(), {"edge1", "edge2"});
  if (is_pin) keys.push_back("at");
  WithMembers(joint.type, [&](const auto& members) { AddKeys(members, &keys); });
  field.RequireOnlyKeys(keys);
  is_path ? ReadPathEnds(field, bodies, &joint) : ReadPoints(field, bodies, &joint);
  return joint;
}

Loads ReadLoads(const JsonField& field, const SceneBodies& bodies) {
  Loads loads;
  Keys keys;
  ForEachKind(&loads, [&](const char* key, const auto&... /*unused*/) { keys.push_back(key); });
  keys.push_back("attraction");
  field.RequireOnlyKeys(keys);
  ForEachKind(&loads,
              [&](const char* key, auto* list, const auto& members) { ReadList(field, key, members, bodies, list); });
  if (field.Has("attraction")) ReadObject(field["attraction"], kAttraction, bodies, &loads.attraction.emplace());
  ClearLoads(bodies.bodies);
  return loads;
}

NamedShapes ReadShapes(const JsonField& field) {
  NamedShapes shapes;
  for (const auto& [name, shape] : field.Members()) {
    RequireName(name, shape);
    shapes.emplace(name, ReadShape(shape, name));
  }
  return shapes;
}

using BodyNames = std::vector<std::string>;

template <class T>
void WriteMembers(const T& object, const auto& members, const BodyNames& names, Json* json) {
  const auto name = [&](int body) { return names[static_cast<std::size_t>(body)]; };
  for (const Member<T>& member : members) {
    Json value = std::visit(Overloaded{[&](int T::*body) { return Json(name(object.*body)); },
                                       [&](Attachment T::*end) { return Json(name((object.*end).body)); },
                                       [&](PointOf<T> at) { return ToJson((object.*at.end).point); },
                                       [&](auto place) { return ToJson(object.*place); }},
                            member.value);
    if (value.is_null() || (member.need == kOptional && IsDefault(value))) continue;
    (*json)[member.key] = std::move(value);
  }
}

// The edge of a path joint is its path, or the whole curve.
void WriteEnd(const std::string& number, const Feature& feature, const std::vector<OutlineEdge>& path, Json* json) {
  std::visit(Overloaded{[&](const Vertex& vertex) { (*json)["point" + number] = ToJson(vertex.p); },
                        [&](const auto& edge) {
                          (*json)["edge" + number] = path.empty() ? ToJson(OutlineCurve(edge)) : ToJson(path);
                        }},
             feature);
}

Json JointToJson(const Constraint& joint, const BodyNames& names) {
  Json json;
  WriteMembers(joint, kJoint, names, &json);
  WriteEnd("1", joint.feature1, joint.path, &json);
  WriteEnd("2", joint.feature2, joint.path, &json);
  // A speed needs a torque, even one of 0.
  if (!IsDefault(joint.speed)) json["torque_limit"] = joint.torque_limit;
  WithMembers(joint.type, [&](const auto& members) { WriteMembers(joint, members, names, &json); });
  return json;
}

Json ShapeOf(const Body& body) {
  const Outline outline = OutlineOf(body);
  for (const OutlinePiece& piece : AllPieces(outline)) RequireValidPiece(piece, "body '" + body.name + "'");
  Json loops = Json::array();
  for (const OutlineLoop& loop : outline.loops) loops.push_back(ToJson(loop));
  if (body.fixed) return Json{{"chains", loops}};
  RequireValid(outline);
  Json shape{{"path", loops[0]}};
  for (std::size_t k = 1; k < loops.size(); ++k) shape["holes"].push_back(loops[k]);
  return shape;
}

Json BodyToJson(const Body& body, const std::string& name) {
  Json json{{"name", name}};
  if (!body.outline.empty()) json["shape"] = ShapeOf(body);
  if (body.fixed) json["fixed"] = true;
  // Those of Body are what the reader takes where a fixed body states none.
  if (!body.fixed || body.mass != Body{}.mass) json["mass"] = body.mass;
  if (!body.fixed || body.inertia != Body{}.inertia) json["inertia"] = body.inertia;
  if (!body.fixed && !body.outline.empty()) json["center_of_mass"] = ToJson(Vec2{});
  WriteMembers(body, kSurface, {}, &json);
  WriteMembers(body, kState, {}, &json);
  if (body.fixed) WriteMembers(body, kPrescribed, {}, &json);
  return json;
}

// Every body's own, or one with its index where that is empty or taken.
BodyNames NamesOf(const std::vector<Body>& bodies) {
  BodyNames names;
  std::set<std::string> taken;
  for (const Body& body : bodies) {
    std::string name = body.name;
    while (name.empty() || !taken.insert(name).second) {
      name += (name.empty() ? "body " : " ") + std::to_string(names.size());
    }
    names.push_back(name);
  }
  return names;
}

// Indented, but whatever fits into a line stands in one: a dump with a line per number is unreadable. As deep as the
// writer's own nesting.
void Print(const Json& json, std::size_t indent, std::string* text) {
  constexpr std::size_t kLineLength = 110;
  constexpr std::size_t kStep = 2;
  const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (!json.is_structured() || indent + line.size() <= kLineLength) {
    *text += line;
    return;
  }
  *text += json.is_object() ? "{" : "[";
  const char* separator = "\n";
  for (const auto& [key, value] : json.items()) {
    *text += separator + std::string(indent + kStep, ' ');
    if (json.is_object()) *text += Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    Print(value, indent + kStep, text);
    separator = ",\n";
  }
  *text += "\n" + std::string(indent, ' ') + (json.is_object() ? "}" : "]");
}

}  // namespace

SceneFile ParseScene(std::string_view text, const std::string& where) {
  const nlohmann::json document = ParseJsonDocument(text, where);
  const JsonField file(document, where);
  // First of all: another version may have other keys.
  const JsonField version = file["lcpbench_scene"];
  if (version.Integer() != kSceneFileVersion) version.Mismatch(std::to_string(kSceneFileVersion));
  file.RequireOnlyKeys({"lcpbench_scene", "name", "description", "gravity", "motion", "shapes", "bodies", "joints",
                        "loads", "friction"});
  SceneFile scene;
  World& world = scene.world;
  world.name = file.Has("name") ? ReadName(file["name"]) : std::filesystem::path(where).stem().string();
  if (file.Has("description")) static_cast<void>(file["description"].String());
  // An edge with every number stated takes more bytes than this; the rest is for gears and for shapes used many times.
  constexpr std::size_t kBytesPerEdge = 8;
  constexpr std::size_t kFreeEdges = 100000;
  SceneBodies bodies{world.bodies, kFreeEdges + text.size() / kBytesPerEdge};
  if (file.Has("motion")) ReadObject(file["motion"], kMotion, bodies, &scene);
  ReadBodies(file["bodies"], file.Has("shapes") ? ReadShapes(file["shapes"]) : NamedShapes{}, &bodies);
  if (file.Has("joints")) {
    for (const JsonField& item : file["joints"].Items()) world.joints.push_back(ReadJoint(item, bodies));
  }
  ReadList(file, "friction", kPairFriction, bodies, &world.friction);
  if (file.Has("loads")) world.loads = ReadLoads(file["loads"], bodies);
  ReadMembers(file, kGravity, nullptr, &world.loads);
  AtField(file, [&] { RequireValid(world); });
  return scene;
}

SceneFile ReadSceneFile(const std::string& path) { return ParseScene(ReadTextFile(path, kMaxSceneFileBytes), path); }

std::string FormatScene(const SceneFile& scene) {
  const World& world = scene.world;
  RequireValid(world);
  const BodyNames names = NamesOf(world.bodies);
  Json file{{"lcpbench_scene", kSceneFileVersion}, {"name", world.name}};
  WriteMembers(world.loads, kGravity, names, &file);
  Json motion;
  WriteMembers(scene, kMotion, names, &motion);
  if (!motion.is_null()) file["motion"] = motion;
  file["bodies"] = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) file["bodies"].push_back(BodyToJson(world.bodies[i], names[i]));
  for (const Constraint& joint : world.joints) file["joints"].push_back(JointToJson(joint, names));
  for (const PairFriction& pair : world.friction) {
    WriteMembers(pair, kPairFriction, names, &file["friction"].emplace_back());
  }
  ForEachKind(&world.loads, [&](const char* key, const auto* list, const auto& members) {
    for (const auto& load : *list) WriteMembers(load, members, names, &file["loads"][key].emplace_back());
  });
  if (world.loads.attraction) WriteMembers(*world.loads.attraction, kAttraction, names, &file["loads"]["attraction"]);
  std::string text;
  Print(file, 0, &text);
  return text + "\n";
}

}  // namespace lcpbench
