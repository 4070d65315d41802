// Motion at the acceleration level at its events: impacts, rest, contacts that begin and end, walls that move.

#include "model/contact/loads.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

std::vector<Body> Cradle(int count, double gap) {
  std::vector<Body> balls;
  balls.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) balls.push_back(Movable(Disc(0.1), {(0.2 + gap) * k, 0}));
  balls[0].x.x -= 0.3;
  balls[0].v = {1, 0};
  return balls;
}

TEST(AccelerationMotion, InACradleWithSmallGapsTheLastBallLeavesWithTheFirstOnesVelocity) {
  Mover mover(WorldWith("cradle in a line", Cradle(5, 1e-4), {}), WithRestitution(1));
  ExpectConserved(&mover, KineticEnergy(mover->world().bodies), 1);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(mover.body(k).v.x, k == 4 ? 1 : 0, 1e-12) << k;
  EXPECT_EQ(mover->statistics().impacts, 4);
}

TEST(AccelerationMotion, TouchingBallsUnderOneRestitutionShareTheImpact) {
  for (const ImpactLaw law : {ImpactLaw::kNewton, ImpactLaw::kPoisson}) {
    AccelerationOptions options = WithRestitution(1);
    options.impact.law = law;
    Mover mover(WorldWith("touching cradle", Cradle(3, 0), {}), options);
    mover->Advance(1);
    EXPECT_NEAR(mover.body(0).v.x, -1.0 / 3, 1e-9);
    EXPECT_NEAR(mover.body(1).v.x, 2.0 / 3, 1e-9);
    EXPECT_NEAR(mover.body(2).v.x, 2.0 / 3, 1e-9);
    EXPECT_EQ(mover->statistics().impacts, 1);
  }
}

TEST(AccelerationMotion, ABouncingBallKeepsItsTimetable) {
  const double r = 0.1;
  const double drop = 0.5;
  const double e = 0.6;
  Mover mover(WorldWith("bouncing ball", {Floor(), Movable(Disc(r), {0, r + drop})}), WithRestitution(e));
  // Falls for t0, then flights of 2 e^k t0.
  const double t0 = std::sqrt(2 * drop / kG);
  const double v0 = kG * t0;
  double landing = t0;
  double speed = v0;
  for (int k = 1; k <= 6; ++k) {
    speed *= e;
    const double top = landing + speed / kG;
    mover->Advance(top - mover->time());
    EXPECT_EQ(mover->statistics().impacts, k);
    EXPECT_NEAR(mover.body(1).x.y, r + speed * speed / (2 * kG), 1e-9) << k;
    EXPECT_NEAR(mover.body(1).v.y, 0, 1e-8) << k;
    landing += 2 * speed / kG;
  }
  // All bounces are over after this, and the ball rests.
  mover.KeepMoving(t0 + 2 * t0 * e / (1 - e) + 0.5 - mover->time());
  EXPECT_NEAR(mover.body(1).x.y, r, 1e-8);
  EXPECT_NEAR(mover.body(1).v.y, 0, 1e-9);
  // Down to the resting speed: v0 e^k >= 1e-4.
  EXPECT_EQ(mover->statistics().impacts, static_cast<int>(std::ceil(std::log(1e-4 / v0) / std::log(e))) + 1);
}

TEST(AccelerationMotion, WithoutARestingSpeedBouncingStalls) {
  AccelerationOptions options = WithRestitution(0.5);
  options.impact.resting_speed = 0;
  options.impact.velocity_tolerance = 1e-12;
  options.max_events = 10;
  Mover mover(WorldWith("zeno", {Floor(), Movable(Disc(0.1), {0, 0.2})}), options);
  mover->Advance(5);
  EXPECT_EQ(mover->status(), MotionStatus::kStalled);
  EXPECT_NE(mover->detail().find("more than 10 events"), std::string::npos) << mover->detail();
  EXPECT_NE(mover->detail().find("'floor' (edge 0) and 'disc' (edge 0)"), std::string::npos) << mover->detail();
  const double stopped = mover->time();
  mover->Advance(1);
  EXPECT_EQ(mover->time(), stopped);
}

