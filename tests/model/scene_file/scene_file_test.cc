#include "model/scene_file/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "model/detection/detection.h"
#include "model/shape/shapes.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

constexpr double kPi = 3.14159265358979323846;

SceneFile Parse(const std::string& text) { return ParseScene(text, "scene.json"); }

// A scene of the given bodies, and what follows them.
std::string Scene(const std::string& bodies, const std::string& rest = "") {
  return R"({"lcpbench_scene": 1, "bodies": [)" + bodies + "]" + rest + "}";
}

World WorldFrom(const std::string& bodies, const std::string& rest = "") { return Parse(Scene(bodies, rest)).world; }

std::string Movable(const std::string& shape) {
  return Scene(R"({"name": "b", "density": 1, "shape": )" + shape + "}");
}

std::string Chain(const std::string& path) {
  return Scene(R"({"name": "b", "fixed": true, "shape": {"chains": [)" + path + "]}}");
}

// The edges of a chain of a fixed body, which keep the frame they are drawn in.
std::vector<OutlineEdge> Edges(const std::string& path) { return Parse(Chain(path)).world.bodies[0].outline; }

void ExpectNear(Vec2 found, Vec2 expected, double tolerance = 1e-14) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
}

Vec2 BeginOf(const OutlineEdge& edge) { return CurvePoint(edge.edge, edge.s_begin); }
Vec2 EndOf(const OutlineEdge& edge) { return CurvePoint(edge.edge, edge.s_end); }

void ExpectSameOutline(const Body& found, const Body& expected) {
  ASSERT_EQ(found.outline.size(), expected.outline.size());
  for (std::size_t k = 0; k < found.outline.size(); ++k) {
    EXPECT_EQ(Describe(ToFeature(found.outline[k].edge)), Describe(ToFeature(expected.outline[k].edge)));
    EXPECT_EQ(found.outline[k].s_begin, expected.outline[k].s_begin);
    EXPECT_EQ(found.outline[k].s_end, expected.outline[k].s_end);
  }
}

struct ReadyMade {
  const char* json;
  Outline outline;
};

TEST(SceneFile, ReadyMadeShapesAreThoseOfTheLibraryToTheBit) {
  GearShape gear;
  gear.teeth = 7;
  const std::vector<ReadyMade> cases{
      {R"({"disc": {"radius": 0.7}})", Disc(0.7)},
      {R"({"box": {"width": 2, "height": 0.3}})", Box(2, 0.3)},
      {R"({"rounded_box": {"width": 2, "height": 1, "corner_radius": 0.2}})", RoundedBox(2, 1, 0.2)},
      {R"({"capsule": {"length": 2, "radius": 0.2}})", Capsule(2, 0.2)},
      {R"({"half_disc": {"radius": 0.7}})", HalfDisc(0.7)},
      {R"({"d_shape": {"straight": 0.6, "radius": 0.7}})", DShape(0.6, 0.7)},
      {R"({"ring": {"outer_radius": 0.9, "inner_radius": 0.7}})", Ring(0.9, 0.7)},
      {R"({"ellipse": {"a": 2, "b": 0.5}})", Ellipse(2, 0.5)},
      {R"({"superellipse": {"a": 2, "b": 0.5, "m": 6}})", Superellipse(2, 0.5, 6)},
      {R"({"gear": {"teeth": 7}})", Gear(gear)},
      {R"({"cam": {"base_radius": 0.5, "nose_radius": 0.2, "distance": 0.6}})", Cam(0.5, 0.2, 0.6)},
      {R"({"bowl": {"outer_radius": 1.2, "inner_radius": 1, "half_opening": 1.1}})", Bowl(1.2, 1, 1.1)}};
  for (const ReadyMade& shape : cases) {
    SCOPED_TRACE(shape.json);
    const Body found = Parse(Movable(shape.json)).world.bodies[0];
    const Body expected = MakeBody(shape.outline, 1);
    EXPECT_EQ(found.mass, expected.mass);
    EXPECT_EQ(found.inertia, expected.inertia);
    EXPECT_EQ(found.x.x, expected.x.x);
    EXPECT_EQ(found.x.y, expected.x.y);
    ExpectSameOutline(found, expected);
  }
}

// A quarter of the unit circle from (1, 0) to (0, 1), drawn in every way there is.
TEST(SceneFile, ArcsInAllFormsAreTheSameArc) {
  const std::string bulge = std::to_string(0) + ".41421356237309503";  // tan(pi / 8)
  for (const std::string& form :
       {R"({"to": [0, 1], "bulge": )" + bulge + "}", std::string(R"({"to": [0, 1], "radius": 1, "turns": "left"})"),
        std::string(R"({"to": [0, 1], "center": [0, 0], "turns": "left"})"),
        std::string(R"({"center": [0, 0], "sweep": 1.5707963267948966})"),
        std::string(R"({"center": [0, 0], "radius": 1, "s_begin": 0, "s_end": 1.5707963267948966})")}) {
    SCOPED_TRACE(form);
    const auto edges = Edges(R"([[1, 0], {"arc": )" + form + "}]");
    ASSERT_EQ(edges.size(), 1U);
    const auto* arc = std::get_if<ArcEdge>(&edges[0].edge);
    ASSERT_NE(arc, nullptr);
    EXPECT_EQ(arc->side, Side::kConvex);
    EXPECT_NEAR(arc->radius, 1, 1e-15);
    ExpectNear(arc->center, {});
    EXPECT_NEAR(edges[0].s_begin, 0, 1e-15);
    EXPECT_NEAR(edges[0].s_end, kPi / 2, 1e-15);
  }
}

