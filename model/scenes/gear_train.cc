// gear-train: gears on pins, each in mesh with the next, driven by a motor.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 40;
constexpr double kModule = 0.04;  ///< pitch diameter over the number of teeth [m]
constexpr int kMinTeeth = 8;
constexpr int kMaxTeeth = 16;
// In modules.
constexpr double kAddendum = 0.9;
constexpr double kDedendum = 1.2;
constexpr double kFlankRadius = 2.6;
constexpr double kFootWidth = 1.3;  ///< of a tooth, along the root circle
constexpr double kTipWidth = 0.76;  ///< of a tooth, along the tip circle
constexpr double kRollerRadius = 0.5;
/// The line from a gear to the next is inclined by this, up and down in turn [rad].
constexpr Range kIncline{0.15, 0.55};
constexpr double kMaxSpeed = 1.5;  ///< of the motor's pitch circle, and at least half of it [m/s]
/// Candidates for a gear's place; the first whose ratio is within kRatioSlack of the motor's is taken.
constexpr int kCandidates = 8;
constexpr double kRatioSlack = 0.15;

/// A feature of a tooth's flank as contact sees it: an arc, or the tip corner as one of radius 0, in the body frame,
/// with the range of its normals (less than a half turn, counter-clockwise).
struct FlankFeature {
  Feature feature;
  Vec2 center;
  double radius = 0;
  Vec2 first_normal;
  Vec2 last_normal;
};

/// All gears of one number of teeth.
struct GearKind {
  int teeth = 0;
  double pitch_radius = 0;
  double tip_radius = 0;
  Body body;
  Vec2 axle;  ///< body frame
  /// By tooth; [0] flank and corner on its clockwise side, [1] on its counter-clockwise side.
  std::vector<std::array<std::array<FlankFeature, 2>, 2>> flanks;
};

FlankFeature FlankOf(const OutlineEdge& piece) {
  const auto& arc = std::get<ArcEdge>(piece.edge);
  return {arc, arc.center, arc.radius, Direction(piece.s_begin), Direction(piece.s_end)};
}

GearKind MakeGearKind(int teeth) {
  GearKind kind;
  kind.teeth = teeth;
  kind.pitch_radius = kModule * teeth / 2;
  kind.tip_radius = kind.pitch_radius + kAddendum * kModule;
  GearShape shape;
  shape.teeth = teeth;
  shape.root_radius = kind.pitch_radius - kDedendum * kModule;
  shape.tip_radius = kind.tip_radius;
  shape.tip_share = kTipWidth * kModule * teeth / (2 * kPi * shape.tip_radius);
  shape.foot_share = kFootWidth * kModule * teeth / (2 * kPi * shape.root_radius);
  shape.flank_radius = kFlankRadius * kModule;
  kind.body = MakePlate(Gear(shape), kDensity);
  // Pieces of a tooth: clockwise flank, tip land, counter-clockwise flank, root land.
  constexpr std::size_t kPieces = 4;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    const OutlineEdge* pieces = &kind.body.outline[kPieces * static_cast<std::size_t>(tooth)];
    const FlankFeature right = FlankOf(pieces[0]);
    const FlankFeature land = FlankOf(pieces[1]);
    const FlankFeature left = FlankOf(pieces[2]);
    kind.axle = land.center;
    const auto corner = [&](const FlankFeature& before, const FlankFeature& after) {
      const Vec2 p = after.center + after.radius * after.first_normal;
      return FlankFeature{Vertex{p}, p, 0, before.last_normal, after.first_normal};
    };
    kind.flanks.push_back({{{right, corner(right, land)}, {left, corner(land, left)}}});
  }
  return kind;
}

bool HasNormal(const FlankFeature& feature, Vec2 n) {
  return Cross(feature.first_normal, n) >= 0 && Cross(n, feature.last_normal) >= 0;
}

/// A meeting of two gears' teeth: the second gear's angle, and the features in contact.
struct Mesh {
  double theta = 0;
  double travel = std::numeric_limits<double>::infinity();  ///< rotation from the middle of the backlash [rad]
  Feature feature1;                                         ///< of the gear that was there
  Feature feature2;                                         ///< of the new gear
};

