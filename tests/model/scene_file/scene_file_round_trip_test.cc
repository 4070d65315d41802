// World -> file -> world, for generated worlds, the examples, and worlds of every kind of edge, joint and load; and
// files with mistakes.

#include "model/contact/assembly.h"
#include "model/contact/path.h"
#include "model/motion/contact_finder.h"
#include "model/scene_file/scene_file.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/fuzz/scene_mutation.h"

namespace lcpbench {
namespace {

void ExpectSameAfterRoundTrip(const SceneFile& scene) {
  const std::string text = FormatScene(scene);
  const SceneFile read = ParseScene(text, "written");
  EXPECT_TRUE(read.world == scene.world);
  EXPECT_EQ(read.level, scene.level);
  EXPECT_EQ(read.step, scene.step);
  EXPECT_EQ(read.restitution, scene.restitution);
  EXPECT_EQ(read.impact_law, scene.impact_law);
  EXPECT_EQ(read.resting_speed, scene.resting_speed);
  EXPECT_EQ(FormatScene(read), text);
}

std::vector<std::string> Examples() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(LCPBENCH_SOURCE_DIR "/data/scenes")) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".json") && !name.ends_with(".schema.json")) paths.push_back(entry.path().string());
  }
  // Directories are listed in any order.
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(SceneFileRoundTrip, GeneratedWorldsKeepEveryBit) {
  for (const SceneFamily& family : AllScenes()) {
    for (const int rows : {1, 10, 57, 200}) {
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        SceneFile scene;
        scene.world = family.start(rows, seed);
        scene.level = family.level;
        scene.step = family.step;
        SCOPED_TRACE(scene.world.name);
        ExpectSameAfterRoundTrip(scene);
        // The forces at the start, too, which the file does not hold but for their causes.
        const ContactSystem before = InstantOf(scene.world, {});
        const ContactSystem after = InstantOf(ParseScene(FormatScene(scene), "written").world, {});
        for (std::size_t i = 0; i < before.bodies.size(); ++i) {
          EXPECT_EQ(after.bodies[i].force.x, before.bodies[i].force.x);
          EXPECT_EQ(after.bodies[i].force.y, before.bodies[i].force.y);
          EXPECT_EQ(after.bodies[i].torque, before.bodies[i].torque);
        }
      }
    }
  }
}

TEST(SceneFileRoundTrip, ExamplesKeepEveryBit) {
  const std::vector<std::string> paths = Examples();
  ASSERT_GE(paths.size(), 8U);
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    ExpectSameAfterRoundTrip(ReadSceneFile(path));
  }
}

TEST(SceneFileRoundTrip, ExamplesHaveContactsOrJointsThatHoldAtTheStart) {
  for (const std::string& path : Examples()) {
    SCOPED_TRACE(path);
    const World world = ReadSceneFile(path).world;
    constexpr double kTolerance = 1e-9;
    const ContactFinder finder(world);
    const AssembledLcp assembled =
        AssembleContactLcp(InstantOf(world, finder.Find(world.bodies, kTolerance, kTolerance)));
    EXPECT_GE(assembled.rows.size(), 1U);
    for (const RowInfo& row : assembled.rows) EXPECT_NEAR(row.d, 0, kTolerance);
    // Nothing overlaps: a deeper search finds no more contacts.
    constexpr double kDeep = 0.05;
    const std::size_t deep = finder.Find(world.bodies, kTolerance, kDeep).size();
    EXPECT_EQ(deep, finder.Find(world.bodies, kTolerance, kTolerance).size());
  }
}