TEST(SceneFile, ArcsOfARadiusTurnToTheirSideTheShortOrTheLongWay) {
  struct Case {
    const char* turns;
    const char* is_long;
    Vec2 center;
    double sweep;
  };
  // From (1, 0) to (0, 1): the centre is at (0, 0) or (1, 1).
  for (const Case& c : {Case{"left", "false", {0, 0}, kPi / 2}, Case{"left", "true", {1, 1}, 3 * kPi / 2},
                        Case{"right", "false", {1, 1}, -kPi / 2}, Case{"right", "true", {0, 0}, -3 * kPi / 2}}) {
    SCOPED_TRACE(std::string(c.turns) + ", long: " + c.is_long);
    const auto edges = Edges(std::string(R"([[1, 0], {"arc": {"to": [0, 1], "radius": 1, "turns": ")") + c.turns +
                             R"(", "long": )" + c.is_long + "}}]");
    ExpectNear(std::get<ArcEdge>(edges[0].edge).center, c.center);
    EXPECT_NEAR(edges[0].s_end - edges[0].s_begin, c.sweep, 1e-14);
    EXPECT_EQ(std::get<ArcEdge>(edges[0].edge).side, c.sweep > 0 ? Side::kConvex : Side::kConcave);
    ExpectNear(BeginOf(edges[0]), {1, 0});
    ExpectNear(EndOf(edges[0]), {0, 1});
  }
}

TEST(SceneFile, BulgesOfBothSignsAndAnySizeSweepFourTimesTheirArcTangent) {
  for (const double bulge : {-50.0, -2.0, -1.0, -0.3, -1e-6, 1e-6, 0.3, 1.0, 2.0, 50.0}) {
    SCOPED_TRACE(bulge);
    const auto edges = Edges(R"([[1, 2], {"arc": {"to": [-2, 3], "bulge": )" + std::to_string(bulge) + "}}]");
    EXPECT_NEAR(edges[0].s_end - edges[0].s_begin, 4 * std::atan(std::stod(std::to_string(bulge))), 1e-13);
    const double radius = std::get<ArcEdge>(edges[0].edge).radius;
    ExpectNear(BeginOf(edges[0]), {1, 2}, 1e-15 * (10 + radius));
    ExpectNear(EndOf(edges[0]), {-2, 3}, 1e-15 * (10 + radius));
  }
}

TEST(SceneFile, EllipsesThroughTwoPointsPassThroughThem) {
  for (const char* turns : {"left", "right"}) {
    for (const char* is_long : {"true", "false"}) {
      const auto edges = Edges(std::string(R"([[1, 0], {"ellipse": {"to": [0, 1], "a": 2, "b": 0.8, "phi": 0.4,)") +
                               R"("turns": ")" + turns + R"(", "long": )" + is_long + "}}]");
      SCOPED_TRACE(Describe(ToFeature(edges[0].edge)));
      ExpectNear(BeginOf(edges[0]), {1, 0});
      ExpectNear(EndOf(edges[0]), {0, 1});
      const double sweep = edges[0].s_end - edges[0].s_begin;
      EXPECT_EQ(sweep > 0, std::string(turns) == "left");
      EXPECT_EQ(std::abs(sweep) > kPi, std::string(is_long) == "true");
    }
  }
}

TEST(SceneFile, OvalsAboutACenterBeginAndEndAtTheirPoints) {
  for (const char* form : {R"({"ellipse": {"to": [1, 4], "center": [1, 2], "a": 2, "b": 3, "phi": 1.5707963267948966,)",
                           R"({"superellipse": {"to": [1, 4], "center": [1, 2], "a": 3, "b": 2, "m": 4,)"}) {
    SCOPED_TRACE(form);
    const auto edges = Edges(std::string("[[4, 2], ") + form + R"( "turns": "left"}}])");
    ExpectNear(BeginOf(edges[0]), {4, 2});
    ExpectNear(EndOf(edges[0]), {1, 4});
    EXPECT_NEAR(edges[0].s_end - edges[0].s_begin, kPi / 2, 1e-14);
  }
}

TEST(SceneFile, BezierEdgesBeginWhereTheEdgeBeforeEnds) {
  const auto edges = Edges(R"([[0, 0], [1, 0], {"bezier": {"control1": [2, 0], "control2": [2, 1], "to": [1, 1]}}])");
  ASSERT_EQ(edges.size(), 2U);
  const auto& P = std::get<BezierEdge>(edges[1].edge).P;
  const std::array<Vec2, 4> expected{Vec2{1, 0}, Vec2{2, 0}, Vec2{2, 1}, Vec2{1, 1}};
  for (std::size_t k = 0; k < P.size(); ++k) ExpectNear(P[k], expected[k], 0);
}

