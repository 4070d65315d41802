#include "model/shape/shapes.h"

#include "tests/model/shape/random_outlines.h"

namespace lcpbench::testing {
namespace {

constexpr int kShapes = 12;

// Every shape with random parameters.
Outline RandomShape(int kind, Random* random) {
  const double p = random->Uniform(0.1, 3);
  const double q = random->Uniform(0.1, 3);
  const double share = random->Uniform(0.05, 0.95);
  const std::function<Outline()> shapes[kShapes] = {
      [&] { return Disc(p); },
      [&] { return Box(p, q); },
      [&] { return RoundedBox(p, q, share * std::min(p, q) / 2); },
      [&] { return Capsule(p, q); },
      [&] { return HalfDisc(p); },
      [&] { return DShape(p, q); },
      [&] { return Ring(p, share * p); },
      [&] { return Ellipse(p, q); },
      [&] { return Superellipse(p, q, 2 + 2 * RandomInteger(10, random)); },
      [&] {
        GearShape gear;
        gear.teeth = 5 + RandomInteger(30, random);
        gear.tip_radius = p;
        gear.root_radius = random->Uniform(0.6, 0.95) * p;
        gear.tip_share = random->Uniform(0.1, 0.4);
        gear.foot_share = random->Uniform(0.4, 0.9);
        gear.flank_radius = random->Uniform(1, 3) * p;
        return Gear(gear);
      },
      [&] { return Cam(p, share * p, p * random->Uniform(1, 4)); },
      [&] { return Bowl(p, share * p, random->Uniform(1.58, 3)); }};
  return shapes[kind]();
}

TEST(Shapes, AreValidForRandomParametersAndStayValidWhenMoved) {
  Random random(1);
  for (int kind = 0; kind < kShapes; ++kind) {
    for (int k = 0; k < 100; ++k) {
      Outline shape;
      ASSERT_NO_THROW(shape = RandomShape(kind, &random)) << kind;
      SCOPED_TRACE(shape.name);
      EXPECT_NO_THROW(RequireValid(Transformed(shape, random.Uniform(-3, 3), random.Vector(10))));
      EXPECT_NO_THROW(RequireValid(Centered(shape)));
    }
  }
}

TEST(Shapes, ThatAreSymmetricHaveTheirCentreOfMassThere) {
  Random random(2);
  for (const int kind : {0, 1, 2, 3, 6, 7, 8, 9}) {
    const Outline shape = RandomShape(kind, &random);
    EXPECT_NEAR(Norm(ComputeMassProperties(shape, 1).center), 0, 1e-14) << shape.name;
  }
}

TEST(Shapes, BowlIsARingSectorWithRoundLips) {
  for (const double opening : {0.5, 1.3, 2.0, 3.0}) {
    const double R = 2;
    const double r = 1.6;
    const double lip = (R - r) / 2;
    const double area = (kPi - opening) * (R * R - r * r) + kPi * lip * lip;
    const MassProperties p = ComputeMassProperties(Bowl(R, r, opening), 1);
    EXPECT_NEAR(p.area / area, 1, 1e-13);
    EXPECT_NEAR(p.center.x, 0, 1e-13);
    EXPECT_LT(p.center.y, 0);
  }
}

TEST(Shapes, CamHasTheAreaOfTwoSectorsAndTwoTrapezia) {
  const double R = 1;
  const double d = 1.5;
  for (const double r : {0.4, 1.0}) {
    const double angle = std::acos((R - r) / d);
    const double area = R * R * (kPi - angle) + r * r * angle + d * std::sin(angle) * (R + r);
    EXPECT_NEAR(ComputeMassProperties(Cam(R, r, d), 1).area / area, 1, 1e-13);
  }
}

TEST(Shapes, GearLiesBetweenItsCirclesAndRepeatsByTooth) {
  GearShape shape;
  const Outline gear = Gear(shape);
  EXPECT_EQ(gear.loops[0].size(), 4U * 12U);
  const double area = ComputeMassProperties(gear, 1).area;
  EXPECT_GT(area, kPi * shape.root_radius * shape.root_radius);
  EXPECT_LT(area, kPi * shape.tip_radius * shape.tip_radius);
  const double pitch = 2 * kPi / shape.teeth;
  for (std::size_t k = 0; k + 4 < gear.loops[0].size(); ++k) {
    const OutlinePiece& piece = gear.loops[0][k];
    const OutlinePiece& next = gear.loops[0][k + 4];
    const Vec2 turned = Rotate(SinCos(pitch), CurvePoint(piece.edge, piece.s_begin));
    EXPECT_NEAR(Norm(turned - CurvePoint(next.edge, next.s_begin)), 0, 1e-14);
  }
}

TEST(Shapes, AcceptAspectRatiosUpToAMillionAndRefuseMore) {
  EXPECT_NO_THROW(Box(1e6, 1));
  EXPECT_NO_THROW(Box(1, 1e6));
  EXPECT_NO_THROW(Ellipse(1e6, 1));
  EXPECT_NO_THROW(Superellipse(1, 1e6, 6));
  EXPECT_NO_THROW(Capsule(1e6, 1));
  EXPECT_NO_THROW(RoundedBox(1e6, 1, 0.2));
  EXPECT_THROW(Box(1.1e6, 1), InputError);
  EXPECT_THROW(Box(1, 1e12), InputError);
  EXPECT_THROW(Ellipse(1, 1.1e6), InputError);
  EXPECT_THROW(Superellipse(1e7, 1, 4), InputError);
  EXPECT_THROW(Capsule(1e8, 1), InputError);
  for (const double angle : {0.3, 0.7, 2.0}) {
    EXPECT_NO_THROW(RequireValid(Transformed(Box(1e6, 1), angle, {})));
    EXPECT_NO_THROW(RequireValid(Transformed(Ellipse(1e6, 1), angle, {})));
    EXPECT_NO_THROW(RequireValid(Transformed(Superellipse(1e6, 1, 4), angle, {})));
    EXPECT_NO_THROW(RequireValid(Transformed(Capsule(1e5, 1), angle, {})));
  }
}

TEST(Shapes, RefuseParametersOutsideTheirRanges) {
  GearShape few;
  few.teeth = 2;
  GearShape inverted;
  inverted.root_radius = 1.5;
  GearShape tight;
  tight.flank_radius = 0.01;
  GearShape wide;
  wide.foot_share = 1.2;
  const std::vector<std::function<Outline()>> wrong = {[] { return RoundedBox(2, 1, 0.5); },
                                                       [] { return Ring(1, 1); },
                                                       [] { return Ring(1, 2); },
                                                       [] { return Superellipse(1, 1, 3); },
                                                       [] { return Superellipse(1, 1, 0); },
                                                       [] { return Cam(1, 0.5, 0.4); },
                                                       [] { return Cam(0.5, 1, 2); },
                                                       [] { return Bowl(1, 0.5, 4); },
                                                       [] { return Bowl(1, 0.5, 0.1); },
                                                       [&] { return Gear(few); },
                                                       [&] { return Gear(inverted); },
                                                       [&] { return Gear(tight); },
                                                       [&] { return Gear(wide); }};
  for (std::size_t k = 0; k < wrong.size(); ++k) EXPECT_THROW(wrong[k](), InputError) << k;
  for (const double bad : {0.0, -1.0, kNaN, kInfinity, 1e200, 1e-200}) {
    const std::vector<std::function<Outline()>> shapes = {
        [&] { return Disc(bad); },       [&] { return Box(bad, 1); },      [&] { return Box(1, bad); },
        [&] { return Capsule(1, bad); }, [&] { return HalfDisc(bad); },    [&] { return DShape(1, bad); },
        [&] { return Ring(1, bad); },    [&] { return Ellipse(bad, 1); },  [&] { return Superellipse(1, bad, 4); },
        [&] { return Cam(bad, 1, 1); },  [&] { return Bowl(bad, 1, 1.6); }};
    for (std::size_t k = 0; k < shapes.size(); ++k) EXPECT_THROW(shapes[k](), InputError) << k << " " << bad;
  }
}

}  // namespace
}  // namespace lcpbench::testing
