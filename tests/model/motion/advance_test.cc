// Motions that cannot advance end and say why, and a check ends those that take too long, at both levels.

#include "support/process_watch.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

World WithOneBody(Vec2 x, Vec2 v) { return WorldWith("one", {Floor(), Movable(Disc(0.5), x, 0, v)}, {}); }

void ExpectStalled(const Mover& mover, const std::string& why) {
  EXPECT_EQ(mover->status(), MotionStatus::kStalled);
  EXPECT_NE(mover->detail().find(why), std::string::npos) << mover->detail();
}

TEST(Advance, ABodyWhoseWayIsBelowTheSpacingOfDoublesEndsTheMotion) {
  for (const MotionLevel level : kBothLevels) {
    for (double far = 1e17; far < 1e31; far *= 1e5) {
      SCOPED_TRACE(far);
      Mover mover(level, WithOneBody({1, far}, {0, 1}));
      mover->Advance(0.1);
      ExpectStalled(mover, "below the spacing of doubles at its place");
    }
    // At rest it has nowhere to go, and nearer there is a way.
    for (const World& world : {WithOneBody({1, 1e29}, {}), WithOneBody({1, 1e6}, {0, 1})}) {
      Mover mover(level, world);
      mover.KeepMoving(0.1);
    }
  }
}

TEST(Advance, StepsBelowTheSpacingOfDoublesEndTheMotion) {
  for (const double step : {1e-300, 1e-30, 1e-18}) {
    MotionOptions options;
    options.velocity.step = step;
    Mover mover(MotionLevel::kVelocity, WithOneBody({0, 3}, {0, 1}), options);
    mover->Advance(0.05);
    ExpectStalled(mover, "do not advance the time t = 0.05 s");
    EXPECT_EQ(mover->statistics().steps, 0);
  }
  Mover mover(MotionLevel::kAcceleration, WithOneBody({0, 3}, {0, 1}));
  mover->Advance(1e25);
  ExpectStalled(mover, "do not advance the time t = 1e+25 s");
}

// Past each other at a speed that allows steps of 1e-14 s at most.
TEST(Advance, SpeedsThatLeaveNoStepEndTheMotion) {
  for (double speed = 1e13; speed < 1e31; speed *= 1e4) {
    MotionOptions options;
    options.acceleration.max_events = 200;
    World world = WithOneBody({0, 3}, {speed, 0});
    Mover mover(MotionLevel::kAcceleration, world, options);
    mover->Advance(0.05);
    ExpectStalled(mover, "more than 200 events or steps within 1e-04 s");
    EXPECT_LE(mover->statistics().steps, 201);
  }
}

// Bounces that come to rest late, of which one takes a second of processor time.
TEST(Advance, TheSameBodiesThatMeetForASecondEndTheMotion) {
  MotionOptions options;
  options.acceleration.impact.restitution = 0.5;
  options.acceleration.impact.resting_speed = 0;
  options.acceleration.impact.velocity_tolerance = 1e-12;
  const World world = WorldWith("zeno", {Floor(), Movable(Disc(0.1), {0, 0.1 + 1e-5})}, {0, -1000});
  constexpr int kLong = 300;
  for (const double seconds : {0.2, 1.1}) {
    Mover mover(MotionLevel::kAcceleration, world, options);
    const MotionStatistics& statistics = mover->statistics();
    bool waited = false;
    mover->set_check([&] {
      if (waited || statistics.impacts < kLong) return;
      waited = true;
      for (const double until = ThreadTime() + seconds; ThreadTime() < until;) {
      }
    });
    mover->Advance(1e-3);
    EXPECT_TRUE(waited);
    if (seconds < 1) {
      EXPECT_EQ(mover->status(), MotionStatus::kMoving) << mover->detail();
    } else {
      ExpectStalled(mover, " events or steps within 1e-04 s and 1 s of processor time at t = 0.0004");
      ExpectStalled(mover, "the last to meet or part: 'floor' (edge 0) and 'disc' (edge 0)");
      EXPECT_LE(statistics.impacts, kLong + 1);
    }
  }
}

// Whatever their numbers are, motions come to an end.
TEST(Advance, ExtremeWorldsComeToAnEnd) {
  Random random(23);
  int ended = 0;
  for (int k = 0; k < 60; ++k) {
    const auto number = [&](double usual) {
      const double size = random.Uniform(0, 1) < 0.3 ? std::pow(10, random.Uniform(-30, 30)) : random.Uniform(0.5, 1.5);
      return (random.Uniform(0, 1) < 0.3 ? -1 : 1) * usual * size;
    };
    std::vector<Body> bodies = {Floor()};
    for (int i = 0; i < 3; ++i) {
      const Outline shapes[] = {Disc(0.5), Box(1, 0.6), Ellipse(0.7, 0.4), Capsule(0.8, 0.2)};
      const Vec2 x{number(1), number(1 + i)};
      const double theta = number(0.3);
      Body body = Movable(shapes[(k + i) % 4], x, theta, {number(1), number(1)}, number(1));
      body.mass *= std::abs(number(1));
      body.inertia *= std::abs(number(1));
      bodies.push_back(body);
    }
    World world = WorldWith("extreme", bodies, {0, -std::abs(number(kG))});
    if (k % 3 == 0) world.loads.springs.push_back({{1, {}}, {2, {0.1, 0}}, std::abs(number(100)), 1});
    if (k % 4 == 0) world.joints.push_back(Joint(ConstraintType::kRope, 1, {}, 3, {}, std::abs(number(2))));
    for (const MotionLevel level : kBothLevels) {
      MotionOptions options;
      options.acceleration.max_events = 20;
      options.acceleration.lcp.time_limit_s = options.velocity.lcp.time_limit_s = 1;
      try {
        Mover mover(level, world, options);
        mover->Advance(1e-2);
        EXPECT_EQ(mover->status() == MotionStatus::kMoving, mover->detail().empty());
        ++ended;
      } catch (const InputError&) {  // geometry that is singular there
      }
    }
  }
  EXPECT_GT(ended, 40);
}

// Also where there is no LCP at all, and between two bodies of long outlines.
TEST(Advance, ACheckEndsAMotionWithinAStep) {
  struct Over {};
  GearShape gear;
  gear.teeth = 60;
  World gears = WorldWith("gears", {Movable(Gear(gear), {}), Movable(Gear(gear), {1.5, 1.5})}, {});
  for (const MotionLevel level : kBothLevels) {
    for (const World& world : {WithOneBody({0, 3}, {1, 0}), gears}) {
      int left = 0;
      for (const int calls : {0, 1, 2}) {
        Mover mover(level, world);
        left = calls;
        mover->set_check([&left] {
          if (left-- == 0) throw Over();
        });
        EXPECT_THROW(mover->Advance(0.1), Over) << calls;
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench
