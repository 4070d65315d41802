#include "benchmarks/drawing/animation_data.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include "benchmarks/drawing/picture_layout.h"
#include "model/detection/detection.h"
#include "model/scenes/parts.h"

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

/// What does not change in a recorded motion: name, caption, statistics, colours, the view that holds most of the
/// motion [m], every body's outline once (paths of SVG in the body frame, y up, `unit` path units per metre),
/// connectors between bodies, and the frames' energies. O(bodies + frames).
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

constexpr double kLevels = 65535;

/// An interval in 16 bits: value = offset + step word.
class Quantiser {
 public:
  /// @param least_step  finer steps would not be seen, and would only make the page larger
  explicit Quantiser(double least_step = 0) : least_step_(least_step) {}

  void Include(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  std::uint16_t operator()(double value) const {
    return step() > 0 ? static_cast<std::uint16_t>(std::lround(std::clamp((value - low_) / step(), 0.0, kLevels))) : 0;
  }
  double offset() const { return low_ <= high_ ? low_ : 0; }
  double step() const { return low_ < high_ ? std::max((high_ - low_) / kLevels, least_step_) : 0; }

 private:
  double least_step_;
  double low_ = 1e300;
  double high_ = -1e300;
};

std::uint16_t AngleWord(double theta) {
  const double turns = theta / (2 * kPi);
  return static_cast<std::uint16_t>(std::lround((turns - std::floor(turns)) * 65536) & 0xFFFF);
}

class Words {
 public:
  void Add(unsigned word) { words_.push_back(static_cast<std::uint16_t>(word & 0xFFFFU)); }

  /// Smooth in time: second differences are small.
  void AddTrack(const std::vector<std::uint16_t>& track) {
    unsigned before = 0;
    unsigned slope = 0;
    for (const unsigned word : track) {
      Add(word - before - slope);
      slope = word - before;
      before = word;
    }
  }

  std::string Packed() const {
    std::string bytes;
    bytes.reserve(2 * words_.size());
    for (const unsigned shift : {0U, 8U}) {
      for (const unsigned word : words_) bytes.push_back(static_cast<char>((word >> shift) & 0xFFU));
    }
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_DEFAULT_COMPRESSION);
    if (status != Z_OK) throw std::runtime_error("zlib cannot compress the animation's frames");
    packed.resize(size);
    return packed;
  }

 private:
  std::vector<std::uint16_t> words_;
};

/// Lists of `width` numbers each, one list a frame, by columns.
/// @param least_steps  of the columns, as Quantiser
template <std::size_t width>
Json AddLists(const std::vector<std::vector<std::array<double, width>>>& frames,
              const std::array<double, width>& least_steps, Words* words) {
  std::vector<Quantiser> quantisers(least_steps.begin(), least_steps.end());
  for (const auto& list : frames) {
    for (const auto& element : list) {
      for (std::size_t c = 0; c < width; ++c) quantisers[c].Include(element[c]);
    }
  }
  for (const auto& list : frames) words->Add(static_cast<unsigned>(list.size()));
  Json columns = Json::array();
  for (std::size_t c = 0; c < width; ++c) {
    std::vector<std::uint16_t> before;
    for (const auto& list : frames) {
      std::vector<std::uint16_t> now;
      now.reserve(list.size());
      for (std::size_t i = 0; i < list.size(); ++i) {
        now.push_back(quantisers[c](list[i][c]));
        words->Add(static_cast<unsigned>(now[i]) - (i < before.size() ? before[i] : 0U));
      }
      before = std::move(now);
    }
    columns.push_back({quantisers[c].offset(), quantisers[c].step()});
  }
  return columns;
}

