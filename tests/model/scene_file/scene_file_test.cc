#include "model/scene_file/scene_file.h"

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
  const std::string text = ReadFile(LCPBENCH_SOURCE_DIR "/docs/scenes.md");
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

// The error of the text begins with the file's name and the path, and contains the words.
void ExpectError(const std::string& text, const std::string& path, const std::string& words) {
  SCOPED_TRACE(text.substr(0, 300));
  const auto parse = [&] { Parse(text); };
  ExpectRefused(parse, words, "scene.json: " + path);
  constexpr std::size_t kReadable = 700;
  EXPECT_LT(RefusalOf(parse).size(), kReadable);
}

TEST(SceneFileErrors, WhatIsNotJsonIsNamedWithLineAndColumn) {
  const std::string wrong = "not valid JSON: line 1";
  ExpectError("", wrong + ", column 1", "");
  ExpectError("{\n  \"lcpbench_scene\": 1,\n  \"bodies\": }\n", "not valid JSON: line 3, column 13", "");
  ExpectError("{\"lcpbench_scene\": 1, \"bodies\": [", wrong, "end of input");
  ExpectError("{} {}", wrong, "");
  ExpectError(Scene(R"({"name": "b", "angle": NaN})"), wrong, "");
  ExpectError("{\"lcpbench_scene\": \"\xff\"}", wrong, "UTF-8");
  ExpectError(std::string(100000, '['), "/0/0", "nested more than 32 deep");
  ExpectError("[\"" + std::string(100000, 'x'), wrong, "...");
}

TEST(SceneFileErrors, EachNamesItsPlaceAndWhatDoesNotFitThere) {
  for (const auto& mistake : RefusalCases("scene")) ExpectError(mistake[0], mistake[1], mistake[2]);
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
