// Pairs of involute gears, which keep a constant ratio of speeds: one gear turns, the other follows. While two pairs of
// teeth bear, their contacts meet, part and pass on at speeds of the flanks' fit, far below eps_v.

#include "model/contact/world.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

struct Mesh {
  int teeth1 = 20;
  int teeth2 = 30;
  double pressure_angle = 0.35;  // [rad]
  double contact_ratio = 1.6;
  double torque = 500;  // against the follower [N m]
};

constexpr double kModule = 0.1;  // [m]
constexpr int kPieces = 5;       // of a flank

/// A gear whose flanks are involutes of the roll angles begin..end, by cubic pieces of the same tangents.
struct InvoluteGear {
  double pitch_radius = 1;
  double base_radius = 0.9;
  double half_tooth = 0.1;  // at the base circle [rad]
  double begin = 0;
  double end = 1;
};

/// The clockwise flank of the tooth at `angle`, from root to tip; the other one mirrored, from tip to root.
void AddFlank(const InvoluteGear& gear, double angle, bool clockwise, std::vector<OutlineEdge>* outline) {
  const double h = (gear.end - gear.begin) / kPieces;
  const auto place = [&](Vec2 p) {
    p = Rotate(SinCos(-gear.half_tooth), p);
    return Rotate(SinCos(angle), clockwise ? p : Vec2{p.x, -p.y});
  };
  for (int k = 0; k < kPieces; ++k) {
    const auto control = [&](double t, double along) {
      return place(gear.base_radius * (Direction(t) + (-t) * Perp(Direction(t)) + (along * t) * Direction(t)));
    };
    const double t = gear.begin + h * (clockwise ? k : kPieces - 1 - k);
    std::array<Vec2, 4> P = {control(t, 0), control(t, h / 3), control(t + h, -h / 3), control(t + h, 0)};
    if (!clockwise) std::reverse(P.begin(), P.end());
    outline->push_back({BezierEdge{P}, 0, 1});
  }
}

/// Some teeth about the direction `facing`, the first of all at angle 0, and the root circle elsewhere.
std::vector<OutlineEdge> OutlineOfGear(const InvoluteGear& gear, int teeth, double facing) {
  const double pitch = 2 * kPi / teeth;
  const double root = gear.base_radius - 0.06;
  std::vector<OutlineEdge> outline;
  const auto arc = [&](double radius, double from, double to) {
    outline.push_back({ArcEdge{{}, radius, Side::kConvex}, from, to});
  };
  const double foot = gear.half_tooth - gear.begin + std::atan(gear.begin);
  const double land = gear.half_tooth - gear.end + std::atan(gear.end);
  const double foot_radius = gear.base_radius * std::sqrt(1 + gear.begin * gear.begin);
  const double tip_radius = gear.base_radius * std::sqrt(1 + gear.end * gear.end);
  constexpr int kTeeth = 5;
  const int first = static_cast<int>(std::lround(facing / pitch)) - kTeeth / 2;
  for (int k = first; k < first + kTeeth; ++k) {
    const double angle = k * pitch;
    const auto wall = [&](double side, double from, double to) {
      outline.push_back(WholeEdge(from * Direction(angle + side), to * Direction(angle + side)));
    };
    wall(-foot, root, foot_radius);
    AddFlank(gear, angle, true, &outline);
    arc(tip_radius, angle - land, angle + land);
    AddFlank(gear, angle, false, &outline);
    wall(foot, foot_radius, root);
    const bool last = k + 1 == first + kTeeth;
    arc(root, angle + foot, last ? first * pitch + 2 * kPi - foot : angle + pitch - foot);
  }
  return outline;
}

double Involute(double pressure_angle) { return std::tan(pressure_angle) - pressure_angle; }

