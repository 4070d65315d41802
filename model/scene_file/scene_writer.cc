#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/detection/detection.h"
#include "model/geometry/feature.h"
#include "model/motion/make_motion.h"
#include "model/scene_file/fields.h"
#include "model/scene_file/scene_file.h"
#include "model/shape/outline.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(Vec2 p) { return Json::array({p.x, p.y}); }

// Exactly what the reader takes for an absent number: not -0.
bool IsDefault(double value) { return value == 0 && !std::signbit(value); }

void Add(Json* object, const char* key, double value) {
  if (!IsDefault(value)) (*object)[key] = value;
}

void Add(Json* object, const char* key, Vec2 value) {
  if (!IsDefault(value.x) || !IsDefault(value.y)) (*object)[key] = ToJson(value);
}

// The curve with every number under its name in files, without its range and side.
Json ToJson(const OutlineCurve& curve) {
  return std::visit(
      [](const auto& e) {
        constexpr bool kIsStraight = std::is_same_v<decltype(e), const StraightEdge&>;
        Json form;
        ForEachField(e, [&](const std::string& name, const auto& value) {
          if constexpr (kIsStraight) {
            form[name == "a" ? "from" : "to"] = ToJson(value);
          } else if constexpr (requires { value.x; }) {
            form[name] = ToJson(value);
          } else if constexpr (requires { value[0].x; }) {
            for (const Vec2 p : value) form["points"].push_back(ToJson(p));
          } else if constexpr (!std::is_same_v<decltype(value), const Side&>) {
            form[name] = value;
          }
        });
        return Json{{kIsStraight ? "line" : e.kName, form}};
      },
      curve);
}

Json ToJson(const OutlinePiece& piece) {
  Json json = ToJson(piece.edge);
  Json& form = json.begin().value();
  const bool has_default = !std::visit([](const auto& e) { return e.kIsAngle; }, piece.edge);
  if (has_default && IsDefault(piece.s_begin) && piece.s_end == 1) return json;
  form["s_begin"] = piece.s_begin;
  form["s_end"] = piece.s_end;
  return json;
}

Json ToJson(const OutlineLoop& loop) {
  Json path = Json::array();
  for (const OutlinePiece& piece : loop) path.push_back(ToJson(piece));
  return path;
}

// The feature of a path joint: the whole curve, with the side where it has one.
Json CurveToJson(const OutlineCurve& curve) {
  Json json = ToJson(curve);
  std::visit(
      [&](const auto& e) {
        if constexpr (requires { e.side; }) json.begin().value()["turns"] = e.side == Side::kConvex ? "left" : "right";
      },
      curve);
  return json;
}

class Writer {
 public:
  explicit Writer(const SceneFile& scene) : scene_(scene), world_(scene.world) {}

  Json Write() {
    RequireValid(world_);
    NameBodies();
    Json file;
    file["lcpbench_scene"] = kSceneFileVersion;
    file["name"] = world_.name;
    Add(&file, "gravity", world_.loads.gravity);
    if (scene_.level) file["motion"]["level"] = ToString(*scene_.level);
    if (scene_.step) file["motion"]["step"] = *scene_.step;
    if (scene_.restitution) file["motion"]["restitution"] = *scene_.restitution;
    for (const auto& [name, law] : kImpactLaws) {
      if (scene_.impact_law == law) file["motion"]["impact_law"] = name;
    }
    if (scene_.resting_speed) file["motion"]["resting_speed"] = *scene_.resting_speed;
    file["bodies"] = Json::array();
    for (std::size_t i = 0; i < world_.bodies.size(); ++i) file["bodies"].push_back(BodyAt(i));
    for (const Constraint& joint : world_.joints) file["joints"].push_back(Joint(joint));
    for (const PairFriction& pair : world_.friction) {
      file["friction"].push_back({{"body1", Name(pair.body1)}, {"body2", Name(pair.body2)}, {"friction", pair.mu}});
    }
    AddLoads(&file);
    return file;
  }

 private:
  void NameBodies() {
    std::set<std::string> taken;
    for (const Body& body : world_.bodies) {
      std::string name = body.name;
      while (name.empty() || !taken.insert(name).second) {
        name += (name.empty() ? "body " : " ") + std::to_string(names_.size());
      }
      names_.push_back(name);
    }
  }

  const std::string& Name(int body) const { return names_[static_cast<std::size_t>(body)]; }