TEST(SceneFile, PositionAndVelocityAreThoseOfTheDrawingsOrigin) {
  const World world = WorldFrom(R"({"name": "plate", "density": 3, "position": [5, 6], "angle": 0.7,
      "velocity": [1, 2], "angular_velocity": 4, "shape": {"path": [[0, 0], [2, 0], [2, 1], [0, 1], [0, 0]]}})");
  const Body& body = world.bodies[0];
  const Vec2 arm = Rotate(SinCos(0.7), {1, 0.5});
  EXPECT_NEAR(body.mass, 6, 1e-14);
  EXPECT_NEAR(body.inertia, 6 * (4 + 1) / 12.0, 1e-14);
  ExpectNear(body.x, Vec2{5, 6} + arm);
  ExpectNear(body.v, Vec2{1, 2} + 4 * Perp(arm));
  ExpectNear(std::get<StraightEdge>(body.outline[0].edge).a, {-1, -0.5});
}

TEST(SceneFile, MassesComeFromDensityOrMassOrAreStated) {
  const std::string box = R"("shape": {"box": {"width": 2, "height": 1}})";
  const World world = WorldFrom(R"({"name": "a", "density": 5, )" + box + R"(}, {"name": "b", "mass": 10, )" + box +
                                R"(}, {"name": "c", "mass": 10, "inertia": 9, "center_of_mass": [0.5, 0], )" + box +
                                R"(}, {"name": "d", "mass": 2, "inertia": 3})");
  EXPECT_NEAR(world.bodies[0].mass, 10, 1e-14);
  EXPECT_EQ(world.bodies[1].mass, 10);
  EXPECT_NEAR(world.bodies[1].inertia, world.bodies[0].inertia, 1e-14);
  EXPECT_EQ(world.bodies[2].inertia, 9);
  ExpectNear(world.bodies[2].x, {0.5, 0}, 0);
  ExpectNear(std::get<StraightEdge>(world.bodies[2].outline[0].edge).a, {-1.5, -0.5}, 0);
  EXPECT_EQ(world.bodies[3].inertia, 3);
}

TEST(SceneFile, HolesTakeTheirMassAway) {
  const World world = WorldFrom(R"({"name": "frame", "density": 1, "shape": {"path": [[0, 0], [4, 0], [4, 4], [0, 4],
      [0, 0]], "holes": [[{"arc": {"center": [2, 2], "radius": 1, "turns": "right"}}]]}})");
  EXPECT_NEAR(world.bodies[0].mass, 16 - kPi, 1e-13);
}

TEST(SceneFile, PointsOfJointsAndLoadsAreGivenInTheDrawing) {
  const std::string plate = R"("density": 1, "shape": {"path": [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]}})";
  const World world = WorldFrom(
      R"({"name": "ground", "fixed": true, "position": [1, 0]}, {"name": "plate", "position": [3, 0], "angle": 1, )" +
          plate,
      R"(, "joints": [{"type": "pin", "body1": "plate", "body2": "ground", "point1": [0, 0], "point2": [2, 0]},
                      {"type": "pin", "body1": "plate", "body2": "ground", "at": [3, 0]},
                      {"type": "rod", "body1": "plate", "body2": "ground", "point1": [0, 0], "point2": [0, 0]},
                      {"type": "path", "body1": "ground", "body2": "plate", "point1": [2, 0], "edge2": 0},
                      {"type": "path", "body1": "ground", "body2": "plate", "point1": [2, 0],
                       "edge2": {"line": {"from": [0, 0], "to": [2, 0]}}}],
          "loads": {"wrenches": [{"body": "plate", "torque": 1}, {"body": "plate", "point": [2, 2], "force": [1, 0]}]})");
  ExpectNear(std::get<Vertex>(world.joints[0].feature1).p, {-1, -1});
  ExpectNear(std::get<Vertex>(world.joints[0].feature2).p, {2, 0}, 0);
  ExpectNear(std::get<Vertex>(world.joints[1].feature1).p, {-1, -1});
  ExpectNear(std::get<Vertex>(world.joints[1].feature2).p, {2, 0});
  EXPECT_NEAR(world.joints[2].length, 2, 1e-14);
  for (const int path : {3, 4}) {
    ExpectNear(std::get<StraightEdge>(world.joints.at(static_cast<std::size_t>(path)).feature2).b, {1, -1});
  }
  ExpectNear(world.loads.wrenches[0].at.point, {}, 0);
  ExpectNear(world.loads.wrenches[1].at.point, {1, 1});
}

TEST(SceneFile, EverySettingAndLoadArrives) {
  const SceneFile scene = Parse(Scene(
      R"({"name": "a", "mass": 1, "inertia": 1}, {"name": "b", "fixed": true, "mass": 4, "position": [3, 0],
         "velocity": [1, 2], "angular_velocity": 3, "acceleration": [4, 5], "angular_acceleration": 6})",
      R"(, "name": "all", "gravity": [1, -2], "motion": {"level": "velocity", "step": 0.25, "restitution": 0.5,
          "impact_law": "poisson", "resting_speed": 1e-6},
          "loads": {"springs": [{"body1": "a", "body2": "b", "stiffness": 2, "rest_length": 1}],
                    "dampers": [{"body1": "a", "body2": "b", "point1": [0, 1], "coefficient": 3}],
                    "thrusters": [{"body": "a", "force": [4, 5]}],
                    "attraction": {"strength": 6, "softening": 7}})"));
  EXPECT_EQ(scene.world.name, "all");
  EXPECT_EQ(scene.level, MotionLevel::kVelocity);
  EXPECT_EQ(scene.step, 0.25);
  EXPECT_EQ(scene.restitution, 0.5);
  EXPECT_EQ(scene.impact_law, ImpactLaw::kPoisson);
  EXPECT_EQ(scene.resting_speed, 1e-6);
  const Loads& loads = scene.world.loads;
  ExpectNear(loads.gravity, {1, -2}, 0);
  EXPECT_EQ(loads.springs.at(0).stiffness, 2);
  EXPECT_EQ(loads.springs.at(0).rest_length, 1);
  EXPECT_EQ(loads.dampers.at(0).coefficient, 3);
  ExpectNear(loads.dampers.at(0).end1.point, {0, 1}, 0);
  ExpectNear(loads.thrusters.at(0).force, {4, 5}, 0);
  EXPECT_EQ(loads.attraction.value().strength, 6);
  EXPECT_EQ(loads.attraction.value().softening, 7);
  const Body& b = scene.world.bodies.at(1);
  EXPECT_EQ(b.mass, 4);
  ExpectNear(b.v, {1, 2}, 0);
  ExpectNear(b.acceleration, {4, 5}, 0);
  EXPECT_EQ(b.omega, 3);
  EXPECT_EQ(b.alpha, 6);
  EXPECT_EQ(scene.world.bodies.at(0).force.x, 0) << "loads are tried out on the bodies, but not left there";
}

TEST(SceneFile, AWorldWithoutANameTakesThatOfItsFile) {
  EXPECT_EQ(ParseScene(R"({"lcpbench_scene": 1, "bodies": []})", "folder/two discs.json").world.name, "two discs");
}

TEST(SceneFile, TheExampleOfTheDocumentationIsAScene) {
  std::ostringstream page;
  page << std::ifstream(LCPBENCH_SOURCE_DIR "/docs/scenes.md").rdbuf();
  const std::string text = page.str();
  const std::size_t begin = text.find("{\n      \"lcpbench_scene\": 1");
  ASSERT_NE(begin, std::string::npos);
  const std::string end = "\n    }\n";
  const World world = Parse(text.substr(begin, text.find(end, begin) + end.size() - begin)).world;
  EXPECT_EQ(world.bodies.size(), 3U);
  EXPECT_EQ(world.joints.size(), 1U);
}

TEST(SceneFile, AFileThatIsNotThereIsNamed) {
  EXPECT_EQ(RefusalOf([] { ReadSceneFile("no such file.json"); }), "no such file.json: cannot be opened for reading");
}

struct Mistake {
  std::string what;   // for the test's output
  std::string text;   // of the file
  std::string path;   // the error begins with the file's name and this
  std::string words;  // and contains this
};

void ExpectErrors(const std::vector<Mistake>& mistakes) {
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.what);
    const auto parse = [&] { Parse(mistake.text); };
    ExpectRefused(parse, mistake.words, "scene.json: " + mistake.path);
    constexpr std::size_t kReadable = 700;
    EXPECT_LT(RefusalOf(parse).size(), kReadable);
  }
}

std::string WithBody(const std::string& fields) { return Scene(R"({"name": "b", )" + fields + "}"); }

const char* const kTwoBodies =
    R"({"name": "a", "mass": 1, "inertia": 1, "shape": {"disc": {"radius": 1}}}, {"name": "b", "fixed": true})";

std::string WithJoint(const std::string& joint) { return Scene(kTwoBodies, R"(, "joints": [)" + joint + "]"); }

// On two bodies without shape, whose centres of mass coincide.
std::string WithLoads(const std::string& loads) {
  return Scene(R"({"name": "a", "mass": 1, "inertia": 1}, {"name": "b", "fixed": true})",
               R"(, "loads": {)" + loads + "}");
}

TEST(SceneFileErrors, WhatIsNotJsonIsNamedWithLineAndColumn) {
  ExpectErrors({
      {"empty", "", "not valid JSON: line 1, column 1", ""},
      {"missing value", "{\n  \"lcpbench_scene\": 1,\n  \"bodies\": }\n", "not valid JSON: line 3, column 13", ""},
      {"cut off", "{\"lcpbench_scene\": 1, \"bodies\": [", "not valid JSON: line 1", "end of input"},
      {"two documents", "{} {}", "not valid JSON: line 1", ""},
      {"not a number", Scene(R"({"name": "b", "angle": NaN})"), "not valid JSON: line 1", ""},
      {"bad UTF-8", "{\"lcpbench_scene\": \"\xff\"}", "not valid JSON: line 1", "UTF-8"},
      {"a number beyond double", Movable(R"({"disc": {"radius": 1e999}})"),
       "/bodies/0/shape/disc/radius: ", "beyond the range of double"},
      {"a number beyond double in an array", Scene("", R"(, "gravity": [0, -1e999])"),
       "/gravity/1: ", "beyond the range of double"},
      {"a key that stands twice", Scene(R"({"name": "b"}, {"name": "c", "angle": 1, "angle": 2})"),
       "/bodies/1/angle: ", "twice"},
      {"nested very deep", std::string(100000, '['), "/0/0", "nested more than 32 deep"},
      {"a very long token", "[\"" + std::string(100000, 'x'), "not valid JSON: line 1", "..."},
  });
}

