#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "model/scene_file/body_reader.h"
#include "model/scene_file/fields.h"
#include "model/scene_file/joint_reader.h"
#include "model/scene_file/json_document.h"
#include "model/scene_file/load_reader.h"
#include "model/scene_file/scene_file.h"
#include "model/scene_file/shape_reader.h"

namespace lcpbench {
namespace {

// An edge with every number stated takes more bytes than this; the rest is for gears and for shapes used many times.
constexpr std::size_t kBytesPerEdge = 8;
constexpr std::size_t kFreeEdges = 100000;

void ReadMotion(const JsonField& field, SceneFile* scene) {
  field.RequireOnlyKeys({"level", "step", "restitution"});
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
  file.RequireOnlyKeys(
      {"lcpbench_scene", "name", "description", "gravity", "motion", "shapes", "bodies", "joints", "loads"});
  SceneFile scene;
  scene.world.name = file.Has("name") ? ReadName(file["name"]) : std::filesystem::path(where).stem().string();
  if (file.Has("description")) static_cast<void>(file["description"].String());
  if (file.Has("motion")) ReadMotion(file["motion"], &scene);
  const NamedShapes shapes = file.Has("shapes") ? ReadShapes(file["shapes"]) : NamedShapes{};
  SceneBodies bodies = ReadBodies(file["bodies"], shapes, kFreeEdges + text.size() / kBytesPerEdge);
  if (file.Has("joints")) scene.world.joints = ReadJoints(file["joints"], bodies);
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