  Json BodyAt(std::size_t index) const {
    const Body& body = world_.bodies[index];
    Json json{{"name", names_[index]}};
    if (!body.outline.empty()) json["shape"] = Shape(body);
    if (body.fixed) {
      json["fixed"] = true;
      // Those of Body, which the reader takes where a fixed body states none.
      if (body.mass != Body{}.mass) json["mass"] = body.mass;
      if (body.inertia != Body{}.inertia) json["inertia"] = body.inertia;
    } else {
      json["mass"] = body.mass;
      json["inertia"] = body.inertia;
      if (!body.outline.empty()) json["center_of_mass"] = ToJson(Vec2{});
    }
    Add(&json, "friction", body.friction);
    Add(&json, "position", body.x);
    Add(&json, "angle", body.theta);
    Add(&json, "velocity", body.v);
    Add(&json, "angular_velocity", body.omega);
    if (body.fixed) {
      Add(&json, "acceleration", body.acceleration);
      Add(&json, "angular_acceleration", body.alpha);
      Add(&json, "surface_speed", body.surface_speed);
    }
    return json;
  }

  static Json Shape(const Body& body) {
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

  Json Joint(const Constraint& joint) const {
    Json json;
    for (const auto& [name, type] : kJointTypes) {
      if (type == joint.type) json["type"] = name;
    }
    json["body1"] = Name(joint.body1);
    json["body2"] = Name(joint.body2);
    AddFeature(&json, "1", joint.feature1);
    AddFeature(&json, "2", joint.feature2);
    if (joint.type == ConstraintType::kRod || joint.type == ConstraintType::kRope) json["length"] = joint.length;
    if (joint.torque_limit != 0 || !IsDefault(joint.speed)) json["torque_limit"] = joint.torque_limit;
    Add(&json, "speed", joint.speed);
    if (joint.type == ConstraintType::kPathJoint) {
      if (joint.s1) json["s1"] = *joint.s1;
      if (joint.s2) json["s2"] = *joint.s2;
      Add(&json, "nominal_gap", joint.nominal_gap);
      if (!joint.path.empty()) json[IsVertex(joint.feature1) ? "edge2" : "edge1"] = ToJson(joint.path);
    }
    return json;
  }

  static void AddFeature(Json* json, const std::string& number, const Feature& feature) {
    std::visit(Overloaded{[&](const Vertex& vertex) { (*json)["point" + number] = ToJson(vertex.p); },
                          [&](const auto& edge) { (*json)["edge" + number] = CurveToJson(edge); }},
               feature);
  }

  void AddEnd(Json* json, const std::string& number, const Attachment& at) const {
    (*json)["body" + number] = Name(at.body);
    (*json)["point" + number] = ToJson(at.point);
  }

  void AddLoads(Json* file) const {
    const Loads& loads = world_.loads;
    // Another load of that kind, with its two ends or the point that it acts at.
    const auto add_between = [&](const char* kind, const auto& load) -> Json& {
      Json& item = (*file)["loads"][kind].emplace_back();
      AddEnd(&item, "1", load.end1);
      AddEnd(&item, "2", load.end2);
      return item;
    };
    const auto add_at = [&](const char* kind, const auto& load) -> Json& {
      Json& item = (*file)["loads"][kind].emplace_back();
      AddEnd(&item, "", load.at);
      return item;
    };
    for (const Spring& spring : loads.springs) {
      Json& item = add_between("springs", spring);
      item["stiffness"] = spring.stiffness;
      item["rest_length"] = spring.rest_length;
    }
    for (const Damper& damper : loads.dampers) add_between("dampers", damper)["coefficient"] = damper.coefficient;
    for (const Thruster& thruster : loads.thrusters) add_at("thrusters", thruster)["force"] = ToJson(thruster.force);
    for (const Wrench& wrench : loads.wrenches) {
      Json& item = add_at("wrenches", wrench);
      Add(&item, "force", wrench.force);
      Add(&item, "torque", wrench.torque);
    }
    if (const auto& pull = loads.attraction) {
      (*file)["loads"]["attraction"] = {{"strength", pull->strength}, {"softening", pull->softening}};
    }
  }

  const SceneFile& scene_;
  const World& world_;
  std::vector<std::string> names_;
};

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

std::string FormatScene(const SceneFile& scene) {
  std::string text;
  Print(Writer(scene).Write(), 0, &text);
  return text + "\n";
}

}  // namespace lcpbench
