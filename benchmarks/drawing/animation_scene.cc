#include "benchmarks/drawing/animation_scene.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "benchmarks/drawing/picture_layout.h"
#include "benchmarks/drawing/picture_parts.h"
#include "model/detection/detection.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

/// A path's coordinates have two decimals: this many units across are enough for any zoom.
constexpr double kUnitsAcross = 4000;

Json Point(Vec2 p) { return {p.x, p.y}; }

PageMap BodyFrame(double unit) { return {{}, unit, {}, 0, false}; }

/// Path units per metre.
double UnitOf(double extent) { return extent > 0 ? kUnitsAcross / extent : kUnitsAcross; }

/// @param band  depth of the hatching of unbounded bodies [m]
Json BodyJson(const Body& body, double band) {
  Json json = {{"name", body.name}, {"kind", body.fixed ? (IsDriven(body) ? "driven" : "fixed") : "movable"}};
  if (!body.fixed) json["mass"] = body.mass;
  json["pose"] = {body.x.x, body.x.y, body.theta};
  Body upright = body;
  upright.x = {};
  upright.theta = 0;
  const Bounds bounds = BoundsOf(upright);
  if (body.outline.empty()) return json;
  const double unit = UnitOf(bounds.extent());
  const PageMap map = BodyFrame(unit);
  json["unit"] = unit;
  json["radius"] = std::max({Norm(bounds.low()), Norm(bounds.high()), Norm({bounds.low().x, bounds.high().y}),
                             Norm({bounds.high().x, bounds.low().y})});
  const Outline outline = OutlineOf(body);
  std::string fill;
  if (!body.fixed || IsBounded(outline)) {
    fill = OutlinePath(outline, map);
  } else {
    for (const OutlineEdge& piece : body.outline) fill += BandPath(piece, map, band * unit);
  }
  json["fill"] = fill;
  std::array<std::string, kEdgeStyles.size()> edges;
  for (const OutlineEdge& piece : body.outline) {
    edges[static_cast<std::size_t>(KindOf(piece.edge))] += PiecePath(piece, map, "M");
  }
  json["edges"] = Json::array();
  for (std::size_t kind = 0; kind < edges.size(); ++kind) {
    if (!edges[kind].empty()) json["edges"].push_back({kind, edges[kind]});
  }
  return json;
}

Json Connector(const char* type, const Attachment& end1, const Attachment& end2) {
  return {{"type", type}, {"a", end1.body}, {"p", Point(end1.point)}, {"b", end2.body}, {"q", Point(end2.point)}};
}

/// A joint between a vertex and a path, or two vertices; p and q are points of the bodies.
std::optional<Json> JointJson(const Constraint& joint, const std::vector<Body>& bodies) {
  const auto* vertex1 = std::get_if<Vertex>(&joint.feature1);
  const auto* vertex2 = std::get_if<Vertex>(&joint.feature2);
  if (joint.type == ConstraintType::kPathJoint) {
    const bool first = vertex1 != nullptr;
    const Vertex* vertex = first ? vertex1 : vertex2;
    const std::optional<OutlineEdge> path = WholeCurve(first ? joint.feature2 : joint.feature1);
    if (vertex == nullptr || !path) return std::nullopt;
    const int rider = first ? joint.body1 : joint.body2;
    const int owner = first ? joint.body2 : joint.body1;
    Body carrier;
    carrier.outline = {*path};
    const double unit = UnitOf(BoundsOf(carrier).extent());
    Json json = Connector("path", {rider, vertex->p}, {owner, {}});
    json["unit"] = unit;
    json["path"] = PiecePath(*path, BodyFrame(unit), "M");
    json["ownerFixed"] = bodies[static_cast<std::size_t>(owner)].fixed;
    return json;
  }
  if (vertex1 == nullptr || vertex2 == nullptr) return std::nullopt;
  const char* type = joint.type == ConstraintType::kPin ? "pin" : joint.type == ConstraintType::kRod ? "rod" : "rope";
  Json json = Connector(type, {joint.body1, vertex1->p}, {joint.body2, vertex2->p});
  if (joint.type == ConstraintType::kRope) json["length"] = joint.length;
  return json;
}

Json ConnectorsJson(const World& world) {
  Json connectors = Json::array();
  for (const Constraint& joint : world.joints) {
    if (const auto json = JointJson(joint, world.bodies)) connectors.push_back(*json);
  }
  for (const Spring& spring : world.loads.springs) {
    connectors.push_back(Connector("spring", spring.end1, spring.end2));
  }
  for (const Damper& damper : world.loads.dampers) {
    connectors.push_back(Connector("damper", damper.end1, damper.end2));
  }
  return connectors;
}

/// The start, and from there on every body that has not left for good: what flies far away shall not shrink the rest.
Bounds MotionView(const Animation& animation, const std::vector<Bounds>& bounds) {
  const std::vector<Body>& bodies = animation.world.bodies;
  const Bounds start = ViewOf(bodies, bounds, {});
  const double far = 0.6 * start.extent();
  Bounds view = start;
  for (const AnimationFrame& frame : animation.frames) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].fixed) continue;
      const Vec2 x = frame.poses[i].x;
      const double reach = bounds[i].extent() / 2;
      const bool near = x.x > start.low().x - far && x.x < start.high().x + far && x.y > start.low().y - far &&
                        x.y < start.high().y + far;
      if (!near) continue;
      view.Add(x - Vec2{reach, reach});
      view.Add(x + Vec2{reach, reach});
    }
  }
  return view;
}

Json EnergiesJson(const Animation& animation) {
  Json kinetic = Json::array();
  Json potential = Json::array();
  for (const AnimationFrame& frame : animation.frames) {
    kinetic.push_back(frame.kinetic);
    potential.push_back(frame.potential);
  }
  return {{"kinetic", kinetic}, {"potential", potential}};
}

}  // namespace

Json SceneJson(const Animation& animation) {
  const World& world = animation.world;
  std::vector<Bounds> bounds;
  for (const Body& body : world.bodies) bounds.push_back(BoundsOf(body));
  const Bounds view = MotionView(animation, bounds);
  const double median = MedianExtent(world.bodies, bounds);
  const double size = median > 0 ? median : std::max(view.extent() / 10, 1e-9);

  Json json = {{"name", world.name}, {"caption", animation.caption}, {"stopped", animation.stopped}};
  json["statistics"] = {{"steps", animation.statistics.steps},
                        {"solves", animation.statistics.solves},
                        {"failedSolves", animation.statistics.failed_solves},
                        {"impacts", animation.statistics.impacts},
                        {"worstPenetration", animation.statistics.worst_penetration}};
  json["fps"] = animation.fps;
  json["frameCount"] = animation.frames.size();
  // The last frame is late where the duration is no multiple of the frames' distance, early where the motion stopped.
  json["duration"] = animation.frames.back().time - animation.frames.front().time;
  json["view"] = {view.low().x, view.low().y, view.high().x, view.high().y};
  json["bodySize"] = size;
  json["gravity"] = Point(world.loads.gravity);
  json["edgeStyles"] = Json::array();
  for (const EdgeStyle& style : kEdgeStyles) json["edgeStyles"].push_back({style.name, style.color});
  json["colors"] = {
      {"force", kForceColor}, {"ink", kInkColor}, {"body", kBodyFill}, {"fixed", kFixedFill}, {"driven", kDrivenFill}};
  json["bodies"] = Json::array();
  for (const Body& body : world.bodies) json["bodies"].push_back(BodyJson(body, 0.3 * size));
  json["connectors"] = ConnectorsJson(world);
  json["energy"] = EnergiesJson(animation);
  return json;
}

}  // namespace lcpbench