/// The rotations about the origin, two or none, that bring point b to that distance from point a: with the origin a
/// triangle of three known sides, so that the angle needs no search.
std::vector<Rotation> TurnsToDistance(Vec2 a, Vec2 b, double distance) {
  const double aa = Dot(a, a);
  const double bb = Dot(b, b);
  const double product = std::sqrt(aa * bb);
  const double cosine = (aa + bb - distance * distance) / (2 * product);
  if (std::abs(cosine) >= 1) return {};
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  // The unit complex number that turns b to the direction of a, turned further by the triangle's angle.
  const Rotation align{Dot(a, b) / product, Cross(b, a) / product};
  const auto turned = [&](double sign) -> Rotation {
    return {align.cos * cosine - sign * align.sin * sine, align.sin * cosine + sign * align.cos * sine};
  };
  return {turned(-1), turned(1)};
}

/// Where the flanks of a gear kind touch those of a placed gear when turned from the middle of the backlash, `side` 1
/// counter-clockwise, 0 clockwise: circles of radii r1, r2 with centres r1 + r2 apart.
std::optional<Mesh> FindMesh(const GearKind& kind1, const Body& gear1, const GearKind& kind2, Vec2 axle2,
                             std::size_t side) {
  const double line_angle = AngleOf(axle2 - WorldPoint(gear1, kind1.axle));
  const double pitch1 = 2 * kPi / kind1.teeth;
  const double pitch2 = 2 * kPi / kind2.teeth;
  const double nearest = std::round((line_angle - gear1.theta) / pitch1);
  const double off = gear1.theta + nearest * pitch1 - line_angle;
  // A gap of the new gear faces that tooth; in the frame of its tooth 0.
  const double middle = line_angle + kPi - off * kind1.teeth / kind2.teeth + pitch2 / 2;
  const Rotation turn1 = SinCos(gear1.theta);
  Mesh best;
  const auto consider = [&](const FlankFeature& feature1, const FlankFeature& feature2) {
    const Vec2 center1 = WorldPoint(gear1, feature1.center);
    const Vec2 b = feature2.center - kind2.axle;
    const double reach = feature1.radius + feature2.radius;
    for (const Rotation turn : TurnsToDistance(center1 - axle2, b, reach)) {
      const Vec2 n = (1 / reach) * (axle2 + Rotate(turn, b) - center1);
      if (!HasNormal(feature1, Rotate({turn1.cos, -turn1.sin}, n))) continue;
      if (!HasNormal(feature2, RotateBack(turn, -n))) continue;
      // All teeth of the new gear are alike: only the angle modulo its pitch counts.
      const double theta = AngleOf({turn.cos, turn.sin});
      const double from_middle = theta + std::round((middle - theta) / pitch2) * pitch2 - middle;
      const double travel = side == 1 ? from_middle : -from_middle;
      if (travel < best.travel) best = {theta, travel, feature1.feature, feature2.feature};
    }
  };
  for (int tooth = -2; tooth <= 2; ++tooth) {
    const int turns = kind1.teeth;
    const auto index = static_cast<std::size_t>(((static_cast<int>(nearest) + tooth) % turns + turns) % turns);
    for (const FlankFeature& feature1 : kind1.flanks[index][side]) {
      for (const FlankFeature& feature2 : kind2.flanks[0][side]) {
        if (feature1.radius > 0 || feature2.radius > 0) consider(feature1, feature2);
      }
    }
  }
  if (!std::isfinite(best.travel)) return std::nullopt;
  return best;
}

