#include "model/scene_file/joint_reader.h"

#include <string>
#include <variant>

#include "model/geometry/trig.h"
#include "model/scene_file/edge_reader.h"
#include "model/scene_file/fields.h"

namespace lcpbench {
namespace {

class JointReader {
 public:
  JointReader(const JsonField& field, const SceneBodies& bodies) : field_(field), bodies_(bodies) {}

  Constraint Read() {
    joint_.type = field_["type"].Choice<ConstraintType>({{"pin", ConstraintType::kPin},
                                                         {"path", ConstraintType::kPathJoint},
                                                         {"rod", ConstraintType::kRod},
                                                         {"rope", ConstraintType::kRope}});
    joint_.body1 = bodies_.Find(field_["body1"]);
    joint_.body2 = bodies_.Find(field_["body2"]);
    if (joint_.body1 == joint_.body2) field_["body2"].Fail("expected another body than body1");
    switch (joint_.type) {
      case ConstraintType::kPin:
        ReadPin();
        break;
      case ConstraintType::kPathJoint:
        ReadPath();
        break;
      case ConstraintType::kRod:
      case ConstraintType::kRope:
      case ConstraintType::kContact:
        ReadConnector();
        break;
    }
    return joint_;
  }

 private:
  Vec2 Point(const char* key, int body) const { return bodies_.ReadPoint(field_[key], body); }

  void ReadPin() {
    if (field_.Has("at")) {
      field_.RequireOnlyKeys({"type", "body1", "body2", "at"});
      joint_.feature1 = Vertex{bodies_.ReadPlace(field_["at"], joint_.body1)};
      joint_.feature2 = Vertex{bodies_.ReadPlace(field_["at"], joint_.body2)};
      return;
    }
    field_.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "at"});
    ReadPoints();
  }

  void ReadPoints() {
    joint_.feature1 = Vertex{Point("point1", joint_.body1)};
    joint_.feature2 = Vertex{Point("point2", joint_.body2)};
  }

  void ReadConnector() {
    field_.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "length"});
    ReadPoints();
    if (field_.Has("length")) {
      joint_.length = ReadPositive(field_["length"]);
      return;
    }
    const Vec2 p1 = bodies_.WorldPoint(joint_.body1, std::get<Vertex>(joint_.feature1).p);
    const Vec2 p2 = bodies_.WorldPoint(joint_.body2, std::get<Vertex>(joint_.feature2).p);
    joint_.length = Norm(p1 - p2);
    if (!(joint_.length >= 1 / kLargestNumber && joint_.length <= kLargestNumber)) {
      field_.Fail("the points coincide (distance " + Text(joint_.length) +
                  "): expected \"length\", or points apart from each other");
    }
  }

  void ReadPath() {
    field_.RequireOnlyKeys({"type", "body1", "body2", "point1", "point2", "edge1", "edge2", "s1", "s2", "nominal_gap"});
    const bool edge_on_1 = field_.Has("edge1");
    if (edge_on_1 == field_.Has("edge2") || edge_on_1 == field_.Has("point1") || !edge_on_1 == field_.Has("point2")) {
      field_.Fail("expected point1 and edge2, or edge1 and point2");
    }
    joint_.feature1 = edge_on_1 ? Edge("edge1", joint_.body1) : Vertex{Point("point1", joint_.body1)};
    joint_.feature2 = edge_on_1 ? Vertex{Point("point2", joint_.body2)} : Edge("edge2", joint_.body2);
    if (field_.Has("s1")) joint_.s1 = ReadNumber(field_["s1"]);
    if (field_.Has("s2")) joint_.s2 = ReadNumber(field_["s2"]);
    joint_.nominal_gap = ReadNumber(field_, "nominal_gap", 0);
  }

  // An edge of the body's shape by its number, or one of the joint's own.
  Feature Edge(const char* key, int body) const {
    const JsonField edge = field_[key];
    OutlineCurve curve;
    if (edge.IsObject()) {
      const Vec2 origin = bodies_.origins[static_cast<std::size_t>(body)];
      const OutlinePiece piece = ReadEdge(edge, std::nullopt).piece;
      const bool moves = origin.x != 0 || origin.y != 0;
      const OutlinePiece moved = moves ? Transformed(piece, 0, -origin) : piece;
      if (!(Reach(moved) <= kLargestNumber)) edge.Fail("lengths must lie below 1e30");
      curve = moved.edge;
    } else {
      const std::vector<OutlineEdge>& outline = bodies_[body].outline;
      if (outline.empty()) edge.Mismatch("an edge as an object: the body has no shape");
      curve = outline[static_cast<std::size_t>(edge.IndexBelow(outline.size()))].edge;
    }
    return std::visit([](const auto& e) -> Feature { return e; }, curve);
  }

  const JsonField& field_;
  const SceneBodies& bodies_;
  Constraint joint_;
};

}  // namespace

std::vector<Constraint> ReadJoints(const JsonField& field, const SceneBodies& bodies) {
  std::vector<Constraint> joints;
  for (const JsonField& item : field.Items()) joints.push_back(JointReader(item, bodies).Read());
  return joints;
}

}  // namespace lcpbench
