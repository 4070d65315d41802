// newtons-cradle: a row of pendulums that touch.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kLength = 1;  ///< of all pendulums [m]
constexpr Range kRadius{0.08, 0.12};
constexpr Range kDensity{50, 150};   ///< [kg/m^2]
constexpr double kMaxAngle = 0.25;   ///< from the vertical, common to all [rad]
constexpr double kMaxSpeed = 1;      ///< common to all [rad/s]
constexpr double kArmShare = 0.15;   ///< of rigid arms among the pendulums
constexpr double kRopeShare = 0.8;   ///< of ropes among the others
constexpr double kBeamHeight = 0.1;  ///< [m]
// In motion.
constexpr double kGapShare = 1e-4;   ///< of a ball's radius
constexpr double kLiftAngle = 0.5;   ///< [rad]
constexpr double kBallRadius = 0.1;  ///< [m]
constexpr double kBallDensity = 100;

/// The numbers of balls and of rigid arms, 2 balls - 1 + arms = rows.
struct Counts {
  int balls;
  int arms;
};

Counts CountsFor(int rows) {
  int arms = static_cast<int>(kArmShare * rows / 2);
  // 2 balls = rows + 1 - arms.
  if ((rows + 1 - arms) % 2 != 0) ++arms;
  return {(rows + 1 - arms) / 2, arms};
}

/// `arms` of `balls` places, all sets with the same probability.
std::vector<bool> DrawArms(const Counts& counts, Random* random) {
  std::vector<bool> is_arm;
  int arms = counts.arms;
  for (int left = counts.balls; left > 0; --left) {
    is_arm.push_back(random->Integer(left) < arms);
    if (is_arm.back()) --arms;
  }
  return is_arm;
}

class Cradle final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const Counts counts = CountsFor(rows_);
    const std::vector<bool> is_arm = DrawArms(counts, &random_);
    const Rotation angle = SinCos(random_.Uniform(-kMaxAngle, kMaxAngle));
    const Vec2 hang = kLength * Vec2{angle.sin, -angle.cos};
    const double speed = random_.Uniform(-kMaxSpeed, kMaxSpeed);
    beam_ = AddFixed("beam");

    double x = 0;
    double last_radius = 0;
    for (int k = 0; k < counts.balls; ++k) {
      const double radius = random_.Uniform(kRadius);
      const double density = random_.Uniform(kDensity);
      const bool rope = random_.Uniform() < kRopeShare;
      if (k > 0) x += last_radius + radius;
      last_radius = radius;
      const bool arm = is_arm[static_cast<std::size_t>(k)];
      Body body = MakeDisc(Vec2{x, 0} + hang, radius, density);
      body.v = speed * Perp(hang);
      if (arm) body.omega = speed;
      const int ball = Add("ball", body);
      Hang(ball, {x, 0}, arm ? ConstraintType::kPin : (rope ? ConstraintType::kRope : ConstraintType::kRod));
      if (k > 0) Touch(ball, ball - 1);
    }
    DrawBeam(x);
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = 2.5 * kGravity});
    LoadEnds(&system_);
  }

  void BuildMoving() override {
    const Counts counts = CountsFor(rows_);
    const std::vector<bool> is_arm = DrawArms(counts, &random_);
    const int lifted = counts.balls > 2 ? 1 + random_.Integer(2) : 1;
    const double spacing = 2 * kBallRadius * (1 + kGapShare / 2);
    const Rotation lift = SinCos(-kLiftAngle);
    beam_ = AddFixed("beam");
    for (int k = 0; k < counts.balls; ++k) {
      const Vec2 anchor{k * spacing, 0};
      const Vec2 hang = kLength * (k < lifted ? Vec2{lift.sin, -lift.cos} : Vec2{0, -1});
      const int ball = Add("ball", MakeDisc(anchor + hang, kBallRadius, kBallDensity));
      Hang(ball, anchor, is_arm[static_cast<std::size_t>(k)] ? ConstraintType::kPin : ConstraintType::kRod);
    }
    DrawBeam((counts.balls - 1) * spacing);
  }

 private:
  /// On a rod or rope from its middle, or a rigid arm: a pin at the anchor.
  void Hang(int ball, Vec2 anchor, ConstraintType type) {
    const Vec2 p = type == ConstraintType::kPin ? BodyPoint(Get(ball), anchor) : Vec2{};
    Join(type, ball, p, beam_, Vertex{anchor});
  }

  /// From the first anchor, at 0, to the last and beyond.
  void DrawBeam(double last) {
    constexpr double kBeyond = 2 * kRadius.high;
    Get(beam_).outline = Sides({-kBeyond, 0}, {last + kBeyond, kBeamHeight});
  }

  int beam_ = -1;
};

}  // namespace

extern const SceneFamily kNewtonsCradle{
    "newtons-cradle",
    "Row of touching pendulums on rods, ropes and arms",
    "Squeezed balls form blocks as long as the row, and ropes go slack: tells methods that pass pushes on "
    "one neighbour a sweep from those that solve at once.",
    &Make<Cradle>,
    MotionLevel::kAcceleration,
    1e-2,
    1};

}  // namespace lcpbench
