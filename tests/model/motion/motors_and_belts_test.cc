// Motors and dry friction of pins at both levels, and belts at the velocity level, against closed forms.

#include "model/contact/assembly.h"
#include "model/motion/contact_finder.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

constexpr double kMotorStep = 1e-3;

/// A motion under `auto`, and the row of that kind in the last problem met.
class DrivenWorld {
 public:
  DrivenWorld(MotionLevel level, const World& world, char axis = 'r', double tolerance = 1e-12)
      : motion_(level, world, Options(tolerance), "auto") {
    motion_->set_observer([this, level, axis](const MotionProblem& met) {
      for (std::size_t i = 0; i < met.rows.size(); ++i) {
        if (met.rows[i].axis != axis) continue;
        force_ = met.result.f[static_cast<Index>(i)] / (level == MotionLevel::kVelocity ? step_ : 1);
      }
    });
  }

  void AdvanceTo(double time) {
    const double duration = time - motion_->time();
    step_ = duration / std::ceil(duration / kMotorStep - 1e-9);
    motion_.KeepMoving(duration);
    ASSERT_EQ(motion_->statistics().failed_solves, 0);
  }
  const Body& body(std::size_t i) const { return motion_.body(i); }
  const Motion& motion() const { return *motion_.operator->(); }
  /// [N], [N m]
  double force() const { return force_; }

 private:
  static MotionOptions Options(double tolerance) {
    MotionOptions options;
    options.velocity.step = kMotorStep;
    options.velocity.lcp.tolerance = options.acceleration.lcp.tolerance = tolerance;
    return options;
  }

  Mover motion_;
  double force_ = 0;
  double step_ = 0;
};

World Flywheel(double limit, double speed, double load) {
  World world = WorldWith("flywheel", {Anchor(), Movable(Disc(0.5), {})}, {});
  world.joints = {Joint(ConstraintType::kPin, 1, {}, 0, {})};
  world.joints[0].torque_limit = limit;
  world.joints[0].speed = speed;
  world.loads.wrenches = {{{1, {}}, {}, load}};
  return world;
}

/// A bar from its pin at the origin along `angle`, 1 m long and thin.
World PinnedLever(double angle, double limit, double speed) {
  World world =
      WorldWith("lever", {Anchor(), Movable(Box(1, 0.1), {0.5 * std::cos(angle), 0.5 * std::sin(angle)}, angle)});
  world.joints = {Joint(ConstraintType::kPin, 1, {-0.5, 0}, 0, {})};
  world.joints[0].torque_limit = limit;
  world.joints[0].speed = speed;
  return world;
}
double WeightMoment(const World& lever) { return lever.bodies[1].mass * kG * 0.5; }
double InertiaAboutPin(const World& lever) { return lever.bodies[1].inertia + lever.bodies[1].mass * 0.25; }

// omega = (T - L) t / I to the target, then constant under the torque L.
TEST(Motors, SpinAFlywheelUpAndThenBearItsLoad) {
  for (const MotionLevel level : kBothLevels) {
    for (const double sign : {1.0, -1.0}) {
      for (const double load : {0.0, 0.5, -0.5}) {
        SCOPED_TRACE(std::string(ToString(level)) + " " + std::to_string(sign * load));
        const double limit = 2;
        const World world = Flywheel(limit, sign * 3, sign * load);
        const double inertia = world.bodies[1].inertia;
        const double reached = 3 * inertia / (limit + load);
        DrivenWorld driven(level, world);
        driven.AdvanceTo(reached / 2);
        EXPECT_NEAR(driven.body(1).omega, sign * 1.5, 1e-10);
        EXPECT_NEAR(driven.force(), sign * limit, 1e-10);
        driven.AdvanceTo(3 * reached);
        EXPECT_NEAR(driven.body(1).omega, sign * 3, 1e-9);
        EXPECT_NEAR(driven.force(), -sign * load, 1e-9);
        const double turned = level == MotionLevel::kVelocity ? 3 * kMotorStep : 1e-8;
        EXPECT_NEAR(driven.body(1).theta, sign * 3 * (2 + 0.5) * reached, turned);
      }
    }
  }
}

TEST(Motors, AreDraggedByALoadAboveTheirLimit) {
  for (const MotionLevel level : kBothLevels) {
    for (const double load : {-1.999, -2.001}) {
      const World world = Flywheel(2, 0.001, load);
      DrivenWorld driven(level, world);
      driven.AdvanceTo(1);
      const bool holds = load > -2;
      EXPECT_NEAR(driven.body(1).omega, holds ? 0.001 : -0.001 / world.bodies[1].inertia, 1e-8) << ToString(level);
    }
  }
}