TEST(SceneFileErrors, WrongAndMissingFieldsAreNamed) {
  ExpectErrors({
      {"not an object", "[]", "/: ", "expected an object"},
      {"no version", "{}", "/lcpbench_scene: ", "missing field"},
      {"another version", R"({"lcpbench_scene": 2, "planets": []})", "/lcpbench_scene: ", "expected 1, found 2"},
      {"no bodies", R"({"lcpbench_scene": 1})", "/bodies: ", "missing field, expected an array"},
      {"unknown key", Scene("", R"(, "gravitation": [0, 0])"), "/: ", "unknown key \"gravitation\", expected one of"},
      {"unknown key of a body", WithBody(R"("colour": "red")"), "/bodies/0: ", "unknown key \"colour\""},
      {"a key of two lines", Scene("", R"(, "a\nb": 1)"), "/: ", "unknown key \"a\\nb\""},
      {"gravity as a number", Scene("", R"(, "gravity": 9.81)"), "/gravity: ", "expected an array of two numbers"},
      {"huge gravity", Scene("", R"(, "gravity": [0, 1e31])"), "/gravity: ", "expected numbers within -1e30..1e30"},
      {"unknown level", Scene("", R"(, "motion": {"level": "position"})"),
       "/motion/level: ", "expected one of acceleration, velocity"},
      {"restitution above 1", Scene("", R"(, "motion": {"restitution": 2})"), "/motion/restitution: ", "0..1"},
      {"resting speed below 0", Scene("", R"(, "motion": {"resting_speed": -1})"), "/motion/resting_speed: ", ">= 0"},
      {"resting speed in words", Scene("", R"(, "motion": {"resting_speed": "low"})"),
       "/motion/resting_speed: ", "a number"},
      {"unknown law", Scene("", R"(, "motion": {"impact_law": "Newton"})"),
       "/motion/impact_law: ", "one of newton, poisson"},
      {"step 0", Scene("", R"(, "motion": {"step": 0})"), "/motion/step: ", "expected a number > 0"},
      {"a body without a name", Scene(R"({"fixed": true})"), "/bodies/0/name: ", "missing field"},
      {"a body without letters", Scene(R"({"name": ""})"), "/bodies/0/name: ", "expected a name"},
      {"a name of two lines", Scene(R"({"name": "a\nb"})"), "/bodies/0/name: ", "control characters"},
      {"two bodies of one name", Scene(R"({"name": "a", "fixed": true}, {"name": "a", "fixed": true})"),
       "/bodies/1/name: ", "same name"},
      {"fixed as a number", WithBody(R"("fixed": 1)"), "/bodies/0/fixed: ", "expected true or false, found 1"},
      {"an angle in words", WithBody(R"("fixed": true, "angle": "30 deg")"),
       "/bodies/0/angle: ", "expected a number, found \"30 deg\""},
      {"a position in space", WithBody(R"("fixed": true, "position": [1, 2, 3])"),
       "/bodies/0/position: ", "expected an array of two numbers"},
  });
}

TEST(SceneFileErrors, MassesThatAreMissingOrContradictEachOther) {
  const std::string box = R"("shape": {"box": {"width": 1, "height": 1}}, )";
  ExpectErrors({
      {"no mass", WithBody(R"("shape": {"disc": {"radius": 1}})"), "/bodies/0: ", "expected \"density\" or \"mass\""},
      {"density without shape", WithBody(R"("density": 1)"), "/bodies/0/density: ", "no area"},
      {"density 0", WithBody(box + R"("density": 0)"), "/bodies/0/density: ", "expected a number > 0"},
      {"negative mass", WithBody(box + R"("mass": -1)"), "/bodies/0/mass: ", "expected a number > 0"},
      {"a tiny mass", WithBody(box + R"("mass": 1e-300)"), "/bodies/0/mass: ", "expected a number > 0"},
      {"a tiny derived mass", WithBody(R"("density": 1e-30, "shape": {"disc": {"radius": 0.1}})"),
       "/bodies/0: ", "mass"},
      {"a huge derived velocity",
       WithBody(R"("mass": 1, "angular_velocity": 1e30, "shape": {"half_disc": {"radius": 9}})"),
       "/bodies/0: ", "velocity"},
      {"no inertia", WithBody(R"("mass": 1)"), "/bodies/0: ", "expected \"inertia\""},
      {"mass and density", WithBody(box + R"("mass": 1, "density": 1)"), "/bodies/0/mass: ", "does not go with"},
      {"centre of mass alone", WithBody(box + R"("mass": 1, "center_of_mass": [0, 0])"),
       "/bodies/0/center_of_mass: ", "needs \"inertia\""},
      {"centre of mass of a fixed body", WithBody(R"("fixed": true, "center_of_mass": [0, 0])"),
       "/bodies/0/center_of_mass: ", "fixed"},
      {"acceleration of a movable body", WithBody(box + R"("mass": 1, "acceleration": [0, 1])"),
       "/bodies/0/acceleration: ", "fixed bodies only"},
  });
}

