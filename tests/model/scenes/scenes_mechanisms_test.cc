// What holds of the families of mechanisms beyond what scenes_test.cc asks of all families: joints, their worlds in
// motion, and each family's own geometry.

#include <Eigen/Eigenvalues>

#include "model/contact/assembly.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "solvers/io/json_lines.h"
#include "solvers/registry.h"
#include "tests/model/scenes/scene_checks.h"

namespace lcpbench {
namespace {

class Mechanisms : public ::testing::TestWithParam<const char*> {
 protected:
  static ContactSystem Generate(int rows, std::uint64_t seed) { return GenerateScene(GetParam(), rows, seed); }
  static World Start(int rows, std::uint64_t seed) { return StartScene(GetParam(), rows, seed); }
};

const Body& BodyOf(const ContactSystem& system, int i) { return system.bodies[static_cast<std::size_t>(i)]; }

// With a handful of contacts it takes the loads at the ends to mix them for every seed.
TEST_P(Mechanisms, MixFewRowsForEverySeed) {
  const auto solver = MakeSolver("dantzig");
  for (const int rows : {10, 11, 12, 13, 14, 15, 20}) {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      const ContactSystem system = Generate(rows, seed);
      const double share = lcpbench::testing::SeparatingShare(system, solver.get());
      EXPECT_GT(share, 0) << system.name;
      EXPECT_LT(share, 1) << system.name;
    }
  }
}

TEST_P(Mechanisms, KeepJointsAndContactsTogetherForAMoment) {
  // Free motion for a time h opens no row by more than O(h^2): velocities lie along the constraints of the world, too.
  constexpr double kStep = 1e-4;
  for (const int rows : {10, 33}) {
    World world = Start(rows, 3);
    const std::vector<Constraint> contacts =
        ContactFinder(world).Find(world.bodies, 1e-8, lcpbench::testing::kSceneSize / 2);
    for (Body& body : world.bodies) {
      body.x = body.x + kStep * body.v;
      body.theta += kStep * body.omega;
    }
    for (const RowInfo& row : AssembleContactLcp(InstantOf(world, contacts)).rows) {
      EXPECT_LE(std::abs(row.d), kStep * kStep * (1 + 2 * std::abs(row.gamma))) << world.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Mechanisms,
                         ::testing::Values("gear-train", "cam-follower", "newtons-cradle", "chain-of-links",
                                           "spinning-drum", "oval-train"),
                         [](const auto& of) { return lcpbench::testing::TestNameOf(of.param); });

TEST(GearTrain, TurnsAlternatelyAtTheRatioOfTheTeeth) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const ContactSystem system = GenerateScene("gear-train", 300, seed);
    // By body: the teeth (four pieces each), and the tip radius.
    const auto teeth = [&](int i) { return static_cast<double>(BodyOf(system, i).outline.size()) / 4; };
    const auto tip = [&](int i) { return std::get<ArcEdge>(BodyOf(system, i).outline[1].edge).radius; };
    const AssembledLcp lcp = AssembleContactLcp(system);
    double first = 0;
    for (const RowInfo& row : lcp.rows) {
      if (row.bilateral) continue;
      const Constraint& c = system.constraints[static_cast<std::size_t>(row.constraint)];
      const Body& gear = BodyOf(system, c.body1);
      const Body& before = BodyOf(system, c.body2);
      if (first == 0) first = std::abs(before.omega * teeth(c.body2));
      ASSERT_LT(gear.omega * before.omega, 0) << system.name;
      EXPECT_NEAR(std::abs(gear.omega * teeth(c.body1)) / first, 1, 0.25) << system.name << ", " << gear.name;
      // The teeth meet where the tip circles overlap.
      EXPECT_LE(Norm(row.p1 - gear.x), tip(c.body1) * (1 + 1e-9)) << system.name;
      EXPECT_LE(Norm(row.p1 - before.x), tip(c.body2) * (1 + 1e-9)) << system.name;
    }
  }
}

TEST(NewtonsCradle, HangsOnRodsWithCentripetalAcceleration) {
  const ContactSystem system = GenerateScene("newtons-cradle", 101, 4);
  const AssembledLcp lcp = AssembleContactLcp(system);
  int hanging = 0;
  for (const RowInfo& row : lcp.rows) {
    const Constraint& c = system.constraints[static_cast<std::size_t>(row.constraint)];
    if (c.type != ConstraintType::kRod && c.type != ConstraintType::kRope) continue;
    ++hanging;
    const Vec2 v = BodyOf(system, c.body1).v;
    // d'' = |v|^2 / L of a rod whose end moves across it, and the opposite of a rope.
    EXPECT_NEAR(std::abs(row.gamma), Dot(v, v) / c.length, 1e-12);
    EXPECT_EQ(row.gamma > 0, c.type == ConstraintType::kRod);
  }
  EXPECT_GE(hanging, 30);
}

// In a rigid rotation with angular velocity omega and acceleration alpha about the origin, every gap keeps its value:
// d'' = J a + gamma = 0 with a = alpha z x x - omega^2 x. It holds of curvature terms of every kind of edge.
TEST(RigidRotation, KeepsEveryGapOfDrumsAndChains) {
  for (const char* key : {"spinning-drum", "chain-of-links"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const ContactSystem system = GenerateScene(key, 201, seed);
      const Body& drum = system.bodies[0];
      const auto accelerations = lcpbench::testing::GapAccelerationInRotation(system, drum.omega, drum.alpha);
      EXPECT_LE(accelerations.cwiseAbs().maxCoeff(), 1e-10 * kGravity) << system.name;
    }
  }
}

}  // namespace
}  // namespace lcpbench