// Speeds are of body 1 relative to body 2: both turn, without angular momentum.
TEST(Motors, DriveTwoBodiesAgainstEachOther) {
  for (const MotionLevel level : kBothLevels) {
    World world = WorldWith("two", {Movable(Disc(0.5), {}), Movable(Disc(0.3), {})}, {});
    world.bodies[0].outline.clear();
    world.joints = {Joint(ConstraintType::kPin, 0, {}, 1, {})};
    world.joints[0].torque_limit = 1;
    world.joints[0].speed = 4;
    const double inertia1 = world.bodies[0].inertia;
    const double inertia2 = world.bodies[1].inertia;
    DrivenWorld driven(level, world);
    driven.AdvanceTo(2 / (1 / inertia1 + 1 / inertia2));
    EXPECT_NEAR(driven.body(0).omega - driven.body(1).omega, 2, 1e-9);
    driven.AdvanceTo(1);
    EXPECT_NEAR(driven.body(0).omega, 4 * inertia2 / (inertia1 + inertia2), 1e-9);
    EXPECT_NEAR(driven.body(1).omega, -4 * inertia1 / (inertia1 + inertia2), 1e-9);
  }
}

// The speed of a motor is relative to the body that carries it, here a fixed one that turns.
TEST(Motors, FollowAFrameThatTurns) {
  for (const MotionLevel level : kBothLevels) {
    World world = Flywheel(2, 3, 0);
    world.bodies[0].omega = 1;
    world.bodies[0].alpha = 0.5;
    DrivenWorld driven(level, world);
    driven.AdvanceTo(2);
    EXPECT_NEAR(driven.body(1).omega, level == MotionLevel::kVelocity ? 5 - kMotorStep / 4 : 5, 1e-9);
    EXPECT_NEAR(driven.force(), 0.5 * world.bodies[1].inertia, 1e-9);
  }
}

TEST(Motors, LiftALeverIfTheyAreStrongEnough) {
  for (const MotionLevel level : kBothLevels) {
    for (const double share : {0.7, 0.999, 1.001, 1.5}) {
      SCOPED_TRACE(std::string(ToString(level)) + " " + std::to_string(share));
      World world = PinnedLever(0, 0, 50);
      const double weight = WeightMoment(world);
      const double limit = share * weight;
      world.joints[0].torque_limit = limit;
      world.bodies.push_back(Fixed(Disc(0.1), {0.4, -0.15}));
      DrivenWorld driven(level, world, 'n');
      driven.AdvanceTo(0.3);
      const double turned = driven.body(1).theta;
      if (share < 1) {
        EXPECT_NEAR(turned, 0, 1e-9);
        EXPECT_NEAR(driven.force(), (weight - limit) / 0.4, 1e-8) << "the support bears the rest";
        continue;
      }
      const double omega = driven.body(1).omega;
      EXPECT_GT(turned, 1e-5);
      EXPECT_NEAR(InertiaAboutPin(world) * omega * omega / 2 / (limit * turned - weight * std::sin(turned)), 1,
                  level == MotionLevel::kVelocity ? 100 * kMotorStep : 1e-5);
    }
  }
}

// A torque that brings it to its speed within a microsecond: no cascade of events.
TEST(Motors, MayBeVeryStrong) {
  for (const double limit : {1e3, 1e6}) {
    DrivenWorld driven(MotionLevel::kAcceleration, Flywheel(limit, 3, -1), 'r', 1e-9);
    driven.AdvanceTo(1);
    EXPECT_NEAR(driven.body(1).omega, 3, 1e-6);
    EXPECT_NEAR(driven.force(), 1, 1e-9);
    EXPECT_LT(driven.motion().statistics().steps, 100);
  }
}

// t = I omega / T, after I omega^2 / (2 T) rad.
TEST(JointFriction, StopsAFlywheel) {
  for (const MotionLevel level : kBothLevels) {
    for (const double omega : {3.0, -3.0}) {
      World world = Flywheel(0.2, 0, 0);
      world.bodies[1].omega = omega;
      const double stops = world.bodies[1].inertia * 3 / 0.2;
      DrivenWorld driven(level, world);
      driven.AdvanceTo(stops * 0.75);
      EXPECT_NEAR(driven.body(1).omega, omega / 4, 1e-9) << ToString(level);
      EXPECT_NEAR(driven.force(), -std::copysign(0.2, omega), 1e-12);
      driven.AdvanceTo(stops + 1);
      EXPECT_NEAR(driven.body(1).omega, 0, 1e-9);
      EXPECT_NEAR(driven.body(1).theta, omega * stops / 2, level == MotionLevel::kVelocity ? 3 * kMotorStep : 1e-8);
      const double stopped = driven.body(1).theta;
      driven.AdvanceTo(stops + 5);
      EXPECT_NEAR(driven.body(1).theta, stopped, 1e-9);
    }
  }
}