TEST(SceneFileErrors, ShapesThatAreNone) {
  ExpectErrors({
      {"unknown name", Movable(R"("wheel")"), "/bodies/0/shape: ", "found \"wheel\""},
      {"unknown kind", Movable(R"({"star": {"radius": 1}})"),
       "/bodies/0/shape: ", "unknown key \"star\", expected one of"},
      {"two kinds", Movable(R"({"disc": {"radius": 1}, "box": {"width": 1, "height": 1}})"),
       "/bodies/0/shape: ", "exactly one of the keys"},
      {"radius 0", Movable(R"({"disc": {"radius": 0}})"), "/bodies/0/shape/disc/radius: ", "expected a number > 0"},
      {"negative radius", Movable(R"({"disc": {"radius": -2}})"), "/bodies/0/shape/disc/radius: ", "found -2"},
      {"missing radius", Movable(R"({"disc": {}})"), "/bodies/0/shape/disc/radius: ", "missing field"},
      {"unknown parameter", Movable(R"({"disc": {"radius": 1, "r": 1}})"),
       "/bodies/0/shape/disc: ", "unknown key \"r\""},
      {"corners that do not fit", Movable(R"({"rounded_box": {"width": 1, "height": 1, "corner_radius": 1}})"),
       "/bodies/0/shape/rounded_box: ", "twice the corner radius"},
      {"two teeth", Movable(R"({"gear": {"teeth": 2}})"), "/bodies/0/shape/gear/teeth: ", "3..1000"},
      {"teeth without end", Movable(R"({"gear": {"teeth": 2000000000}})"), "/bodies/0/shape/gear/teeth: ", "3..1000"},
      {"odd exponent", Movable(R"({"superellipse": {"a": 1, "b": 1, "m": 3}})"),
       "/bodies/0/shape/superellipse: ", "even"},
      {"aspect ratio", Movable(R"({"ellipse": {"a": 1e7, "b": 1}})"), "/bodies/0/shape/ellipse: ", "aspect ratio"},
      {"in the shapes", Scene("", R"(, "shapes": {"a/b": {"disc": {"radius": 0}}})"),
       "/shapes/a~1b/disc/radius: ", "expected a number > 0"},
      {"chains of a movable body", Movable(R"({"chains": [[[0, 0], [1, 0]]]})"),
       "/bodies/0/shape: ", "open outline: only a fixed body"},
      {"a movable body with named chains",
       Scene(R"({"name": "b", "density": 1, "shape": "floor"})",
             R"(, "shapes": {"floor": {"chains": [[[0, 0], [1, 0]]]}})"),
       "/bodies/0/shape: ", "open outline: only a fixed body"},
  });
}

TEST(SceneFileErrors, PathsNameTheirEdges) {
  const auto path = [](const std::string& items) { return Movable(R"({"path": [)" + items + "]}"); };
  ExpectErrors({
      {"empty", path(""), "/bodies/0/shape/path: ", "at least one edge"},
      {"a point only", path("[0, 0]"), "/bodies/0/shape/path: ", "at least one edge"},
      {"open", path("[0, 0], [1, 0], [0, 1]"),
       "/bodies/0/shape/path: ", "open outline: it ends at (0, 1), but begins at (0, 0)"},
      {"zero-length edge", path("[0, 0], [1, 0], [1, 0], [0, 1], [0, 0]"), "/bodies/0/shape/path/2: ", "zero-length"},
      {"a very short edge", path("[0, 0], [1, 0], [1, 1e-12], [0, 1], [0, 0]"),
       "/bodies/0/shape: outline 'b', outer boundary, edge 1", "zero-length"},
      {"clockwise", path("[0, 0], [0, 1], [1, 1], [1, 0], [0, 0]"), "/bodies/0/shape: outline 'b', outer boundary",
       "clockwise"},
      {"self-intersecting", path("[0, 0], [1, 1], [1, 0], [0, 1.5], [0, 0]"),
       "/bodies/0/shape: outline 'b', outer boundary, edge", "meet"},
      {"needle", path("[0, 0], [1, 0], [1, 1e-7], [0, 1e-7], [0, 0]"), "/bodies/0/shape: outline 'b', outer boundary",
       "aspect ratio"},
      {"a hole outside",
       Movable(R"({"path": [[0, 0], [1, 0], [0, 1], [0, 0]], "holes": [[[5, 5], [5, 6], [6, 6], [5, 5]]]})"),
       "/bodies/0/shape: outline 'b', hole 1", "outside"},
      {"an open hole", Movable(R"({"path": [[0, 0], [1, 0], [0, 1], [0, 0]], "holes": [[[0.1, 0.1], [0.1, 0.2]]]})"),
       "/bodies/0/shape/holes/0: ", "open outline"},
      {"a word", path(R"([0, 0], "line")"), "/bodies/0/shape/path/1: ", "expected an object"},
      {"unknown edge", path(R"([0, 0], {"spline": {}})"), "/bodies/0/shape/path/1: ", "unknown key \"spline\""},
      {"two edges in one", path(R"([0, 0], {"line": {"to": [1, 0]}, "arc": {}})"),
       "/bodies/0/shape/path/1: ", "exactly one of the keys"},
      {"no point to begin at", path(R"({"line": {"to": [1, 0]}})"),
       "/bodies/0/shape/path/0/line: ", "a point to begin at"},
      {"a coordinate in words", path(R"([0, 0], [1, "0"])"), "/bodies/0/shape/path/1/1: ", "expected a number"},
      {"stated edges apart", path(R"([0, 0], {"line": {"from": [1, 0], "to": [1, 1]}})"),
       "/bodies/0/shape/path/1: ", "begins at (1, 0), but what comes before it ends at (0, 0)"},
  });
}

