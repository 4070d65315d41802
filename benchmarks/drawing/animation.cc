#include "benchmarks/drawing/animation.h"

#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <utility>
#include <vector>

#include "animation_template.h"
#include "benchmarks/drawing/svg.h"
#include "benchmarks/measure/budget_clock.h"
#include "model/contact/loads.h"
#include "model/scenes/parts.h"
#include "support/cancellation.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// Listens to a motion between two frames.
class Listener {
 public:
  using TwoKinds = std::array<std::vector<DrawnForce>, 2>;  ///< forces and cones

  void operator()(const MotionProblem& problem) {
    if (problem.kind == MotionProblemKind::kImpact) {
      NoteImpact(problem);
    } else {
      FinishStep(problem.time);
      begun_ = true;
      begin_ = problem.time;
      const Eigen::VectorXd& f = problem.result.f;
      std::vector<bool> slides;
      if (!problem.problem.is_plain() && f.allFinite()) {
        Eigen::VectorXd w;
        problem.problem.ComputeW(f, &w);
        slides = SlidingRows(problem.problem, f, w);
      }
      forces_[0] = ForcesOf(problem.system, problem.rows, f, slides);
      forces_[1].clear();
      for (const DrawnCone& cone : ConesOf(problem.system, problem.rows, f)) {
        for (const Vec2 side : cone.sides) forces_[1].push_back({cone.at, side});
      }
      impulses_ = problem.kind == MotionProblemKind::kTimeStep;
    }
  }

  /// The step that was noted last ended at `time`: its impulses are known as forces now.
  void FinishStep(double time) {
    if (!begun_) return;
    const double h = time - begin_;
    if (impulses_ && h > 0) {
      for (auto& forces : forces_) {
        for (DrawnForce& force : forces) force.force = (1 / h) * force.force;
      }
    }
    if (!first_known_) first_ = forces_;
    first_known_ = true;
    impulses_ = false;
  }

  const TwoKinds& first() const { return first_; }
  const TwoKinds& last() const { return forces_; }
  std::vector<DrawnForce> TakeImpacts() { return std::exchange(impacts_, {}); }

 private:
  void NoteImpact(const MotionProblem& problem) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
      const double p = problem.result.f[static_cast<Index>(i)];
      if (!problem.rows[i].bilateral && std::isfinite(p) && p > 0) {
        impacts_.push_back({PlaceOf(problem.system, problem.rows[i]), p * problem.rows[i].n});
      }
    }
  }

  bool begun_ = false;
  double begin_ = 0;
  bool impulses_ = false;  // forces_ holds impulses still
  TwoKinds forces_;
  bool first_known_ = false;
  TwoKinds first_;
  std::vector<DrawnForce> impacts_;
};

double FrameCount(const AnimationOptions& options) { return std::ceil(options.duration * options.fps - 1e-9); }

AnimationFrame FrameOf(const Motion& motion) {
  AnimationFrame frame;
  frame.time = motion.time();
  const World& world = motion.world();
  frame.poses.reserve(world.bodies.size());
  for (const Body& body : world.bodies) frame.poses.push_back({body.x, body.theta});
  frame.kinetic = KineticEnergy(world.bodies);
  frame.potential = PotentialEnergy(world.loads, world.bodies);
  return frame;
}

using Json = nlohmann::ordered_json;

/// A path's coordinates have two decimals: this many units across are enough for any zoom.
constexpr double kUnitsAcross = 4000;
/// Arrows of the largest usual force are so many times as long as bodies; rare ones may be kArrowCut times longer, then
/// they are cut.
constexpr double kArrowBodies = 1.3;
constexpr double kArrowCut = 3;
/// In a frame: what a count of 16 bits can say.
constexpr std::size_t kMostForces = 65535;

Json Pair(Vec2 p) { return {p.x, p.y}; }

/// Path units per metre.
double UnitOf(const Body& upright) {
  const double extent = ExtentOf(BoundsOf(upright));
  return extent > 0 ? kUnitsAcross / extent : kUnitsAcross;
}

/// @param band  depth of the hatching of unbounded bodies [m]
Json BodyJson(const Body& body, double band) {
  Json json = {{"name", body.name}, {"kind", body.fixed ? (IsDriven(body) ? "driven" : "fixed") : "movable"}};
  json["pose"] = {body.x.x, body.x.y, body.theta};
  if (body.outline.empty()) return json;
  Body upright = body;
  upright.x = {};
  upright.theta = 0;
  const double unit = UnitOf(upright);
  const Bounds bounds = BoundsOf(upright);
  const BodyPaths paths = PathsOf(body, unit, band * unit);
  json["unit"] = unit;
  json["radius"] = bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).norm();
  json["fill"] = paths.fill;
  json["edges"] = Json::array();
  for (std::size_t kind = 0; kind < paths.edges.size(); ++kind) {
    if (!paths.edges[kind].empty()) json["edges"].push_back({kEdgeStyles[kind].color, paths.edges[kind]});
  }
  return json;
}

Json ConnectorJson(const Connector& connector) {
  Json json = {{"type", connector.type},   {"a", connector.end1.body},        {"p", Pair(connector.end1.point)},
               {"b", connector.end2.body}, {"q", Pair(connector.end2.point)}, {"length", connector.length},
               {"side", connector.side}};
  if (connector.path.empty()) return json;
  Body carrier;
  carrier.outline = connector.path;
  json["unit"] = UnitOf(carrier);
  json["path"] = PiecesPath(connector.path, UnitOf(carrier));
  return json;
}

/// The start, and from there on every body that has not left for good: what flies far away shall not shrink the rest.
Bounds MotionView(const Animation& animation, const std::vector<Bounds>& bounds) {
  const std::vector<Body>& bodies = animation.world.bodies;
  Bounds view = ViewOf(bodies, bounds, {});
  const double far = 0.6 * ExtentOf(view);
  const Bounds near(view.min().array() - far, view.max().array() + far);
  for (const AnimationFrame& frame : animation.frames) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Eigen::Vector2d x = PointOf(frame.poses[i].x);
      const double reach = ExtentOf(bounds[i]) / 2;
      if (!bodies[i].fixed && near.contains(x)) view.extend(Bounds(x.array() - reach, x.array() + reach));
    }
  }
  return view;
}

/// What does not change in a recorded motion: name, caption, statistics, colours, the view that holds most of the
/// motion [m], every body's outline once (paths of SVG in the body frame, y up, `unit` path units per metre),
/// connectors between bodies, and the frames' energies. O(bodies + frames).
Json SceneJson(const Animation& animation, const std::vector<Connector>& connectors) {
  const World& world = animation.world;
  const std::vector<Bounds> bounds = BoundsOf(world.bodies);
  const Bounds view = MotionView(animation, bounds);
  const double median = MedianExtent(world.bodies, bounds);
  const double size = median > 0 ? median : std::max(ExtentOf(view) / 10, 1e-9);

  Json json = {{"name", world.name}, {"caption", animation.caption}, {"stopped", animation.stopped}};
  json["statistics"] = {{"steps", animation.statistics.steps},
                        {"solves", animation.statistics.solves},
                        {"failedSolves", animation.statistics.failed_solves},
                        {"impacts", animation.statistics.impacts},
                        {"worstPenetration", animation.statistics.worst_penetration}};
  json["fps"] = animation.fps;
  json["frameCount"] = animation.frames.size();
  // The last frame is late where frames do not divide the duration, and early where the motion stopped.
  json["duration"] = animation.frames.back().time - animation.frames.front().time;
  json["view"] = {view.min().x(), view.min().y(), view.max().x(), view.max().y()};
  json["bodySize"] = size;
  json["colors"] = {{"force", kForceColor},  {"slide", kSlideColor}, {"cone", kConeColor},  {"ink", kInkColor},
                    {"soft", kSoftInkColor}, {"body", kBodyFill},    {"fixed", kFixedFill}, {"driven", kDrivenFill}};
  json["bodies"] = Json::array();
  for (const Body& body : world.bodies) json["bodies"].push_back(BodyJson(body, 0.3 * size));
  json["connectors"] = Json::array();
  json["symbols"] = Json::object();
  for (const Connector& connector : connectors) {
    json["connectors"].push_back(ConnectorJson(connector));
    Json& symbol = json["symbols"][std::string(connector.type)] = Json::array();
    for (const auto& [along, across, down] : SymbolOf(connector.type)) symbol.push_back({along, across, down});
  }
  json["energy"] = {{"kinetic", Json::array()}, {"potential", Json::array()}};
  for (const AnimationFrame& frame : animation.frames) {
    json["energy"]["kinetic"].push_back(frame.kinetic);
    json["energy"]["potential"].push_back(frame.potential);
  }
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

using Forces = std::vector<std::vector<DrawnForce>>;  // by frame

/// All frames' lists of at, at, force, force, by columns.
/// @param place, force  finer steps than these are not wanted (Quantiser)
Json AddLists(const Forces& frames, double place, double force, Words* words) {
  const auto column = [](const DrawnForce& of, std::size_t c) {
    return std::array{of.at.x, of.at.y, of.force.x, of.force.y}[c];
  };
  for (const auto& list : frames) words->Add(static_cast<unsigned>(list.size()));
  Json columns = Json::array();
  for (std::size_t c = 0; c < 4; ++c) {
    Quantiser quantiser(c < 2 ? place : force);
    for (const auto& list : frames) {
      for (const DrawnForce& element : list) quantiser.Include(column(element, c));
    }
    std::vector<std::uint16_t> before;
    for (const auto& list : frames) {
      std::vector<std::uint16_t> now;
      now.reserve(list.size());
      for (std::size_t i = 0; i < list.size(); ++i) {
        now.push_back(quantiser(column(list[i], c)));
        words->Add(static_cast<unsigned>(now[i]) - (i < before.size() ? before[i] : 0U));
      }
      before = std::move(now);
    }
    columns.push_back({quantiser.offset(), quantiser.step()});
  }
  return columns;
}

/// The size that `share` of the forces stay below; 0 without any.
double SizeOfShare(const Forces& frames, double share) {
  std::vector<double> sizes;
  for (const auto& list : frames) {
    for (const DrawnForce& each : list) sizes.push_back(Norm(each.force));
  }
  if (sizes.empty()) return 0;
  const auto nth = sizes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), nth, sizes.end());
  return *nth;
}