TEST(JointFriction, HoldsAPendulumUpToItsLimit) {
  for (const MotionLevel level : kBothLevels) {
    const double angle = 0.4 - kPi / 2;
    for (const double share : {0.999, 1.001}) {
      World world = PinnedLever(angle, 0, 0);
      const double moment = WeightMoment(world) * std::sin(0.4);
      world.joints[0].torque_limit = moment / share;
      DrivenWorld driven(level, world);
      driven.AdvanceTo(0.5);
      const double fallen = angle - driven.body(1).theta;
      if (share < 1) {
        EXPECT_NEAR(fallen, 0, 1e-9) << ToString(level);
        EXPECT_NEAR(driven.force(), moment, 1e-6);
      } else {
        EXPECT_NEAR(driven.force(), moment / share, 1e-9);
        EXPECT_GT(fallen, 1e-4) << ToString(level);
      }
    }
  }
}

// Turning points: m g l (cos phi' - cos phi) = T (phi + phi'), until the friction holds it.
TEST(JointFriction, LetsAPendulumSwingOutAndStay) {
  World world = PinnedLever(2 - kPi / 2, 0, 0);
  const double weight = WeightMoment(world);
  const double limit = 0.1 * weight;
  world.joints[0].torque_limit = limit;
  double phi = 2;
  double side = 1;
  int swings = 0;
  for (; weight * std::sin(phi) > limit; ++swings, side = -side) {
    double low = 0;  // of the next turning point's amplitude, at which energy is left
    double high = phi;
    while (high - low > 1e-14) {
      const double next = (low + high) / 2;
      (weight * (std::cos(next) - std::cos(phi)) > limit * (phi + next) ? low : high) = next;
    }
    phi = low;
  }
  EXPECT_GE(swings, 4);
  for (const MotionLevel level : kBothLevels) {
    DrivenWorld driven(level, world);
    driven.AdvanceTo(12);
    EXPECT_NEAR(driven.body(1).theta + kPi / 2, side * phi, level == MotionLevel::kVelocity ? 0.01 : 1e-8);
    EXPECT_NEAR(driven.body(1).omega, 0, 1e-9);
    EXPECT_NEAR(driven.force(), weight * std::sin(side * phi), 2e-2 * weight);
  }
}

// Near the turning point of its speed, a pendulum keeps for a moment the speed of its motor: a step must not pass over
// that.
TEST(Motors, AreNotPassedOverWithinAStep) {
  World world = PinnedLever(0.3 - kPi / 2, 0, 0);
  const double weight = WeightMoment(world);
  const double limit = 0.02 * weight;
  // The fastest that the full torque makes it, a little beyond the bottom.
  const double beyond = std::asin(0.02);
  const double fastest =
      std::sqrt(2 * (weight * (std::cos(beyond) - std::cos(0.3)) + limit * (0.3 + beyond)) / InertiaAboutPin(world));
  world.joints[0].torque_limit = limit;
  for (const double share : {0.9995, 0.9999, 1.0001}) {
    world.joints[0].speed = -share * fastest;
    std::vector<double> angles;
    for (const double frame : {0.8, 1e-3}) {
      DrivenWorld driven(MotionLevel::kAcceleration, world);
      for (int k = 1; k * frame < 0.8 + 1e-9; ++k) driven.AdvanceTo(k * frame);
      angles.push_back(driven.body(1).theta);
    }
    EXPECT_NEAR(angles[0], angles[1], 1e-9) << share;
  }
}

/// A belt along y = 0 that is turned by `angle`, and a body upon it. Edges run to the left: so does speed > 0.
World Belt(double mu, double speed, const Outline& outline, double height, double angle = 0, bool belt_first = true) {
  Body belt = Fixed({"belt", {{{StraightEdge{{50, 0}, {-50, 0}}, 0, 1}}}}, {}, angle);
  belt.surface_speed = speed;
  Body body = Movable(outline, Rotate(SinCos(angle), {0, height}), angle);
  belt.friction = body.friction = mu;
  World world = WorldWith("belt", {belt, body});
  if (!belt_first) std::swap(world.bodies[0], world.bodies[1]);
  return world;
}

// v = mu g t until the belt's speed.
TEST(Belts, TakeABoxAlong) {
  const double mu = 0.3;
  for (const bool belt_first : {true, false}) {
    for (const double speed : {2.0, -2.0}) {
      DrivenWorld driven(MotionLevel::kVelocity, Belt(mu, speed, Box(1, 0.4), 0.2, 0, belt_first));
      const std::size_t box = belt_first ? 1 : 0;
      const double reached = 2 / (mu * kG);
      const double half = kMotorStep * std::floor(reached / 2 / kMotorStep);
      driven.AdvanceTo(half);
      EXPECT_NEAR(driven.body(box).v.x, -std::copysign(mu * kG * half, speed), 1e-9);
      driven.AdvanceTo(reached + 1);
      EXPECT_NEAR(driven.body(box).v.x, -speed, 1e-9);
      EXPECT_NEAR(driven.body(box).x.x, -speed * (reached / 2 + 1), 2 * kMotorStep);
      EXPECT_NEAR(driven.body(box).x.y, 0.2, 1e-9);
    }
  }
}