class GearTrain final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    frame_ = AddFixed("frame");
    AddMotor();
    for (int rollers = 0; rollers < rows_ % kRowsPerGear; ++rollers) AddRoller(rollers);
    for (int gear = 0; gear < rows_ / kRowsPerGear; ++gear) AddGear(gear % 2 == 0 ? 1 : -1);
    const double right = last_axle_.x + kFloorBeyond;
    Get(frame_).outline = {WholeEdge({right, kFloor}, {-kFloorBeyond, kFloor})};
  }

  /// With brakes: a torque against each gear's sense of rotation, up to that of its weight at the pitch circle.
  void Launch(World* world) override {
    for (std::size_t i = 0; i < world->bodies.size(); ++i) {
      const Body& body = world->bodies[i];
      if (body.fixed || body.omega == 0) continue;
      const double torque = body.mass * kGravity * kModule * random_.Uniform(0.2, 1);
      world->loads.wrenches.push_back({{static_cast<int>(i), {}}, {}, body.omega > 0 ? -torque : torque});
    }
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = 2 * kGravity});
    LoadEnds(&system_);
  }

 private:
  static constexpr int kRowsPerGear = 3;
  static constexpr double kFloor = -2;
  static constexpr double kFloorBeyond = 5;  // rollers fall off and roll away

  const GearKind& DrawKind() {
    // Checking a gear's outline takes longer than placing a hundred gears.
    static const std::vector<GearKind> kinds = [] {
      std::vector<GearKind> all;
      for (int teeth = kMinTeeth; teeth <= kMaxTeeth; ++teeth) all.push_back(MakeGearKind(teeth));
      return all;
    }();
    return kinds[static_cast<std::size_t>(random_.Integer(0, kMaxTeeth - kMinTeeth))];
  }
  const Body& Last() const { return Get(last_); }

  void AddMotor() {
    last_kind_ = &DrawKind();
    Body motor = last_kind_->body;
    motor.name = "motor";
    motor.fixed = true;
    motor.theta = random_.Uniform(0, 2 * kPi);
    const double sense = random_.Sign();
    pitch_speed_ = sense * random_.Uniform(kMaxSpeed / 2, kMaxSpeed);
    motor.omega = pitch_speed_ / last_kind_->pitch_radius;
    last_ = Add("motor", motor);
    last_axle_ = WorldPoint(motor, last_kind_->axle);
  }

  /// On the tip land of a tooth on the motor's upper side, `index` teeth away from the top one: the land's normals pass
  /// through the axle, so that the roller may have the land's own velocity.
  void AddRoller(int index) {
    const Body motor = Last();
    const double pitch = 2 * kPi / last_kind_->teeth;
    const double top = std::round((kPi / 2 - motor.theta) / pitch);
    const int tooth = (static_cast<int>(top) + index + 2 * last_kind_->teeth) % last_kind_->teeth;
    const OutlineEdge& land = motor.outline[4 * static_cast<std::size_t>(tooth) + 1];
    const double radius = kRollerRadius * kModule;
    const Vec2 direction = Direction(motor.theta + (land.s_begin + land.s_end) / 2);
    Body roller = MakeDisc(last_axle_ + (last_kind_->tip_radius + radius) * direction, radius, kDensity);
    roller.v = VelocityAt(motor, last_axle_ + last_kind_->tip_radius * direction);
    Touch(Add("roller", roller), last_, ToFeature(land.edge));
  }

  void AddGear(double up) {
    ContactSystem best;
    double best_error = std::numeric_limits<double>::infinity();
    const GearKind* best_kind = nullptr;
    Vec2 best_axle;
    // A candidate is tried on a system of the two gears alone.
    for (int k = 0; k < kCandidates && best_error > kRatioSlack; ++k) {
      const GearKind& kind = DrawKind();
      const double incline = up * random_.Uniform(kIncline);
      const std::size_t side = random_.Uniform() < 0.5 ? 0 : 1;
      const Vec2 axle = last_axle_ + (last_kind_->pitch_radius + kind.pitch_radius) * Direction(incline);
      const std::optional<Mesh> mesh = FindMesh(*last_kind_, Last(), kind, axle, side);
      if (!mesh) continue;
      ContactSystem pair;
      pair.bodies = {Last(), kind.body};
      Body& gear = pair.bodies[1];
      gear.theta = mesh->theta;
      gear.x = axle - Rotate(SinCos(gear.theta), kind.axle);
      AddConstraint(&pair, ConstraintType::kContact, 1, mesh->feature2, 0, mesh->feature1);
      gear.omega = StillVelocity(pair, 2);
      // The axle is the centre of mass but for rounding.
      gear.v = -gear.omega * Perp(Rotate(SinCos(gear.theta), kind.axle));
      const double error = std::abs(std::abs(gear.omega * kind.pitch_radius / pitch_speed_) - 1);
      if (error >= best_error) continue;
      best = std::move(pair);
      best_error = error;
      best_kind = &kind;
      best_axle = axle;
    }
    const int gear = Add("gear", best.bodies[1]);
    Join(ConstraintType::kPin, gear, best_kind->axle, frame_, Vertex{best_axle});
    Touch(gear, best.constraints[0].feature1, last_, best.constraints[0].feature2);
    last_ = gear;
    last_kind_ = best_kind;
    last_axle_ = best_axle;
  }

  int frame_ = -1;
  int last_ = -1;
  const GearKind* last_kind_ = nullptr;
  Vec2 last_axle_;
  double pitch_speed_ = 0;
};

}  // namespace

extern const SceneFamily kGearTrain{
    "gear-train", "Train of gears on pins driven by a motor",
    "Two bilateral rows for every tooth contact, on flanks at random: tells methods that eliminate joints "
    "from those that carry them along, with gamma from turning arcs in every row.",
    &Make<GearTrain>};

}  // namespace lcpbench
