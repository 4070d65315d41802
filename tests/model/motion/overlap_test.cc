// Bodies that overlap: how deep, by their outlines alone, and what motions of either level make of it.

#include "model/motion/contact_finder.h"
#include "tests/model/motion/mover.h"
#include "tests/model/scenes/scene_checks.h"
#include "tests/model/shape/random_outlines.h"

namespace lcpbench {
namespace {

using testing::AllPairKinds;
using testing::ContactCase;
using testing::PairKind;
using testing::Random;
using testing::RandomContact;
using testing::RandomOutline;

std::optional<BodyOverlap> DeepestOverlap(const World& world, double limit) {
  const ContactFinder finder(world);
  const std::vector<Constraint> contacts =
      finder.Find(world.bodies, 1e-9 * finder.least_width(), 0.25 * finder.least_width());
  const std::vector<BodyOverlap> overlaps = finder.FindOverlaps(world.bodies, contacts, limit);
  if (overlaps.empty()) return std::nullopt;
  return *std::max_element(overlaps.begin(), overlaps.end(),
                           [](const BodyOverlap& a, const BodyOverlap& b) { return a.depth < b.depth; });
}

// What a motion says of its start; "" where it takes it.
std::string RefusalAt(MotionLevel level, const World& world) {
  return RefusalOf([&] { Mover(level, world); });
}

void ExpectRefusedAtBothLevels(const World& world) {
  for (const MotionLevel level : kBothLevels) {
    const std::string refusal = RefusalAt(level, world);
    EXPECT_NE(refusal.find("overlap by"), std::string::npos) << ToString(level) << ": " << refusal;
    EXPECT_NE(refusal.find("(edge "), std::string::npos) << refusal;
    for (const Body& body : world.bodies) EXPECT_NE(refusal.find("'" + body.name + "'"), std::string::npos) << refusal;
  }
}

// The part of a feature around its contact point, 0.1 long, closed through the material.
Outline Around(const Feature& feature, std::optional<double> s, const Body& body, Vec2 p, Vec2 outward) {
  constexpr double kHalf = 0.05;
  constexpr double kThick = 0.15;
  const Vec2 c = BodyPoint(body, p);
  const Vec2 N = BodyPoint(body, body.x + outward);
  const Vec2 along = Perp(N);
  if (IsVertex(feature)) return testing::Polygon({c, c - kThick * N + kThick * along, c - kThick * N - kThick * along});
  OutlinePiece piece{StraightEdge{c - kHalf * along, c + kHalf * along}, 0, 1};
  if (!testing::IsStraight(feature)) {
    piece.edge = std::visit(
        [](const auto& e) -> OutlineCurve {
          if constexpr (requires { e.Point(0.0); }) return e;
          return StraightEdge{};
        },
        feature);
    double middle = s.value_or(0);
    if (const auto* arc = std::get_if<ArcEdge>(&feature)) middle = AngleOf(c - arc->center);
    const double speed = Norm(CurvePoint(piece.edge, middle + 1e-4) - CurvePoint(piece.edge, middle - 1e-4)) / 2e-4;
    const double reach = std::min(kHalf / speed, s && !std::holds_alternative<ArcEdge>(feature) ? 0.1 : 1.0);
    const double sense = testing::MaterialSide(feature);
    piece.s_begin = middle - sense * reach;
    piece.s_end = middle + sense * reach;
  }
  const Vec2 begin = CurvePoint(piece.edge, piece.s_begin);
  const Vec2 end = CurvePoint(piece.edge, piece.s_end);
  const std::vector<Vec2> back = {end, end - kThick * N, begin - kThick * N, begin};
  Outline outline{"piece", {{piece}}};
  for (std::size_t k = 0; k + 1 < back.size(); ++k) outline.loops[0].push_back(testing::Line(back[k], back[k + 1]));
  return outline;
}

World WorldOf(const ContactCase& c) {
  World world = WorldWith("pair", {c.body1, c.body2});
  world.bodies[0].name = "one";
  world.bodies[1].name = "two";
  world.bodies[1].fixed = true;
  for (Body& body : world.bodies) {
    body.v = {};
    body.omega = 0;
  }
  world.bodies[0].outline = AllPieces(Around(c.feature1, c.s1, c.body1, c.p1, -c.n));
  world.bodies[1].outline = AllPieces(Around(c.feature2, c.s2, c.body2, c.p2, c.n));
  return world;
}

class PairsThatOverlap : public ::testing::TestWithParam<PairKind> {};

TEST_P(PairsThatOverlap, AreToldByTheirDepthAndTreatedOrRefused) {
  constexpr double kDepths[] = {1e-9, 1e-7, 5e-6, 2e-5, 1e-4, 1e-3, 5e-3};
  Random random(17);
  for (const double depth : kDepths) {
    SCOPED_TRACE(depth);
    World world = WorldOf(RandomContact(GetParam(), -depth, &random));
    const std::optional<BodyOverlap> overlap = DeepestOverlap(world, depth / 2);
    ASSERT_TRUE(overlap.has_value());
    EXPECT_NEAR(overlap->depth, depth, 1e-5 * depth + 1e-14);
    EXPECT_FALSE(DeepestOverlap(world, depth * 1.001 + 1e-14).has_value());

    const std::string refusal = RefusalAt(MotionLevel::kAcceleration, world);
    EXPECT_EQ(refusal != "", depth > 1e-5) << refusal;
    EXPECT_EQ(RefusalAt(MotionLevel::kVelocity, world), "");
    // What is taken is told as deep as it is.
    world.loads.gravity = {};
    const Mover motion(MotionLevel::kVelocity, world);
    motion.KeepMoving(1e-3);
    EXPECT_NEAR(motion->statistics().worst_penetration, depth, 1e-5 * depth + 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, PairsThatOverlap, ::testing::ValuesIn(AllPairKinds()),
                         ::testing::PrintToStringParamName());

std::vector<Outline> Shapes(Random* random) {
  std::vector<Outline> shapes = {Disc(0.3),          Box(0.7, 0.4),     RoundedBox(0.6, 0.4, 0.1),
                                 Capsule(0.5, 0.15), HalfDisc(0.4),     DShape(0.2, 0.3),
                                 Ring(0.4, 0.15),    Ellipse(0.5, 0.2), Superellipse(0.4, 0.3, 4),
                                 Bowl(0.6, 0.4, 1),  Cam(0.3, 0.1, 0.3)};
  for (int k = 0; k < 3; ++k) shapes.push_back(RandomOutline(random));
  return shapes;
}

World Two(const Outline& moving, Vec2 x, double theta, const Outline& fixed) {
  Body body = Movable(moving, x, theta);
  Body around = Movable(fixed, {});
  body.name = "one";
  around.name = "two";
  around.fixed = true;
  return WorldWith("two", {body, around});
}

TEST(Overlap, OfCoincidentBodiesIsRefused) {
  Random random(5);
  for (const Outline& shape : Shapes(&random)) {
    for (const double shift : {0.0, 1e-2}) {
      SCOPED_TRACE(::testing::Message() << shape.name << " " << shift);
      const double angle = random.Uniform(-3, 3);
      World world = Two(shape, {0.6 * shift, 0.8 * shift}, 0, shape);
      for (Body& body : world.bodies) body.theta = angle;
      const std::optional<BodyOverlap> overlap = DeepestOverlap(world, 1e-5);
      ASSERT_TRUE(overlap.has_value());
      // As deep as the shape is thick.
      EXPECT_GT(overlap->depth, 0.04);
      if (shape.name == Disc(1).name) {
        EXPECT_NEAR(overlap->depth, 0.3, 0.01);
      }
      ExpectRefusedAtBothLevels(world);
    }
  }
}

TEST(Overlap, OfABodyWithinAnotherIsRefused) {
  Random random(6);
  const std::vector<Outline> shapes = Shapes(&random);
  for (const Outline& outer : shapes) {
    const OutlineRegion region(Centered(outer), 0.05);
    const std::optional<Vec2> deepest = region.DeepestPoint();
    ASSERT_TRUE(deepest.has_value());
    const double room = region.At(*deepest, 0).depth;
    const Outline& shape = shapes[static_cast<std::size_t>(testing::RandomInteger(14, &random))];
    const Outline inner = testing::Scaled(Centered(shape), 0.3 * room);  // their radii are below 1.5
    const World world = Two(inner, *deepest, random.Uniform(-3, 3), outer);
    const std::optional<BodyOverlap> overlap = DeepestOverlap(world, 1e-5);
    ASSERT_TRUE(overlap.has_value()) << shape.name << " in " << outer.name;
    EXPECT_NEAR(overlap->depth, room, 0.1 * room) << shape.name << " in " << outer.name;
    ExpectRefusedAtBothLevels(world);
  }
}

constexpr int kSamples = 60;  // of a piece

TEST(OutlineRegion, KnowsDepthsAsDenseSamplesDo) {
  Random random(8);
  for (int k = 0; k < 30; ++k) {
    const Outline outline = RandomOutline(&random);
    Body body;
    body.outline = AllPieces(outline);
    const testing::Solid sampled(body, kSamples);
    const OutlineRegion region(OutlineOf(body), random.Uniform(0.01, 0.3));
    for (int j = 0; j < 40; ++j) {
      const Vec2 p = CurvePoint(outline.loops[0][0].edge, outline.loops[0][0].s_begin) + random.Vector(1.5);
      EXPECT_NEAR(region.At(p, 0).depth, sampled.Depth(p), 2e-4) << k << " " << j;
    }
  }
}

// The greatest of the common points' distances from either outline, on a grid.
double DepthOnAGrid(const World& world, double spacing) {
  const testing::Solid one(world.bodies[0], kSamples);
  const testing::Solid two(world.bodies[1], kSamples);
  double depth = 0;
  for (double x = -2; x < 2; x += spacing) {
    for (double y = -2; y < 2; y += spacing) {
      const double in_one = one.Depth({x, y});
      if (in_one <= 0) continue;
      const double in_two = two.Depth({x, y});
      if (in_two > 0) depth = std::max({depth, in_one, in_two});
    }
  }
  return depth;
}

TEST(Overlap, IsFoundWhereverBodiesHaveCommonPoints) {
  Random random(9);
  int overlapping = 0;
  for (int k = 0; k < 15; ++k) {
    SCOPED_TRACE(k);
    const Outline one = testing::Scaled(Centered(RandomOutline(&random)), 0.5);
    const Outline two = testing::Scaled(Centered(RandomOutline(&random)), random.Uniform(0.3, 1));
    const World world = Two(one, random.Vector(1.1), random.Uniform(-3, 3), two);
    constexpr double kGrid = 0.04;
    const double depth = DepthOnAGrid(world, kGrid);
    const std::optional<BodyOverlap> overlap = DeepestOverlap(world, 1e-6);
    overlapping += depth > 0 ? 1 : 0;
    ASSERT_TRUE(overlap.has_value() || depth == 0) << depth;
    // No deeper than there is, to the grid; and not much less, where bodies are far within each other.
    if (!overlap) continue;
    EXPECT_LE(overlap->depth, depth + 2 * kGrid);
    EXPECT_GE(overlap->depth, 0.5 * depth);
  }
  EXPECT_GT(overlapping, 5);
}

TEST(Overlap, OfWhatTouchesIsNone) {
  // Corners on faces, flush sides, next to and below the end of an open floor.
  const Outline box = Box(1, 0.2);
  const auto none = [](const World& world) { EXPECT_FALSE(DeepestOverlap(world, 1e-9).has_value()); };
  none(Two(box, {0.99, 0.2}, 0, box));
  none(Two(box, {1, 0}, 0, box));
  none(WorldWith("end", {Floor(1), Movable(Disc(0.3), {1.25, -0.2})}));
  none(WorldWith("on", {Floor(1), Movable(Disc(0.3), {0.9, 0.3})}));
}

class Still final : public LcpSolver {
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& /*options*/, LcpResult* result) override {
    result->f.setZero(problem.size());
    result->status = LcpStatus::kSolved;
  }
};

TEST(Overlap, ThatAppearsInAMotionEndsIt) {
  for (const bool open : {false, true}) {
    World world = WorldWith("through", {open ? Floor() : Fixed(Box(4, 2), {0, -1}), Movable(Disc(0.1), {0, 0.15})});
    world.bodies[1].name = "ball";
    Still nothing;
    const auto motion = MakeMotion(MotionLevel::kVelocity, world, {}, nothing);
    for (int k = 0; k < 100 && motion->status() == MotionStatus::kMoving; ++k) motion->Advance(0.01);
    EXPECT_EQ(motion->status(), MotionStatus::kOverlap) << open;
    EXPECT_NE(motion->detail().find("'ball' (edge 0) overlap by 0.0"), std::string::npos) << motion->detail();
    // A quarter of its width, and what it falls before that is looked for.
    EXPECT_NEAR(motion->statistics().worst_penetration, 0.06, 0.02);
    EXPECT_NEAR(motion->world().bodies[1].x.y, 0.1 - motion->statistics().worst_penetration, 2e-3);
  }
}

TEST(Overlap, OfABodyBetweenWallsThatCloseEndsTheMotion) {
  Body left = Fixed(Box(0.2, 1), {-0.21, 0});
  Body right = Fixed(Box(0.2, 1), {0.21, 0});
  left.v = {0.1, 0};
  right.v = {-0.1, 0};
  const World world = WorldWith("press", {left, right, Movable(Disc(0.1), {})}, {});
  const Mover motion(MotionLevel::kVelocity, world);
  motion->Advance(1);
  EXPECT_EQ(motion->status(), MotionStatus::kOverlap) << motion->detail();
  EXPECT_NEAR(motion->time(), 0.6, 0.05);
  EXPECT_NEAR(motion->statistics().worst_penetration, 0.05, 0.005);
  // The acceleration level never gets there.
  const Mover stuck(world);
  stuck->Advance(1);
  EXPECT_NE(stuck->status(), MotionStatus::kMoving);
}

TEST(Overlap, OfAFewTolerancesIsHeldWithoutAGainOfEnergy) {
  for (const double depth : {1e-9, 1e-7, 1e-6, 9e-6}) {
    Mover mover(WorldWith("rests", {Floor(), Movable(Disc(1.0 / 3), {0, 1.0 / 3 - depth})}));
    const double start = Energy(mover->world());
    mover->Advance(1);
    EXPECT_NEAR(mover.body(1).x.y, 1.0 / 3, 1e-7 + 1e-9) << depth;
    EXPECT_LE(Energy(mover->world()), start + 1e-9) << depth;
    EXPECT_NEAR(mover->statistics().worst_penetration, depth, 1e-5 * depth + 1e-15);
  }
}

TEST(Overlap, OfUpToAQuarterWidthIsProjectedOutAtTheVelocityLevel) {
  for (const double part : {1e-9, 1e-4, 0.01, 0.1, 0.24}) {
    const double depth = part * 0.2;
    const Mover motion(MotionLevel::kVelocity, WorldWith("parts", {Floor(), Movable(Disc(0.1), {0, 0.1 - depth})}, {}));
    motion->Advance(0.1);
    EXPECT_GE(motion.body(1).x.y, 0.1 - 1e-12) << part;
    EXPECT_NEAR(motion->statistics().worst_penetration, depth, 1e-9 * depth + 1e-15);
  }
  World world = WorldWith("deep", {Floor(), Movable(Disc(0.1), {0, 0.1 - 0.26 * 0.2})}, {});
  EXPECT_NE(RefusalAt(MotionLevel::kVelocity, world).find("overlap by 0.052 m; expected at most 0.05 m"),
            std::string::npos);
}

}  // namespace
}  // namespace lcpbench