/// Gear 1 turns by 1 rad/s; gear 2 follows it against a torque.
World MeshWorld(const Mesh& mesh) {
  const auto gear = [&](int teeth) {
    constexpr double kBacklash = 0.02;
    InvoluteGear made;
    made.pitch_radius = kModule * teeth / 2;
    made.base_radius = made.pitch_radius * std::cos(mesh.pressure_angle);
    made.half_tooth = (1 - kBacklash) * kPi / (2 * teeth) + Involute(mesh.pressure_angle);
    return made;
  };
  InvoluteGear one = gear(mesh.teeth1);
  InvoluteGear two = gear(mesh.teeth2);
  // Both go as far beyond the pitch point along the line of action, and so by the contact ratio together.
  const double beyond = mesh.contact_ratio * kModule * kPi * std::cos(mesh.pressure_angle) / 2;
  for (auto [made, partner] : {std::pair(&one, &two), std::pair(&two, &one)}) {
    const double at_pitch = std::tan(mesh.pressure_angle);
    made->begin = 0.8 * (at_pitch - beyond / made->base_radius);
    made->end = at_pitch + beyond / made->base_radius;
  }
  Body frame = Anchor();
  Body driver = Fixed({"driver", {OutlineOfGear(one, mesh.teeth1, 0)}});
  driver.omega = 1;
  Body follower;
  follower.name = "follower";
  follower.x = {one.pitch_radius + two.pitch_radius, 0};
  follower.outline = OutlineOfGear(two, mesh.teeth2, kPi);
  follower.mass = 700;
  follower.inertia = 770;
  // A gap faces the driver's tooth, and its flank the tooth's.
  const double gap = kPi / mesh.teeth2 - (two.half_tooth - Involute(mesh.pressure_angle));
  const double tooth = one.half_tooth - Involute(mesh.pressure_angle);
  follower.theta = gap - tooth * one.pitch_radius / two.pitch_radius + (mesh.teeth2 % 2 == 0 ? kPi / mesh.teeth2 : 0);
  follower.omega = -one.pitch_radius / two.pitch_radius;
  World world = WorldWith("mesh", {frame, driver, follower}, {});
  world.joints = {Joint(ConstraintType::kPin, 2, {}, 0, follower.x)};
  world.loads.wrenches = {{{2, {}}, {}, mesh.torque}};
  return world;
}

/// The follower's angle and speed after every step, but for what the flanks lack and a tip's first touch.
void ExpectConstantRatio(const Mesh& mesh, int steps) {
  SCOPED_TRACE(::testing::Message() << mesh.teeth1 << ":" << mesh.teeth2 << ", " << mesh.pressure_angle
                                    << " rad, contact ratio " << mesh.contact_ratio << ", " << steps << " steps");
  constexpr double kDuration = 0.35;
  const World world = MeshWorld(mesh);
  const double ratio = -static_cast<double>(mesh.teeth1) / mesh.teeth2;
  AccelerationOptions options;
  options.max_events = 100;
  Mover mover(world, options);
  for (int k = 0; k < steps; ++k) {
    mover.KeepMoving(kDuration / steps);
    EXPECT_NEAR(mover.body(2).omega, ratio, 1e-5);
    EXPECT_NEAR(mover.body(2).theta - world.bodies[2].theta, ratio * mover->time(), 1e-6);
  }
  EXPECT_LE(mover->statistics().worst_penetration, kContactTolerance);
  EXPECT_LE(mover->statistics().steps, 250);
}

TEST(GearMesh, KeepsItsRatioAtAnyStep) {
  for (const int steps : {1, 2, 3, 5, 7, 10, 35}) ExpectConstantRatio({.torque = 5}, steps);
}

TEST(GearMesh, KeepsItsRatioWithOtherTeethAndContactRatios) {
  for (const Mesh& mesh : {Mesh{20, 30, 0.33, 1.65}, Mesh{33, 31, 0.34, 1.58}, Mesh{27, 33, 0.36, 1.36},
                           Mesh{29, 42, 0.31, 1.15}, Mesh{18, 43, 0.44, 1.44}, Mesh{26, 18, 0.41, 1.42}}) {
    ExpectConstantRatio(mesh, 2);
  }
}

}  // namespace
}  // namespace lcpbench
