// How the families start to move: under gravity and drives alone, and slowly where bodies lie still otherwise.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr const char* kContactFamilies[] = {"discs-in-v", "disc-pile", "disc-track", "boxes-and-discs", "rockers"};

TEST(SceneStarts, HaveNoLoadButGravityInTheFamiliesOfContacts) {
  for (const std::string key : kContactFamilies) {
    for (const int rows : {1, 10, 100}) {
      const World world = StartScene(key, rows, 3);
      EXPECT_TRUE(world.loads.wrenches.empty()) << key;
      EXPECT_TRUE(world.loads.thrusters.empty()) << key;
      EXPECT_EQ(world.loads.gravity.x, 0) << key;
      EXPECT_LE(world.loads.gravity.y, key == "disc-track" ? -0.05 * kGravity : -kGravity) << key;
      for (const Body& body : world.bodies) {
        EXPECT_EQ(Norm(body.force), 0);
        EXPECT_EQ(body.torque, 0);
      }
    }
  }
}

TEST(SceneStarts, AreSlowAgainstAFallByABodysSize) {
  for (const std::string key : {"discs-in-v", "disc-pile", "boxes-and-discs"}) {
    const World world = StartScene(key, 100, 3);
    double fastest = 0;
    for (const Body& body : world.bodies) {
      if (body.fixed) {
        EXPECT_EQ(Norm(body.v), 0);
        continue;
      }
      fastest = std::max(fastest, Norm(body.v));
      EXPECT_LE(std::abs(body.omega) * std::sqrt(body.inertia / body.mass), kStir);
    }
    EXPECT_GT(fastest, kStir / 2) << key;
    EXPECT_LE(fastest, kStir) << key;
  }
}

// Scaled or kept, velocities that hold every contact hold it still.
TEST(SceneStarts, KeepEveryContactWhereTheProblemDoes) {
  for (const char* key : {"disc-track", "rockers"}) {
    for (const int rows : {1, 12, 60}) {
      const World world = StartScene(key, rows, 2);
      const auto found = ContactFinder(world).Find(world.bodies, 1e-8, 1e-8);
      EXPECT_EQ(found.size(), static_cast<std::size_t>(rows));
      double speed = 0;
      for (const Body& body : world.bodies) speed = std::max(speed, Norm(body.v));
      EXPECT_GT(speed, 0.01);
      for (const RowInfo& row : AssembleContactLcp(InstantOf(world, found)).rows) {
        EXPECT_LE(std::abs(row.d_dot), 1e-10 * std::max(speed, 1.0)) << key;
      }
    }
  }
}

TEST(SceneStarts, StirTheSameForTheSameSeedOnly) {
  const World still = WorldUnderGravity(GenerateScene("disc-pile", 20, 1), {0, -kGravity});
  World first = still;
  World again = still;
  World other = still;
  Stir(&first, 0.5, 7);
  Stir(&again, 0.5, 7);
  Stir(&other, 0.5, 8);
  for (std::size_t i = 0; i < still.bodies.size(); ++i) {
    const auto bits = [i](const World& world) { return std::bit_cast<std::uint64_t>(world.bodies[i].v.x); };
    EXPECT_EQ(bits(first), bits(again));
    if (!still.bodies[i].fixed) {
      EXPECT_NE(bits(first), bits(other));
    }
  }
}

TEST(SceneParts, StepDiscsAlongAnArcTouchingItAndEachOther) {
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const double r1 = random.Uniform(0.01, 1);
    const double r2 = random.Uniform(0.01, 1);
    const double arc = r1 + r2 + random.Uniform(1e-3, 5);
    const Vec2 direction = random.UnitVector();
    const Vec2 next = NextAlongArc(direction, r1, r2, arc);
    EXPECT_NEAR(Norm(next), 1, 1e-15);
    EXPECT_GT(Cross(direction, next), 0);
    EXPECT_NEAR(Norm((arc - r2) * next - (arc - r1) * direction), r1 + r2, 1e-13 * arc);
  }
}

}  // namespace
}  // namespace lcpbench