TEST(SceneFileErrors, EdgesNameWhatDoesNotFit) {
  const auto arc = [](const std::string& form) { return Chain(R"([[0, 0], {"arc": )" + form + "}]"); };
  const std::string at = "/bodies/0/shape/chains/0/1/arc";
  const std::string oval = "/bodies/0/shape/chains/0/1/";
  ExpectErrors({
      {"radius 0", arc(R"({"to": [1, 0], "radius": 0, "turns": "left"})"), at + "/radius: ", "expected a number > 0"},
      {"a radius too small", arc(R"({"to": [1, 0], "radius": 0.4, "turns": "left"})"), at + ": ", "too small to reach"},
      {"no sense of turning", arc(R"({"to": [1, 0], "radius": 1})"), at + "/turns: ", "missing field"},
      {"both ways", arc(R"({"to": [1, 0], "radius": 1, "turns": "both"})"), at + "/turns: ", "one of left, right"},
      {"bulge 0", arc(R"({"to": [1, 0], "bulge": 0})"), at + "/bulge: ", "other than 0"},
      {"to where it begins", arc(R"({"to": [0, 0], "bulge": 1})"), at + ": ", "zero-length edge"},
      {"bulge and radius", arc(R"({"to": [1, 0], "bulge": 1, "radius": 1})"), at + ": ", "unknown key \"radius\""},
      {"a center in a corner", arc(R"({"to": [1, 0], "center": [0, 1], "turns": "left"})"), at + ": ",
       "not equally far from the center"},
      {"about itself", arc(R"({"center": [0, 0], "sweep": 1})"), at + ": ", "the radius must be > 0"},
      {"more than a turn", arc(R"({"center": [1, 0], "sweep": 7})"), at + ": ", "more than one full turn"},
      {"sweep 0", arc(R"({"center": [1, 0], "sweep": 0})"), at + ": ", "zero-length edge"},
      {"turns against its range", arc(R"({"center": [1, 0], "radius": 1, "s_begin": 0, "s_end": 1, "turns": "right"})"),
       at + "/turns: ", "turns left where"},
      {"aspect ratio", Chain(R"([[0, 0], {"ellipse": {"to": [1, 0], "a": 1e4, "b": 1e-4, "turns": "left"}}])"),
       oval + "ellipse: ", "aspect ratio"},
      {"off the ellipse",
       Chain(R"([[0, 0], {"ellipse": {"to": [2, 0], "center": [1, 0], "a": 2, "b": 1, "turns": "left"}}])"),
       oval + "ellipse: ", "is not on the ellipse"},
      {"off the superellipse",
       Chain(
           R"([[0, 0], {"superellipse": {"to": [3, 0], "center": [1, 0], "a": 1, "b": 1, "m": 4, "turns": "left"}}])"),
       oval + "superellipse: ", "is not on the superellipse"},
      {"odd exponent",
       Chain(
           R"([[0, 0], {"superellipse": {"to": [2, 0], "center": [1, 0], "a": 1, "b": 1, "m": 5, "turns": "left"}}])"),
       oval + "superellipse/m: ", "an even integer"},
      {"three control points", Chain(R"([{"bezier": {"points": [[0, 0], [1, 0], [1, 1]]}}])"),
       "/bodies/0/shape/chains/0/0/bezier/points: ", "expected an array of 4"},
      {"past its end", Chain(R"([{"line": {"from": [0, 0], "to": [1, 0], "s_end": 2}}])"),
       "/bodies/0/shape/chains/0/0/line: ", "within 0..1"},
  });
}

