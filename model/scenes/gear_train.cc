// gear-train: gears on pins, each in mesh with the next, driven by a motor.
//
// k gears make 3 k rows; what is missing is closed by rollers on the motor's teeth, one row each. Gears turn at the
// speeds at which their teeth stay in contact, and are placed where the ratios deviate least from those of the counts
// of teeth, so that they do not drift along a long train.
//
// In motion: the motor turns at constant speed, brakes of different strength resist every gear, and gears rattle
// through their backlash.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/geometry/trig.h"
#include "model/scenes/scene_builder.h"
#include "model/shape/mass_properties.h"
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
  kind.body = MakeBody(Gear(shape), kDensity);
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

/// Where the flanks of a gear kind touch those of a placed gear when turned from the middle of the backlash, `side` 1
/// counter-clockwise, 0 clockwise. Circles of radii r1, r2 touch where their centres are r1 + r2 apart: with the new
/// gear's centre that is a triangle of three known sides, so that the angle needs no search.
class MeshSearch {
 public:
  MeshSearch(const GearKind& kind1, const Body& gear1, const GearKind& kind2, Vec2 axle2, std::size_t side)
      : kind1_(kind1), gear1_(gear1), kind2_(kind2), axle2_(axle2), side_(side), turn1_(SinCos(gear1.theta)) {}

  std::optional<Mesh> Run() {
    const Vec2 line = axle2_ - WorldPoint(gear1_, kind1_.axle);
    const double line_angle = AngleOf(line);
    const double pitch1 = 2 * kPi / kind1_.teeth;
    const double pitch2 = 2 * kPi / kind2_.teeth;
    const double nearest = std::round((line_angle - gear1_.theta) / pitch1);
    const double off = gear1_.theta + nearest * pitch1 - line_angle;
    // A gap of the new gear faces that tooth; in the frame of its tooth 0.
    middle_ = line_angle + kPi - off * kind1_.teeth / kind2_.teeth + pitch2 / 2;
    for (int tooth = -2; tooth <= 2; ++tooth) {
      const int turns = kind1_.teeth;
      const auto index = static_cast<std::size_t>(((static_cast<int>(nearest) + tooth) % turns + turns) % turns);
      for (const FlankFeature& feature1 : kind1_.flanks[index][side_]) {
        for (const FlankFeature& feature2 : kind2_.flanks[0][side_]) {
          if (feature1.radius > 0 || feature2.radius > 0) Try(feature1, feature2);
        }
      }
    }
    if (!std::isfinite(best_.travel)) return std::nullopt;
    return best_;
  }

 private:
  void Try(const FlankFeature& feature1, const FlankFeature& feature2) {
    const Vec2 center1 = WorldPoint(gear1_, feature1.center);
    const Vec2 a = center1 - axle2_;
    const Vec2 b = feature2.center - kind2_.axle;
    const double reach = feature1.radius + feature2.radius;
    const double aa = Dot(a, a);
    const double bb = Dot(b, b);
    const double product = std::sqrt(aa * bb);
    const double cosine = (aa + bb - reach * reach) / (2 * product);
    if (std::abs(cosine) >= 1) return;
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double sign : {-1.0, 1.0}) {
      // The unit complex number that turns b to the direction of a, turned further by the triangle's angle.
      const Rotation align{Dot(a, b) / product, Cross(b, a) / product};
      const Rotation turn{align.cos * cosine - sign * align.sin * sine, align.sin * cosine + sign * align.cos * sine};
      const Vec2 n = (1 / reach) * (axle2_ + Rotate(turn, b) - center1);
      if (!HasNormal(feature1, Rotate({turn1_.cos, -turn1_.sin}, n))) continue;
      if (!HasNormal(feature2, Rotate({turn.cos, -turn.sin}, -n))) continue;
      Keep(AngleOf({turn.cos, turn.sin}), feature1, feature2);
    }
  }

  /// All teeth of the new gear are alike: only the angle modulo its pitch counts.
  void Keep(double theta, const FlankFeature& feature1, const FlankFeature& feature2) {
    const double pitch2 = 2 * kPi / kind2_.teeth;
    const double teeth_off = std::round((middle_ - theta) / pitch2);
    const double from_middle = theta + teeth_off * pitch2 - middle_;
    const double travel = side_ == 1 ? from_middle : -from_middle;
    if (travel < best_.travel) best_ = {theta, travel, feature1.feature, feature2.feature};
  }

  const GearKind& kind1_;
  const Body& gear1_;
  const GearKind& kind2_;
  Vec2 axle2_;
  std::size_t side_;
  Rotation turn1_;
  double middle_ = 0;
  Mesh best_;
};

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
      const std::optional<Mesh> mesh = MeshSearch(*last_kind_, Last(), kind, axle, side).Run();
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
    best.bodies[1].name.clear();
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
    "gear-train",
    "Train of gears on pins driven by a motor",
    "Two bilateral rows for every tooth contact, on flanks at random: tells methods that eliminate joints "
    "from those that carry them along, with gamma from turning arcs in every row.",
    &Make<GearTrain>,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