// Up a slope by mu g cos - g sin, to the belt's speed; down by the same where the slope is too steep.
TEST(Belts, CarryABoxUpASlopeThatFrictionCanHold) {
  const double slope = 0.3;
  for (const double share : {0.98, 1.02}) {
    const double mu = share * std::tan(slope);
    DrivenWorld driven(MotionLevel::kVelocity, Belt(mu, 0.05, Box(1, 0.2), 0.1, -slope));
    driven.AdvanceTo(3);
    const double along = Dot(driven.body(1).v, {-std::cos(slope), std::sin(slope)});
    const double expected = share > 1 ? 0.05 : 3 * kG * (mu * std::cos(slope) - std::sin(slope));
    EXPECT_NEAR(along, expected, 1e-8) << share;
  }
}

// Slips for v / (3 mu g), then rolls at v / 3.
TEST(Belts, SetADiscRolling) {
  const double mu = 0.2;
  DrivenWorld driven(MotionLevel::kVelocity, Belt(mu, -1.5, Disc(0.25), 0.25));
  const double rolls = 1.5 / (3 * mu * kG);
  const double half = kMotorStep * std::floor(rolls / 2 / kMotorStep);
  driven.AdvanceTo(half);
  EXPECT_NEAR(driven.body(1).v.x, mu * kG * half, 1e-9);
  driven.AdvanceTo(rolls + 1);
  EXPECT_NEAR(driven.body(1).v.x, 0.5, 1e-9);
  EXPECT_NEAR(driven.body(1).omega, 1 / 0.25, 1e-8);
}

// A plank of thickness c on two rollers that turn towards each other swings by omega^2 = mu g / (a - mu c / 2).
TEST(Belts, OfTwoRollersLetAPlankSwing) {
  const double mu = 0.25;
  const double apart = 1;
  World world = WorldWith(
      "rollers", {Fixed(Disc(0.2), {-apart, 0}), Fixed(Disc(0.2), {apart, 0}), Movable(Box(4, 0.1), {0.3, 0.25})});
  for (Body& body : world.bodies) body.friction = mu;
  world.bodies[0].surface_speed = -5;  // at the top to the right
  world.bodies[1].surface_speed = 5;
  DrivenWorld driven(MotionLevel::kVelocity, world);
  const double omega = std::sqrt(mu * kG / (apart - mu * 0.05));
  for (const double time : {0.5, 1.0, 2.0}) {
    driven.AdvanceTo(time);
    EXPECT_NEAR(driven.body(2).x.x, 0.3 * std::cos(omega * time), 1e-3);
  }
}

// At the level of accelerations: the slip is that against the surface, whichever body has it and comes first.
TEST(Belts, AreInTheSlipAndInTheStep) {
  for (const bool belt_first : {true, false}) {
    World world = Belt(0.5, 2, Disc(0.25), 0.25, 0, belt_first);
    world.bodies[belt_first ? 1 : 0].v = {-0.5, 0};
    const ContactSystem system = InstantOf(world, ContactFinder(world).Find(world.bodies, 1e-6, 1e-6));
    for (const AssembledLcp& lcp : {AssembleContactLcp(system, Friction::kRows), AssembleStepLcp(system, 0.01)}) {
      ASSERT_EQ(lcp.rows.size(), 2U);
      // t = Perp(n) = (-1, 0) for both orders.
      EXPECT_NEAR(lcp.rows[1].d_dot, 0.5 - 2, 1e-15);
    }
    EXPECT_NEAR(AssembleContactLcp(system, Friction::kRows).problem.b()[1], 0, 1e-15);
    EXPECT_NEAR(AssembleStepLcp(system, 0.01).problem.b()[1], 0.5 - 2, 1e-15);
  }
}

TEST(Motors, AreRefusedWhereTheyMeanNothing) {
  const auto refused = [](const World& world, const std::string& words) {
    ExpectRefused([&] { RequireValid(world); }, words);
  };
  refused(Flywheel(-1, 0, 0), "joint 0: expected a torque limit >= 0");
  refused(Flywheel(std::nan(""), 0, 0), "torque limit");
  refused(Flywheel(1, INFINITY, 0), "a speed");
  World rod = Flywheel(1, 0, 0);
  rod.joints[0].type = ConstraintType::kRod;
  refused(rod, "only a pin has a torque limit");
  World world = Flywheel(1, 0, 0);
  world.bodies[1].surface_speed = 1;
  refused(world, "surface speed");
}

}  // namespace
}  // namespace lcpbench