TEST(SceneFileErrors, JointsNameWhatDoesNotFit) {
  const std::string ends = R"("body1": "a", "body2": "b", )";
  ExpectErrors({
      {"unknown type", WithJoint(R"({"type": "weld"})"), "/joints/0/type: ", "one of pin, path, rod, rope"},
      {"unknown body", WithJoint(R"({"type": "pin", "body1": "a", "body2": "c", "at": [0, 0]})"),
       "/joints/0/body2: ", "expected the name of a body, found \"c\""},
      {"a body by its number", WithJoint(R"({"type": "pin", "body1": 0, "body2": "b", "at": [0, 0]})"),
       "/joints/0/body1: ", "expected a string"},
      {"one body", WithJoint(R"({"type": "pin", "body1": "a", "body2": "a", "at": [0, 0]})"),
       "/joints/0/body2: ", "another body"},
      {"no points", WithJoint(R"({"type": "pin", )" + ends + R"("point1": [0, 0]})"), "/joints/0/point2: ", "missing"},
      {"length of a pin", WithJoint(R"({"type": "pin", )" + ends + R"("at": [0, 0], "length": 1})"),
       "/joints/0: ", "unknown key \"length\""},
      {"length 0", WithJoint(R"({"type": "rope", )" + ends + R"("point1": [0, 0], "point2": [1, 0], "length": 0})"),
       "/joints/0/length: ", "expected a number > 0"},
      {"no distance", WithJoint(R"({"type": "rod", )" + ends + R"("point1": [0, 0], "point2": [0, 0]})"),
       "/joints/0: ", "the points coincide"},
      {"a path without an edge", WithJoint(R"({"type": "path", )" + ends + R"("point1": [0, 0], "point2": [0, 0]})"),
       "/joints/0: ", "expected point1 and edge2, or edge1 and point2"},
      {"no such edge", WithJoint(R"({"type": "path", )" + ends + R"("edge1": 1, "point2": [0, 0]})"),
       "/joints/0/edge1: ", "an integer in [0, 1)"},
      {"an edge of nothing", WithJoint(R"({"type": "path", )" + ends + R"("point1": [0, 0], "edge2": 0})"),
       "/joints/0/edge2: ", "the body has no shape"},
      {"an edge that needs a point",
       WithJoint(R"({"type": "path", )" + ends + R"("point1": [0, 0], "edge2": {"line": {"to": [0, 0]}}})"),
       "/joints/0/edge2/line: ", "a point to begin at"},
      {"an empty path", WithJoint(R"({"type": "path", )" + ends + R"("point1": [0, 0], "edge2": []})"),
       "/joints/0/edge2: ", "expected a path"},
      {"a path that tears",
       WithJoint(R"({"type": "path", )" + ends +
                 R"("point1": [0, 0], "edge2": [[0, 0], [1, 0], {"line": {"from": [2, 0], "to": [3, 0]}}]})"),
       "/joints/0/edge2/2: ", "the edge begins at (2, 0)"},
      {"edges that do not join",
       Scene(
           R"({"name": "a", "density": 1, "shape": {"box": {"width": 1, "height": 1}}}, {"name": "b", "fixed": true})",
           R"(, "joints": [{"type": "path", "body1": "a", "body2": "b", "edge1": [0, 2], "point2": [0, 0]}])"),
       "/joints/0/edge1: ", "edge 1 of its path does not begin where the one before ends"},
      {"a number and a point", WithJoint(R"({"type": "path", )" + ends + R"("edge1": [0, [1, 0]], "point2": [0, 0]})"),
       "/joints/0/edge1/1: ", "an integer in [0, 1)"},
  });
}

TEST(SceneFileErrors, LoadsNameWhatDoesNotFit) {
  ExpectErrors({
      {"unknown load", WithLoads(R"("magnets": [])"), "/loads: ", "unknown key \"magnets\""},
      {"negative stiffness",
       WithLoads(R"("springs": [{"body1": "a", "body2": "b", "stiffness": -1, "rest_length": 0}])"),
       "/loads/springs/0/stiffness: ", "expected a number >= 0"},
      {"no rest length", WithLoads(R"("springs": [{"body1": "a", "body2": "b", "stiffness": 1}])"),
       "/loads/springs/0/rest_length: ", "missing field"},
      {"a spring of no direction",
       WithLoads(R"("springs": [{"body1": "a", "body2": "b", "stiffness": 1, "rest_length": 1}])"),
       "/loads/springs/0: ", "length 0"},
      {"a negative damper", WithLoads(R"("dampers": [{"body1": "a", "body2": "b", "coefficient": -1}])"),
       "/loads/dampers/0/coefficient: ", "expected a number >= 0"},
      {"a damper of no direction", WithLoads(R"("dampers": [{"body1": "a", "body2": "b", "coefficient": 1}])"),
       "/loads/dampers/0: ", "length 0"},
      {"a thruster on nothing", WithLoads(R"("thrusters": [{"body": "c", "force": [0, 1]}])"),
       "/loads/thrusters/0/body: ", "expected the name of a body"},
      {"a force in words", WithLoads(R"("wrenches": [{"body": "a", "force": "up"}])"),
       "/loads/wrenches/0/force: ", "expected an array of two numbers"},
      {"attraction of coincident bodies", WithLoads(R"("attraction": {"strength": 1})"),
       "/loads/attraction: ", "coincide"},
  });
}

// Memory grows with the file: a short file cannot ask for many copies of a long shape.
TEST(SceneFileErrors, TooManyEdgesForTheFilesLength) {
  std::string bodies;
  for (int i = 0; i < 30; ++i) {
    bodies += (i == 0 ? "" : ", ") + (R"({"name": "g)" + std::to_string(i)) + R"(", "density": 1, "shape": "gear"})";
  }
  const std::string scene = Scene(bodies, R"(, "shapes": {"gear": {"gear": {"teeth": 1000, "root_radius": 0.9999}}})");
  ExpectRefused([&] { Parse(scene); }, "edges in all");
}

}  // namespace
}  // namespace lcpbench