void AddForces(const Animation& animation, Json* scene, Words* words) {
  const auto bodies = (*scene)["bodySize"].get<double>();
  // Forces by what all but a few largest stay below: spikes shall not make the others invisible.
  const auto lists = [&](std::vector<DrawnForce> AnimationFrame::*list) {
    Forces frames;
    for (const AnimationFrame& frame : animation.frames) frames.push_back(frame.*list);
    return frames;
  };
  const auto add = [&](const char* name, Forces frames, double size, const auto& shown) {
    for (auto& forces : frames) {
      std::erase_if(forces, [&](const DrawnForce& each) { return !shown(each); });
      forces.resize(std::min(forces.size(), kMostForces));
    }
    (*scene)[name] = AddLists(frames, kVisiblePlace * bodies, kVisibleForce * size, words);
  };
  const Forces forces = lists(&AnimationFrame::forces);
  const Forces impacts = lists(&AnimationFrame::impacts);
  const double typical = SizeOfShare(forces, 0.98);
  const double largest_impulse = SizeOfShare(impacts, 1);
  const auto is_seen = [](const DrawnForce& each, double size) { return Norm(each.force) >= kFaintForce * size; };
  for (const bool slides : {false, true}) {
    add(slides ? "slides" : "forces", forces, typical,
        [&](const DrawnForce& each) { return each.slides == slides && is_seen(each, typical); });
  }
  // Pairs stay pairs.
  add("cones", lists(&AnimationFrame::cones), typical, [](const DrawnForce&) { return true; });
  add("impacts", impacts, largest_impulse, [&](const DrawnForce& each) { return is_seen(each, largest_impulse); });
  const double arrow = kArrowBodies * bodies;  // [m]
  (*scene)["arrowPerNewton"] = typical > 0 ? arrow / typical : 0;
  (*scene)["longestArrow"] = kArrowCut * arrow;
  (*scene)["largestImpulse"] = largest_impulse;
}