// A random world with one of everything that files can hold, full of numbers of all digits.
World RandomWorld(std::uint64_t seed) {
  Random random(seed);
  const auto number = [&random] { return random.Uniform(-3, 3); };
  const auto point = [&number] {
    const double x = number();
    const double y = number();
    return Vec2{x, y};
  };
  const auto size = [&random] { return random.Uniform(0.1, 2); };
  World world;
  world.name = "random " + std::to_string(seed);
  GearShape gear;
  gear.teeth = 5;
  const double big = size() + 1;
  const double small = size() / 3;
  for (const Outline& outline : {Disc(size()), Ellipse(size(), size()), Superellipse(size(), size(), 4), Gear(gear),
                                 Ring(big, small), Capsule(size(), size()), HalfDisc(size())}) {
    Body body = MakeBody(outline, size());
    body.name = outline.name;
    world.bodies.push_back(body);
  }
  Body fixed;
  fixed.name = "fixed";
  fixed.fixed = true;
  fixed.mass = size();
  fixed.inertia = size();
  fixed.acceleration = point();
  fixed.alpha = number();
  fixed.surface_speed = number();
  const Vec2 first = point();
  const Vec2 second = point();
  fixed.outline = {{StraightEdge{first, second}, 0.25, 0.75},
                   {BezierEdge{{point(), point(), point(), point()}}, 0.125, 1},
                   {EllipseEdge{point(), size(), size(), number(), Side::kConcave}, 1.5, -size()},
                   {ArcEdge{point(), size(), Side::kConvex}, -2, size()},
                   {SuperellipseEdge{point(), size(), size(), 6, number(), Side::kConvex}, -2, size()}};
  world.bodies.push_back(fixed);
  Body plain;
  plain.name = "without outline";
  plain.mass = size();
  plain.inertia = size();
  world.bodies.push_back(plain);
  for (Body& body : world.bodies) {
    body.x = point();
    body.theta = number();
    body.v = {number(), -0.0};
    body.omega = number();
    body.friction = size();
  }
  const auto last = static_cast<int>(world.bodies.size()) - 1;
  world.joints = {{ConstraintType::kPin, 0, last, Vertex{point()}, Vertex{point()}, {}, {}, 0, 0},
                  {ConstraintType::kRod, 1, last, Vertex{point()}, Vertex{point()}, {}, {}, 0, size()},
                  {ConstraintType::kRope, last, 2, Vertex{point()}, Vertex{point()}, {}, {}, 0, size()}};
  world.joints[0].torque_limit = size();
  world.joints[0].speed = number();
  for (const OutlineEdge& edge : fixed.outline) {
    Constraint path{ConstraintType::kPathJoint, 3, last - 1, Vertex{point()}, {}, {}, number(), number(), 0};
    std::visit([&path](const auto& e) { path.feature2 = e; }, edge.edge);
    world.joints.push_back(path);
    Constraint with_ends = path;
    with_ends.path = {edge};
    if (edge == fixed.outline[0])
      with_ends.path.push_back({StraightEdge{CurvePoint(edge.edge, edge.s_end), point()}, 0, 1});
    PutOnPath(world.bodies, &with_ends);
    world.joints.push_back(with_ends);
    std::swap(path.body1, path.body2);
    std::swap(path.feature1, path.feature2);
    std::swap(path.s1, path.s2);
    world.joints.push_back(path);
  }
  world.friction = {{0, 1, size()}, {last, 2, 0}};
  Loads& loads = world.loads;
  loads.gravity = point();
  loads.springs = {{{0, point()}, {1, point()}, size(), size()}, {{2, {}}, {last, point()}, size(), 0}};
  loads.dampers = {{{3, point()}, {4, point()}, size()}};
  loads.thrusters = {{{5, point()}, point()}};
  loads.wrenches = {{{6, point()}, point(), number()}, {{0, {}}, {}, number()}};
  loads.attraction = MutualAttraction{number(), size()};
  return world;
}

TEST(SceneFileRoundTrip, RandomWorldsOfEverythingKeepEveryBit) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    SceneFile scene;
    scene.world = RandomWorld(seed);
    scene.restitution = static_cast<double>(seed) / 128;
    scene.resting_speed = static_cast<double>(seed % 3) / 7;
    if (seed % 4 != 0) scene.impact_law = seed % 4 == 1 ? ImpactLaw::kNewton : ImpactLaw::kPoisson;
    ExpectSameAfterRoundTrip(scene);
    EXPECT_NE(FormatScene(scene).find("-0.0"), std::string::npos) << "the sign of a zero is kept";
  }
}

TEST(SceneFileRoundTrip, BodiesWithoutANameOfTheirOwnGetOne) {
  SceneFile scene;
  scene.world.name = "names";
  scene.world.bodies.resize(4);
  for (Body& body : scene.world.bodies) body.fixed = true;
  scene.world.bodies[1].name = "same";
  scene.world.bodies[2].name = "same";
  const World read = ParseScene(FormatScene(scene), "written").world;
  EXPECT_EQ(read.bodies[0].name, "body 0");
  EXPECT_EQ(read.bodies[1].name, "same");
  EXPECT_EQ(read.bodies[2].name, "same 2");
  EXPECT_EQ(read.bodies[3].name, "body 3");
}

TEST(SceneFileRoundTrip, WhatTheReaderWouldRefuseIsNotWritten) {
  SceneFile scene;
  scene.world.name = "open";
  scene.world.bodies.resize(1);
  scene.world.bodies[0].outline = {{StraightEdge{{0, 0}, {1, 0}}, 0, 1}};
  EXPECT_THROW(FormatScene(scene), InputError) << "a movable body with an open outline";
  scene.world.bodies[0].fixed = true;
  EXPECT_NO_THROW(FormatScene(scene));
  scene.world.bodies[0].outline = {{ArcEdge{{}, -1, Side::kConvex}, 0, 1}};
  EXPECT_THROW(FormatScene(scene), InputError) << "a negative radius";
}

// The fuzz target's laws (tests/fuzz) on seeded mutations of the examples, so that every compiler and every test run
// tries some: bytes changed, and values of the JSON tree replaced, removed, copied and renamed.
TEST(SceneFileMutations, GiveAValidWorldOrOneLineOfError) {
  std::vector<std::string> seeds = Corpus("corpus");
  for (std::string& scene : Corpus("../../data/scenes")) seeds.push_back(std::move(scene));
  ASSERT_GE(seeds.size(), 8U);
  Random random(1);
  std::mt19937 bytes(1);
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    const std::string& seed = seeds[Below(seeds.size(), &random)];
    const bool tree = random.Uniform() < 0.8;
    const std::string text = tree ? MutatedTree(seed, &random) : ChangedBytes(seed, seeds, &bytes);
    std::string broken;
    EXPECT_NO_THROW(broken = BrokenSceneLaw(text)) << text;
    EXPECT_EQ(broken, "") << text;
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace lcpbench