// A lever lies on two posts; one of them sinks a little below the other, slower than what counts as rest, and comes
// back: the lever stays on the one that is higher.
TEST(AccelerationMotion, ALeverStaysOnThePostThatIsHigher) {
  constexpr double kRadius = 0.1;
  for (const double speed : {1e-7, 3e-7, 8e-7}) {
    SCOPED_TRACE(speed);
    const double back = 0.1;  // [s]
    Body at_rest = Fixed(Disc(kRadius), {0.7, -kRadius});
    Body sinking = Fixed(Disc(kRadius), {1, -kRadius});
    sinking.v.y = -speed;
    sinking.acceleration.y = 2 * speed / back;
    Body lever = Movable(Box(3, 0.2), {0, 0.1});
    World world = WorldWith("lever on posts", {Anchor(), at_rest, sinking, lever}, {});
    world.joints = {Joint(ConstraintType::kPin, 3, {0, -0.1}, 0, {})};
    world.loads.wrenches = {{{3, {}}, {}, -50}};
    AccelerationOptions options;
    options.max_events = 100;
    Mover mover(world, options);
    for (const double until : {0.08, 0.5}) {
      mover.KeepMoving(until - mover->time());
      EXPECT_NEAR(mover.body(3).theta, std::max(0.0, until * (until / back - 1) * speed), kContactTolerance);
    }
    EXPECT_LE(mover->statistics().steps, 60);
  }
}

// While the disc falls, the wheel's edges pass by under it: those that it meets are out of sight at the end of a step.
TEST(AccelerationMotion, ADiscLandsOnATurningWheelOfShortCurves) {
  constexpr int kEdges = 60;
  std::vector<OutlinePiece> wheel;
  for (int k = 0; k < kEdges; ++k) {
    constexpr double kTurn = 2 * kPi / kEdges;
    const Vec2 from = Direction(k * kTurn);
    const Vec2 to = Direction((k + 1) * kTurn);
    const double along = 4.0 / 3 * std::tan(kTurn / 4);
    wheel.push_back({BezierEdge{{from, from + along * Perp(from), to - along * Perp(to), to}}, 0, 1});
  }
  for (const double speed : {1.0, 2.0, -4.0}) {
    SCOPED_TRACE(speed);
    Body turning = Fixed({"wheel", {wheel}});
    turning.omega = speed;
    Mover mover(WorldWith("wheel", {turning, Movable(Disc(1), {0, 2 + 2e-6})}, {0, -0.02}));
    mover.KeepMoving(0.2);
    EXPECT_NEAR(mover.body(1).x.y, 2, 1e-6);
    EXPECT_LE(mover->statistics().worst_penetration, 1e-6);
  }
}

TEST(AccelerationMotion, ABoxThatFallsOnACornerComesToLieFlat) {
  for (const double tilt : {0.3, -0.7, 1e-4}) {
    Mover mover(WorldWith("falling box", {Floor(), Movable(Box(0.4, 0.2), {0, 0.6}, tilt)}), WithRestitution(0.4));
    mover.KeepMoving(5);
    EXPECT_NEAR(mover.body(1).theta, 0, 1e-5) << tilt;
    EXPECT_NEAR(mover.body(1).x.y, 0.1, 1e-5) << tilt;
    EXPECT_NEAR(mover.body(1).omega, 0, 1e-5) << tilt;
    EXPECT_LE(mover->statistics().worst_penetration, kContactTolerance);
  }
}

TEST(AccelerationMotion, AKinematicTableCarriesADisc) {
  Body table = Fixed(Box(2, 0.2), {0.3, 0});
  table.v = {0.5, 0.2};
  table.acceleration = {-0.3, 0.8};
  const double r = 0.25;
  Mover mover(WorldWith("lift", {table, Movable(Disc(r), {0, 0.1 + r})}));
  // Meets the disc with 0.2 m/s: e = 0 makes that the disc's, too.
  mover->Advance(1.25);
  const double t = mover->time();
  EXPECT_DOUBLE_EQ(mover.body(0).x.x, 0.3 + t * (0.5 - 0.3 * t / 2));
  EXPECT_DOUBLE_EQ(mover.body(0).x.y, t * (0.2 + 0.8 * t / 2));
  EXPECT_NEAR(mover.body(1).x.x, 0, 1e-12);
  EXPECT_NEAR(mover.body(1).x.y, 0.1 + r + t * (0.2 + 0.8 * t / 2), 1e-9);
  EXPECT_NEAR(mover.body(1).v.y, 0.2 + 0.8 * t, 1e-9);
}