Json LegendJson(const Json& scene, const Animation& animation, const std::vector<Connector>& connectors) {
  std::vector<LegendItem> items = LegendOf(animation.world.bodies, connectors);
  const auto per_newton = scene["arrowPerNewton"].get<double>();
  const auto longest = scene["longestArrow"].get<double>();
  const auto impulse = scene["largestImpulse"].get<double>();
  if (per_newton > 0) {
    items.push_back({34, SvgArrow({}, {34, 0}, 2.2, kForceColor),
                     "force: " + Short(longest / kArrowCut / per_newton) + " N are " + Short(longest / kArrowCut) +
                         " m long, at most " + Short(longest) + " m"});
  }
  const auto any = [&](const auto& has) { return std::any_of(animation.frames.begin(), animation.frames.end(), has); };
  if (any([](const AnimationFrame& frame) {
        return std::any_of(frame.forces.begin(), frame.forces.end(),
                           [](const DrawnForce& each) { return each.slides; });
      })) {
    items.push_back({34, SvgArrow({}, {34, 0}, 2.2, kSlideColor), "force of a contact that slides"});
  }
  if (any([](const AnimationFrame& frame) { return !frame.cones.empty(); })) items.push_back(ConeItem());
  if (impulse > 0) {
    items.push_back({12, SvgCircle({6, 0}, 5, {kForceColor, 1.5}), "impact, largest " + Short(impulse) + " N s"});
  }
  Json legend = Json::array();
  for (const auto& [width, symbol, text] : items) legend.push_back({width, symbol, text});
  return legend;
}

std::string Base64(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // with a zero at its end
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

}  // namespace

void RequireValid(const AnimationOptions& options) {
  if (!(options.duration > 0 && std::isfinite(options.duration))) throw InputError("--duration: expected seconds > 0");
  if (!(options.fps > 0 && std::isfinite(options.fps))) throw InputError("--fps: expected frames per second > 0");
  if (FrameCount(options) > kMaxFrames) throw InputError("--duration, --fps: expected at most 20000 frames");
}

Animation RecordAnimation(Motion* motion, const AnimationOptions& options,
                          const std::function<void(double)>& progress) {
  RequireValid(options);
  Animation animation;
  animation.world = motion->world();
  animation.fps = options.fps;
  Listener listener;
  const BudgetClock budget(options.budget_s);
  motion->set_check([&budget] {
    Cancellation::Check();
    budget.Check();
  });
  motion->set_observer([&listener](const MotionProblem& problem) { listener(problem); });
  const double start = motion->time();
  animation.frames.push_back(FrameOf(*motion));
  const int frames = static_cast<int>(FrameCount(options));
  for (int k = 1; k <= frames && motion->status() == MotionStatus::kMoving; ++k) {
    // From the start, so that rounding does not add up.
    try {
      motion->Advance(start + k / options.fps - motion->time());
    } catch (const BudgetSpent&) {
      animation.stopped = budget.Reason();
      break;
    }
    listener.FinishStep(motion->time());
    AnimationFrame frame = FrameOf(*motion);
    frame.forces = listener.last()[0];
    frame.cones = listener.last()[1];
    frame.impacts = listener.TakeImpacts();
    animation.frames.push_back(std::move(frame));
    if (progress) progress(static_cast<double>(k) / frames);
  }
  motion->set_observer({});
  motion->set_check([] {});
  animation.frames.front().forces = listener.first()[0];
  animation.frames.front().cones = listener.first()[1];
  animation.statistics = motion->statistics();
  if (motion->status() != MotionStatus::kMoving) animation.stopped = motion->detail();
  return animation;
}

AnimationData PackAnimation(const Animation& animation) {
  const std::vector<Connector> connectors = ConnectorsOf(animation.world.joints, &animation.world.loads);
  AnimationData data;
  data.scene = SceneJson(animation, connectors);
  Words words;
  AddTracks(animation, &data.scene["bodies"], &words);
  AddForces(animation, &data.scene, &words);
  data.scene["legend"] = LegendJson(data.scene, animation, connectors);
  data.frames = Base64(words.Packed());
  return data;
}

std::string RenderAnimationPage(const Animation& animation) {
  const AnimationData data = PackAnimation(animation);
  std::string page = kAnimationPage;
  for (const auto& [mark, text] : std::initializer_list<std::pair<const char*, std::string>>{
           {"{{style}}", kAnimationStyle},
           {"{{script}}", std::string(kAnimationData) + kAnimationDrawing + kAnimationPlot + kAnimationPlayer},
           {"{{frames}}", data.frames},
           {"{{scene}}", boost::algorithm::replace_all_copy(data.scene.dump(), "<", "\\u003c")},  // no "</script"
           {"{{title}}", Escape(animation.world.name)}}) {
    boost::algorithm::replace_all(page, mark, text);
  }
  return page;
}

}  // namespace lcpbench
