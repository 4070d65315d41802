#include "model/contact/world.h"

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

World SmallWorld() {
  World world;
  world.name = "small";
  world.bodies.resize(3);
  world.bodies[0].fixed = true;
  world.bodies[1].name = "arm";
  world.bodies[2].x = {1, 0};
  world.joints = {{ConstraintType::kPin, 1, 0, Vertex{}, Vertex{}}};
  world.loads.gravity = {0, -10};
  return world;
}

// The text of the error that a change of a valid world leads to.
std::string ErrorAfter(const std::function<void(World*)>& change) {
  World world = SmallWorld();
  RequireValid(world);
  change(&world);
  return RefusalOf([&] { RequireValid(world); });
}

TEST(World, ErrorsNameTheWorldAndTheBodyOrJoint) {
  const auto expect = [](const std::function<void(World*)>& change, const std::string& part) {
    const std::string text = ErrorAfter(change);
    EXPECT_NE(text.find("world 'small'"), std::string::npos) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  expect([](World* w) { w->bodies[1].mass = 0; }, "body 1 'arm': the mass");
  expect([](World* w) { w->bodies[1].mass = kNan; }, "body 1 'arm': the mass");
  expect([](World* w) { w->bodies[2].inertia = -1; }, "body 2: the inertia");
  expect([](World* w) { w->bodies[0].x.x = kNan; }, "body 0");
  expect([](World* w) { w->bodies[0].alpha = kNan; }, "body 0");
  expect([](World* w) { w->bodies[1].omega = std::numeric_limits<double>::infinity(); }, "body 1 'arm': the velocity");
  expect([](World* w) { w->joints[0].body2 = 3; }, "joint 0: expected the indices");
  expect([](World* w) { w->joints[0].body2 = -1; }, "joint 0: expected the indices");
  expect([](World* w) { w->joints[0].body2 = 1; }, "joint 0: expected the indices");
  expect([](World* w) { w->joints[0].type = ConstraintType::kContact; }, "joint 0: contacts are found");
}

TEST(World, AFixedBodyNeedsNoMassAndLoadsAreChecked) {
  EXPECT_EQ(ErrorAfter([](World* w) { w->bodies[0].mass = 0; }), "");
  EXPECT_NE(ErrorAfter([](World* w) { w->loads.wrenches = {{{7, {}}, {1, 0}, 0}}; }), "");
}

TEST(World, AnInstantHasTheJointsFirstAndTheBodiesUnderTheirLoads) {
  const World world = SmallWorld();
  const ContactSystem system = InstantOf(
      world, {{ConstraintType::kContact, 2, 0, ArcEdge{{}, 0.5, Side::kConvex}, StraightEdge{{5, -0.5}, {-5, -0.5}}}});
  ASSERT_EQ(system.constraints.size(), 2u);
  EXPECT_EQ(system.constraints[0].type, ConstraintType::kPin);
  EXPECT_EQ(system.constraints[1].type, ConstraintType::kContact);
  EXPECT_EQ(system.name, "small");
  EXPECT_EQ(system.bodies[0].force.y, 0);
  EXPECT_EQ(system.bodies[1].force.y, -10);
  EXPECT_EQ(world.bodies[1].force.y, 0);
  const AssembledLcp lcp = AssembleContactLcp(system);
  EXPECT_EQ(lcp.rows.size(), 3u);
}

// A scene's problem is that of the world made of it, with the scene's contacts.
TEST(World, TheWorldOfASceneGivesBackItsProblem) {
  for (const SceneFamily& family : AllScenes()) {
    const ContactSystem scene = family.generate(30, 4);
    const World world = WorldOf(scene);
    RequireValid(world);
    std::vector<Constraint> contacts;
    for (const Constraint& constraint : scene.constraints) {
      if (constraint.type == ConstraintType::kContact) contacts.push_back(constraint);
    }
    EXPECT_EQ(contacts.size() + world.joints.size(), scene.constraints.size());
    const AssembledLcp before = AssembleContactLcp(scene);
    const AssembledLcp after = AssembleContactLcp(InstantOf(world, contacts));
    ASSERT_EQ(before.problem.size(), after.problem.size()) << family.key;
    if (world.joints.empty()) {
      EXPECT_EQ(before.problem.b(), after.problem.b()) << family.key;
    }
    EXPECT_EQ(before.problem.inverse_mass(), after.problem.inverse_mass()) << family.key;
  }
}

}  // namespace
}  // namespace lcpbench