TEST(AccelerationMotion, ASpinningRoundDrumLeavesADiscAloneAndAnOvalOneThrowsIt) {
  for (const bool is_round : {true, false}) {
    OutlineCurve wall = EllipseEdge{{}, 1, 0.8, 0, Side::kConcave};
    if (is_round) wall = ArcEdge{{}, 1, Side::kConcave};
    Body drum = Fixed({"drum", {{{wall, 2 * kPi, 0}}}});
    drum.omega = 3;
    Mover mover(WorldWith("drum", {drum, Movable(Disc(0.2), {0, -0.6})}));
    mover.KeepMoving(2);
    EXPECT_DOUBLE_EQ(mover.body(0).theta, 6);
    EXPECT_EQ(std::abs(mover.body(1).x.x) < 1e-9, is_round);
    EXPECT_LE(mover->statistics().worst_penetration, 1e-6);
  }
}

TEST(AccelerationMotion, ARopeGetsTautAndThenHoldsADiscOnACircle) {
  const double length = 0.8;
  Body disc = Movable(Disc(0.1), {0.48, 0});
  World world = WorldWith("rope", {Anchor(), disc});
  world.joints = {Joint(ConstraintType::kRope, 1, {}, 0, {}, length)};
  Mover mover(world);
  // Falls freely to (0.48, -0.64), where e = 0 leaves the velocity along the circle.
  const double v = std::sqrt(2 * kG * 0.64);
  const double along = v * 0.6;
  mover->Advance(v / kG + 0.05);
  EXPECT_EQ(mover->statistics().impacts, 1);
  EXPECT_NEAR(Norm(mover.body(1).x), length, 1e-8);
  EXPECT_NEAR(Energy(mover->world()), disc.mass * (along * along / 2 - kG * 0.64), 1e-9);
  // Elastic: back the way it came along the rope.
  Mover bouncing(world, WithRestitution(1));
  ExpectConserved(&bouncing, disc.mass * kG * 0.64, 5);
  EXPECT_LE(Norm(bouncing.body(1).x), length + 1e-6);
}

TEST(AccelerationMotion, ABulletDoesNotPassThroughAThinWall) {
  Random random(5);
  for (int k = 0; k < 40; ++k) {
    const double speed = 10 * std::pow(1000, random.Uniform());
    const Vec2 x{-1, random.Uniform(-0.4, 0.4)};
    const Outline outline = k % 2 == 0 ? Disc(0.01) : Box(0.02, 0.015);
    const Body bullet = Movable(outline, x, random.Uniform(0, 6), {speed, 0});
    Mover mover(WorldWith("bullet", {Fixed(Box(0.002, 1)), bullet}, {}), WithRestitution(1));
    mover->Advance(2 / speed);
    EXPECT_GE(mover->statistics().impacts, 1) << k;
    EXPECT_LT(mover.body(1).x.x, 0) << k;
  }
}

TEST(AccelerationMotion, ADiscThatGrazesACornerBetweenTwoStepsIsSeen) {
  // Passes under the corner so closely that gaps are open at the ends of most steps around it.
  for (int k = 0; k < 50; ++k) {
    const double overlap = 1e-3 * (k % 2 == 0 ? 1 : -1);
    const Body disc = Movable(Disc(0.1), {-1 - 0.003 * k, -0.1 + overlap}, 0, {2, 0});
    Body wedge = Fixed({"wedge",
                        {{{StraightEdge{{0, 0}, {1, 1}}, 0, 1},
                          {StraightEdge{{1, 1}, {-1, 1}}, 0, 1},
                          {StraightEdge{{-1, 1}, {0, 0}}, 0, 1}}}});
    Mover mover(WorldWith("graze", {wedge, disc}, {}), WithRestitution(1));
    mover->Advance(1);
    EXPECT_EQ(mover->statistics().impacts, overlap > 0 ? 1 : 0) << k;
  }
}

}  // namespace
}  // namespace lcpbench
