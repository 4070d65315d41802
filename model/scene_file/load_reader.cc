#include "model/scene_file/load_reader.h"

#include "model/scene_file/fields.h"

namespace lcpbench {
namespace {

class LoadReader {
 public:
  explicit LoadReader(SceneBodies* bodies) : bodies_(*bodies) {}

  Spring ReadSpring(const JsonField& field) {
    field.RequireOnlyKeys({"body1", "point1", "body2", "point2", "stiffness", "rest_length"});
    const Spring spring{ReadAttachment(field, "body1", "point1"), ReadAttachment(field, "body2", "point2"),
                        ReadNonNegative(field["stiffness"]), ReadNonNegative(field["rest_length"])};
    AtField(field, [&] { ApplySpring(spring, bodies_.bodies); });
    return spring;
  }

  Damper ReadDamper(const JsonField& field) {
    field.RequireOnlyKeys({"body1", "point1", "body2", "point2", "coefficient"});
    const Damper damper{ReadAttachment(field, "body1", "point1"), ReadAttachment(field, "body2", "point2"),
                        ReadNonNegative(field["coefficient"])};
    AtField(field, [&] { ApplyDamper(damper, bodies_.bodies); });
    return damper;
  }

  Thruster ReadThruster(const JsonField& field) {
    field.RequireOnlyKeys({"body", "point", "force"});
    return {ReadAttachment(field, "body", "point"), ReadVector(field["force"])};
  }

  Wrench ReadWrench(const JsonField& field) {
    field.RequireOnlyKeys({"body", "point", "force", "torque"});
    return {ReadAttachment(field, "body", "point"), ReadVector(field, "force", {}), ReadNumber(field, "torque", 0)};
  }

  MutualAttraction ReadAttraction(const JsonField& field) {
    field.RequireOnlyKeys({"strength", "softening"});
    MutualAttraction attraction{ReadNumber(field["strength"]), 0};
    if (field.Has("softening")) attraction.softening = ReadNonNegative(field["softening"]);
    AtField(field, [&] { ApplyMutualAttraction(attraction, bodies_.bodies); });
    return attraction;
  }

 private:
  Attachment ReadAttachment(const JsonField& field, const char* body_key, const char* point_key) const {
    const int body = bodies_.Find(field[body_key]);
    if (!field.Has(point_key)) return {body, {}};
    return {body, bodies_.BodyPoint(body, ReadVector(field[point_key]))};
  }

  SceneBodies& bodies_;
};

}  // namespace

Loads ReadLoads(const JsonField& field, SceneBodies* bodies) {
  field.RequireOnlyKeys({"springs", "dampers", "thrusters", "wrenches", "attraction"});
  LoadReader reader(bodies);
  Loads loads;
  const auto for_each = [&field](const char* key, const auto& read) {
    if (!field.Has(key)) return;
    for (const JsonField& item : field[key].Items()) read(item);
  };
  for_each("springs", [&](const JsonField& item) { loads.springs.push_back(reader.ReadSpring(item)); });
  for_each("dampers", [&](const JsonField& item) { loads.dampers.push_back(reader.ReadDamper(item)); });
  for_each("thrusters", [&](const JsonField& item) { loads.thrusters.push_back(reader.ReadThruster(item)); });
  for_each("wrenches", [&](const JsonField& item) { loads.wrenches.push_back(reader.ReadWrench(item)); });
  if (field.Has("attraction")) loads.attraction = reader.ReadAttraction(field["attraction"]);
  ClearLoads(bodies->bodies);
  return loads;
}

}  // namespace lcpbench
