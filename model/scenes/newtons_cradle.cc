// newtons-cradle: a row of pendulums that touch.
//
// Balls of different radii and masses hang side by side from a beam, on rods (one bilateral row), ropes (one unilateral
// row) or rigid arms (a pin, two bilateral rows), and swing together, so that all have one velocity and touch at one
// height. Nothing but the neighbours stops a push, so that squeezed balls form blocks as long as the row itself, and a
// force depends on balls far away: tells methods that carry information one neighbour per sweep from those that solve
// at once. (Random pushes along a line of bodies leave few gaps: blocks merge until their accelerations increase along
// the row.) Gusts lift balls against their weight: it is mostly ropes that go slack. gamma is the centripetal term of
// the supports. J has full rank, and A is banded (Jacobi-scaled condition number 5e3 at 200 rows, 1e5 at 1000).
//
// Rows with w > 0 at the solution, of the unilateral rows, seeds 1 to 5: 12-33 % at 10 rows, 6-13 % at 100, 9-11 % at
// 1000, 9-12 % at 3000.
//
// k balls make 2 k - 1 rows, and one more for each rigid arm: their number sets the parity.
//
// In motion: equal balls on rods with small gaps, the first one or two lifted and let go. The gaps matter: touching
// balls under one common restitution give (-1/3, 2/3, 2/3) after the first impact, and not the row of impacts that
// sends off the last ball.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/geometry/trig.h"
#include "model/scenes/mechanism_parts.h"
#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "model/scenes/start.h"

namespace lcpbench {
namespace {

constexpr double kLength = 1;  ///< of all pendulums [m]
constexpr double kMinRadius = 0.08;
constexpr double kMaxRadius = 0.12;
constexpr double kMinDensity = 50;  ///< [kg/m^2]
constexpr double kMaxDensity = 150;
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

enum class Support { kRod, kRope, kArm };

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

void Hang(ContactSystem* system, int ball, int beam, Vec2 anchor, Support support) {
  switch (support) {
    case Support::kRod:
      AddRod(system, ball, {}, beam, anchor);
      break;
    case Support::kRope:
      AddRope(system, ball, {}, beam, anchor);
      break;
    case Support::kArm:
      AddPin(system, ball, BodyPoint(system->bodies[static_cast<std::size_t>(ball)], anchor), beam, anchor);
      break;
  }
}

void DrawBeam(Body* beam, double left, double right) {
  const Vec2 corner{right, kBeamHeight};
  beam->outline = {WholeEdge({left, 0}, {right, 0}), WholeEdge({right, 0}, corner), WholeEdge(corner, {left, corner.y}),
                   WholeEdge({left, corner.y}, {left, 0})};
}

ContactSystem Generate(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("newtons-cradle", rows, seed);
  const Counts counts = CountsFor(rows);
  const std::vector<bool> is_arm = DrawArms(counts, &random);
  const Rotation angle = SinCos(random.Uniform(-kMaxAngle, kMaxAngle));
  const Vec2 hang = kLength * Vec2{angle.sin, -angle.cos};
  const double speed = random.Uniform(-kMaxSpeed, kMaxSpeed);
  const int beam = AddBody(&system, "beam", MakeFixed("beam"));

  double x = 0;
  double last_radius = 0;
  for (int k = 0; k < counts.balls; ++k) {
    const double radius = random.Uniform(kMinRadius, kMaxRadius);
    const double density = random.Uniform(kMinDensity, kMaxDensity);
    const bool rope = random.Uniform() < kRopeShare;
    if (k > 0) x += last_radius + radius;
    last_radius = radius;
    const bool arm = is_arm[static_cast<std::size_t>(k)];
    Body body = MakeDisc(Vec2{x, 0} + hang, radius, density);
    body.v = speed * Perp(hang);
    if (arm) body.omega = speed;
    const int ball = AddBody(&system, "ball", body);
    Hang(&system, ball, beam, {x, 0}, arm ? Support::kArm : (rope ? Support::kRope : Support::kRod));
    if (k > 0) {
      const auto& previous = std::get<ArcEdge>(system.bodies[static_cast<std::size_t>(ball) - 1].outline[0].edge);
      AddContact(&system, ball, Circle(radius), ball - 1, previous);
    }
  }
  DrawBeam(&system.bodies[static_cast<std::size_t>(beam)], -2 * kMaxRadius, x + 2 * kMaxRadius);
  ApplyLoads(&system, {.weight = kGravity, .gust = 2.5 * kGravity}, &random);
  LoadEnds(&system);
  return system;
}

World Start(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("newtons-cradle", rows, seed);
  const Counts counts = CountsFor(rows);
  const std::vector<bool> is_arm = DrawArms(counts, &random);
  const int lifted = counts.balls > 2 ? 1 + random.Integer(2) : 1;
  const double spacing = 2 * kBallRadius * (1 + kGapShare / 2);
  const Rotation lift = SinCos(-kLiftAngle);
  const int beam = AddBody(&system, "beam", MakeFixed("beam"));
  for (int k = 0; k < counts.balls; ++k) {
    const Vec2 anchor{k * spacing, 0};
    const Vec2 hang = kLength * (k < lifted ? Vec2{lift.sin, -lift.cos} : Vec2{0, -1});
    const int ball = AddBody(&system, "ball", MakeDisc(anchor + hang, kBallRadius, kBallDensity));
    Hang(&system, ball, beam, anchor, is_arm[static_cast<std::size_t>(k)] ? Support::kArm : Support::kRod);
  }
  DrawBeam(&system.bodies[static_cast<std::size_t>(beam)], -2 * kMaxRadius,
           (counts.balls - 1) * spacing + 2 * kMaxRadius);
  return WorldUnderGravity(std::move(system), {0, -kGravity});
}

}  // namespace

extern const SceneFamily kNewtonsCradle{
    "newtons-cradle",
    "Row of touching pendulums on rods, ropes and arms",
    "Squeezed balls form blocks as long as the row, and ropes go slack: tells methods that pass pushes on "
    "one neighbour a sweep from those that solve at once.",
    &Generate,
    &Start,
    MotionLevel::kAcceleration,
    1e-2,
    1};

}  // namespace lcpbench
