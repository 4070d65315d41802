// A rope whose ends coincide has no direction, and needs none: it is slack.

#include "model/contact/contact_row.h"
#include "model/scene_file/scene_file.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

TEST(Ropes, ABallThatStartsAtItsHookFallsFreelyAndIsCaught) {
  const World world = ReadSceneFile(LCPBENCH_SOURCE_DIR "/tests/data/reports/rope-of-no-length.json").world;
  const double fall = std::sqrt(2 / kG);
  for (const MotionLevel level : kBothLevels) {
    SCOPED_TRACE(ToString(level));
    const Mover motion(level, world);
    const double tolerance = level == MotionLevel::kVelocity ? 1e-2 : 1e-6;
    motion->Advance(0.9 * fall);
    EXPECT_NEAR(motion.body(1).x.y, 5 - 0.81, tolerance);
    EXPECT_NEAR(motion.body(1).v.y, -0.9 * kG * fall, tolerance);
    motion.KeepMoving(0.6 * fall);
    EXPECT_NEAR(motion.body(1).x.y, 4, 1e-5);
    EXPECT_NEAR(motion.body(1).v.y, 0, 1e-6);
    EXPECT_LE(motion->statistics().worst_penetration, 1e-5);
  }
}

// Two discs on a rope between points off their centres that coincide, parting in any direction: the rope also shorter
// than a step's way or the range in which contacts are looked for.
TEST(Ropes, EndsThatPartAreCaughtAtTheRopesLength) {
  Random random(42);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE(k);
    const double length = std::pow(10, random.Uniform(k % 5 == 0 ? -7 : -3, 0.5));
    const double speed = std::pow(10, random.Uniform(-0.5, 0.7));
    const Vec2 way = Direction(random.Uniform(-kPi, kPi));
    const Vec2 place{random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const Body first = Movable(Disc(random.Uniform(0.1, 1)), place, 0, {0.3, -0.2});
    const Body second = Movable(Disc(random.Uniform(0.1, 1)), place, 0, first.v + speed * way);
    World world = WorldWith("parting", {first, second}, {});
    world.joints = {Joint(ConstraintType::kRope, 0, {}, 1, {}, length)};
    for (const MotionLevel level : kBothLevels) {
      SCOPED_TRACE(ToString(level));
      const Mover motion(level, world);
      motion->Advance(0.5 * length / speed);
      const double step_way = level == MotionLevel::kVelocity ? 1e-3 * speed : 0;
      EXPECT_NEAR(DistanceOfEnds(world.joints[0], motion->world().bodies), std::min(0.5 * length, length),
                  1e-6 + step_way);
      motion.KeepMoving(1.5 * length / speed + 0.01);
      EXPECT_NEAR(DistanceOfEnds(world.joints[0], motion->world().bodies), length, 1e-5 + step_way);
      // Without restitution the two go on together.
      const Vec2 together = (1 / (first.mass + second.mass)) * (first.mass * first.v + second.mass * second.v);
      for (const Body& body : motion->world().bodies) EXPECT_LE(Norm(body.v - together), 1e-5 * speed);
    }
  }
}

TEST(Ropes, HaveNoRowWhereTheirEndsCoincideAndRodsAreRefused) {
  for (const double apart : {0.0, 1e-13, 1e-11}) {
    World world = WorldWith("ends", {Anchor(), Movable(Disc(0.1), {apart, 5}), Movable(Disc(0.1), {1, 5})});
    world.bodies[0].x = {0, 5};
    world.joints = {Joint(ConstraintType::kRope, 1, {}, 0, {}, 0.5), Joint(ConstraintType::kRod, 2, {}, 0, {}, 1)};
    const AssembledLcp lcp = AssembleContactLcp(InstantOf(world, {}));
    ASSERT_EQ(lcp.rows.size(), 1U);
    EXPECT_EQ(lcp.rows[0].constraint, 0);
    EXPECT_NEAR(lcp.problem.DiagonalA()[0], 1 / world.bodies[2].mass, 1e-12);
    world.joints[0].type = ConstraintType::kRod;
    EXPECT_THROW(AssembleContactLcp(InstantOf(world, {})), InputError);
    for (const MotionLevel level : kBothLevels) {
      EXPECT_THROW(Mover(level, world)->Advance(0.1), InputError);
    }
  }
}

}  // namespace
}  // namespace lcpbench