/// The largest of the frame's, in their own order, if there are more than a count of 16 bits can say.
template <class Element, class Size>
std::vector<Element> Strongest(std::vector<Element> all, double faint, Size size) {
  constexpr std::size_t kMost = 65535;
  std::erase_if(all, [&](const Element& element) { return size(element) < faint; });
  if (all.size() <= kMost) return all;
  std::vector<double> sizes;
  sizes.reserve(all.size());
  for (const Element& element : all) sizes.push_back(size(element));
  std::nth_element(sizes.begin(), sizes.begin() + kMost, sizes.end(), std::greater<>());
  const double least = sizes[kMost];
  std::erase_if(all, [&](const Element& element) { return size(element) <= least; });
  return all;
}

void AddTracks(const Animation& animation, Json* bodies, Words* words) {
  const std::size_t frames = animation.frames.size();
  std::vector<std::uint16_t> track(frames);
  for (std::size_t i = 0; i < animation.world.bodies.size(); ++i) {
    Quantiser x;
    Quantiser y;
    bool turns = false;
    for (const AnimationFrame& frame : animation.frames) {
      x.Include(frame.poses[i].x.x);
      y.Include(frame.poses[i].x.y);
      turns = turns || frame.poses[i].theta != animation.frames.front().poses[i].theta;
    }
    if (x.step() == 0 && y.step() == 0 && !turns) continue;
    (*bodies)[i]["track"] = {x.offset(), x.step(), y.offset(), y.step()};
    const auto add = [&](auto word) {
      for (std::size_t k = 0; k < frames; ++k) track[k] = word(animation.frames[k].poses[i]);
      words->AddTrack(track);
    };
    add([&](const BodyPose& pose) { return x(pose.x.x); });
    add([&](const BodyPose& pose) { return y(pose.x.y); });
    add([&](const BodyPose& pose) { return AngleWord(pose.theta); });
  }
}

void AddForces(const Animation& animation, Json* scene, Words* words) {
  const auto size = [](const AnimationForce& force) { return Norm(force.force); };
  std::vector<double> sizes;
  double largest_impulse = 0;
  for (const AnimationFrame& frame : animation.frames) {
    for (const AnimationForce& force : frame.forces) sizes.push_back(size(force));
    for (const AnimationImpact& impact : frame.impacts) largest_impulse = std::max(largest_impulse, impact.impulse);
  }
  const double largest = sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end());
  double typical = largest;
  if (!sizes.empty()) {
    // What all but a few largest stay below: spikes shall not make the others invisible.
    const auto nth = sizes.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), nth, sizes.end());
    typical = *nth;
  }
  std::vector<std::vector<std::array<double, 4>>> forces;
  std::vector<std::vector<std::array<double, 3>>> impacts;
  for (const AnimationFrame& frame : animation.frames) {
    forces.emplace_back();
    for (const AnimationForce& force : Strongest(frame.forces, kFaintForce * typical, size)) {
      forces.back().push_back({force.at.x, force.at.y, force.force.x, force.force.y});
    }
    impacts.emplace_back();
    const auto impulse = [](const AnimationImpact& impact) { return impact.impulse; };
    for (const AnimationImpact& impact : Strongest(frame.impacts, kFaintForce * largest_impulse, impulse)) {
      impacts.back().push_back({impact.at.x, impact.at.y, impact.impulse});
    }
  }
  const double place = kVisiblePlace * (*scene)["bodySize"].get<double>();
  const double force = kVisibleForce * typical;
  (*scene)["forces"] = AddLists<4>(forces, {place, place, force, force}, words);
  (*scene)["impacts"] = AddLists<3>(impacts, {place, place, kVisibleForce * largest_impulse}, words);
  (*scene)["typicalForce"] = typical;
  (*scene)["largestImpulse"] = largest_impulse;
}

}  // namespace

AnimationData PackAnimation(const Animation& animation) {
  AnimationData data;
  data.scene = SceneJson(animation);
  Words words;
  AddTracks(animation, &data.scene["bodies"], &words);
  AddForces(animation, &data.scene, &words);
  data.frames = Base64(words.Packed());
  return data;
}

std::string Base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    const std::size_t digits = std::min<std::size_t>(3, bytes.size() - i) + 1;
    for (std::size_t k = 0; k < 4; ++k) text += k < digits ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace lcpbench
