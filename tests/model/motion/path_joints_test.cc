#include "model/motion/contact_finder.h"

#include "model/geometry/feature.h"
#include "model/scenes/scene.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

/// The smallest difference of two angles.
double AngleBetween(double a, double b) { return std::abs(std::remainder(a - b, 2 * kPi)); }

/// The world point of the joint's curve (its edge on body 2) at s2.
Vec2 PlaceOnCurve(const std::vector<Body>& bodies, const Constraint& joint) {
  const Body& body = bodies[static_cast<std::size_t>(joint.body2)];
  const auto* ellipse = std::get_if<EllipseEdge>(&joint.feature2);
  const OutlineCurve curve =
      ellipse != nullptr ? OutlineCurve(*ellipse) : OutlineCurve(std::get<SuperellipseEdge>(joint.feature2));
  return WorldPoint(body, CurvePoint(curve, joint.s2.value()));
}

Vec2 PlaceOfPoint(const std::vector<Body>& bodies, const Constraint& joint) {
  return WorldPoint(bodies[static_cast<std::size_t>(joint.body1)], std::get<Vertex>(joint.feature1).p);
}

TEST(PathJoints, AreFollowedToTheirPlaceOnTheCurve) {
  Random random(5);
  for (int k = 0; k < 200; ++k) {
    const double a = random.Uniform(1, 2);
    const double b = random.Uniform(0.6, 1) * a;
    const EllipseEdge oval{{0.1, -0.2}, a, b, random.Uniform(-kPi, kPi), Side::kConvex};
    std::vector<Body> bodies{MakeDisc({}, 0.1, 1), MakeFixed("track")};
    bodies[1].x = {random.Uniform(-1, 1), random.Uniform(-1, 1)};
    bodies[1].theta = random.Uniform(-kPi, kPi);
    const double s = random.Uniform(-kPi, kPi);
    bodies[0].x = WorldPoint(bodies[1], CurvePoint(oval, s));
    Constraint joint;
    joint.type = ConstraintType::kPathJoint;
    joint.feature1 = Vertex{};
    joint.feature2 = oval;
    joint.s2 = s + random.Uniform(-0.1, 0.1);
    std::vector<Constraint> joints{joint};
    FollowPathJoints(bodies, joints);
    EXPECT_FALSE(joints[0].s1.has_value());
    EXPECT_LE(AngleBetween(joints[0].s2.value(), s), 1e-9) << k;
  }
}

TEST(PathJoints, AreFoundWhereNoStartIsGivenAndOthersAreLeftAlone) {
  std::vector<Body> bodies{MakeDisc({0, 1}, 0.1, 1), MakeFixed("track")};
  Constraint on_curve;
  on_curve.type = ConstraintType::kPathJoint;
  on_curve.feature1 = Vertex{};
  on_curve.feature2 = EllipseEdge{{}, 2, 1, 0, Side::kConvex};
  Constraint on_line = on_curve;
  on_line.feature2 = StraightEdge{{1, 1}, {-1, 1}};
  Constraint contact = on_curve;
  contact.type = ConstraintType::kContact;
  std::vector<Constraint> constraints{on_curve, on_line, contact};
  FollowPathJoints(bodies, constraints);
  EXPECT_NEAR(constraints[0].s2.value(), kPi / 2, 1e-9);
  EXPECT_FALSE(constraints[1].s2.has_value());
  EXPECT_FALSE(constraints[2].s2.has_value());
}

// A train moves by a good part of its track: both levels give back a world whose joints say where they are.
TEST(PathJoints, KeepTheirPlaceInMotionAtBothLevels) {
  for (const MotionLevel level : kBothLevels) {
    for (const std::uint64_t seed : {1ULL, 2ULL}) {
      const World world = StartScene("oval-train", 5, seed);
      const Mover motion(level, world);
      motion.KeepMoving(0.3);
      int joints = 0;
      for (std::size_t k = 0; k < world.joints.size(); ++k) {
        if (world.joints[k].type != ConstraintType::kPathJoint) continue;
        const World& moved = motion->world();
        const double travelled =
            Norm(PlaceOfPoint(moved.bodies, moved.joints[k]) - PlaceOfPoint(world.bodies, world.joints[k]));
        EXPECT_GT(travelled, 0.2);
        // At the velocity level that of the last step's beginning.
        const double speed = Norm(moved.bodies[static_cast<std::size_t>(moved.joints[k].body1)].v);
        EXPECT_LE(Norm(PlaceOnCurve(moved.bodies, moved.joints[k]) - PlaceOfPoint(moved.bodies, moved.joints[k])),
                  2e-3 * speed + 1e-4)
            << ToString(level) << ", seed " << seed;
        ++joints;
      }
      EXPECT_GE(joints, 3);
    }
  }
}

}  // namespace
}  // namespace lcpbench
