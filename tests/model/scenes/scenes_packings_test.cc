#include <Eigen/Dense>

#include "model/contact/assembly.h"
#include "model/contact/closest_points.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/oval_front.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"
#include "tests/model/contact/momenta.h"
#include "tests/model/scenes/scene_checks.h"

namespace lcpbench {
namespace {

PlacedOval RandomOval(Random* random) {
  PlacedOval oval;
  oval.a = random->Uniform(0.07, 0.15);
  oval.b = oval.a * random->Uniform(0.45, 0.95);
  oval.u = Direction(random->Uniform(-kPi, kPi));
  return oval;
}

// The support function's derivative by the normal's angle is the arm along the tangent, its second the radius of
// curvature less itself.
TEST(OvalSupports, AreStationaryWhereTheBoundaryIs) {
  Random random(2);
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 200; ++i) {
    const PlacedOval oval = RandomOval(&random);
    const double angle = random.Uniform(-kPi, kPi);
    const auto at = [&](double s) { return SupportOf(oval, Direction(s)); };
    const Vec2 n = Direction(angle);
    const OvalSupport here = at(angle);
    const double along = Dot(here.arm, oval.u) / oval.a;
    const double across = Cross(oval.u, here.arm) / oval.b;
    EXPECT_NEAR(along * along + across * across, 1, 1e-14);
    EXPECT_NEAR(here.h, Dot(here.arm, n), 1e-15);
    EXPECT_NEAR((at(angle + kStep).h - at(angle - kStep).h) / (2 * kStep), Dot(here.arm, Perp(n)), 1e-7);
    EXPECT_NEAR((at(angle + kStep).h - 2 * here.h + at(angle - kStep).h) / (kStep * kStep) + here.h, here.radius, 1e-6);
  }
}

// In a rigid motion no gap accelerates: J a + gamma = 0 for the centripetal accelerations a of a pile that turns as
// one.
TEST(OvalsInBowl, SwingWithTheGammaOfARigidMotion) {
  const ContactSystem system = GenerateScene("ovals-in-bowl", 401, 3);
  std::map<double, int> spins;
  for (const Body& body : system.bodies) ++spins[body.omega];
  const double swing =
      std::max_element(spins.begin(), spins.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
  ASSERT_NE(swing, 0);
  const Eigen::VectorXd accelerations = lcpbench::testing::GapAccelerationInRotation(system, swing, 0);
  int rigid = 0;
  int spinning = 0;
  for (std::size_t k = 0; k < system.constraints.size(); ++k) {
    const Constraint& c = system.constraints[k];
    const auto moves_along = [&](int body) {
      return body == 0 || system.bodies[static_cast<std::size_t>(body)].omega == swing;
    };
    if (moves_along(c.body1) && moves_along(c.body2)) {
      ++rigid;
      EXPECT_NEAR(accelerations[static_cast<Index>(k)], 0, 1e-12);
    } else if (std::abs(accelerations[static_cast<Index>(k)]) > 1e-3) {
      ++spinning;
    }
  }
  EXPECT_GE(rigid, 200);
  EXPECT_GE(spinning, 20);
}

TEST(TallStacks, StandOnTheLightestWithTheStatedMassRatio) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ContactSystem system = GenerateScene("tall-stacks", 900, seed);
    const auto mass = [&](int body) { return system.bodies[static_cast<std::size_t>(body)].mass; };
    double lightest = 1e300;
    double heaviest = 0;
    for (const Body& body : system.bodies) {
      if (body.fixed) continue;
      lightest = std::min(lightest, body.mass);
      heaviest = std::max(heaviest, body.mass);
    }
    EXPECT_NEAR(heaviest / lightest, 1e6, 1e-6);
    for (const Constraint& c : system.constraints) {
      const bool on_floor = system.bodies[static_cast<std::size_t>(c.body2)].fixed;
      if (on_floor) {
        EXPECT_NEAR(mass(c.body1), lightest, 1e-12);
      }
    }
    // Discs and ovals slide over one another.
    int curved = 0;
    for (const RowInfo& row : AssembleContactLcp(system).rows) curved += std::abs(row.gamma) > 0.01 ? 1 : 0;
    EXPECT_GE(curved, 180);
  }
}

TEST(BilliardsBreak, KeepsMomentumWhateverTheForces) {
  const AssembledLcp lcp = AssembleContactLcp(GenerateScene("billiards-break", 300, 1));
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(300, 0, 5);
  // A column for each body, the table first, which nothing touches.
  const Eigen::VectorXd impulse = lcp.problem.J().transpose() * f;
  const auto bodies = impulse.reshaped(3, impulse.size() / 3);
  EXPECT_EQ(bodies.col(0).norm(), 0);
  EXPECT_EQ(bodies.row(2).norm(), 0);
  EXPECT_LE(bodies.rowwise().sum().norm(), 1e-10);
}

TEST(BilliardsBreak, SendsTheCueBallIntoTheTouchingRack) {
  for (const int rows : {1, 2, 3, 31, 200}) {
    const ContactSystem racked = GenerateScene("billiards-break", rows, 6);
    World world = StartScene("billiards-break", rows, 6);
    constexpr double kTolerance = 1e-8;
    const std::size_t before = ContactFinder(world).Find(world.bodies, kTolerance, kTolerance).size();
    EXPECT_EQ(before, static_cast<std::size_t>(rows) - 1);
    // The cue ball and those behind it meet the rack where the problem has them.
    double time = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      Body& body = world.bodies[i];
      if (Norm(body.v) == 0) {
        EXPECT_EQ(Norm(body.x - racked.bodies[i].x), 0);
        continue;
      }
      const double own = Norm(racked.bodies[i].x - body.x) / Norm(body.v);
      if (time == 0) time = own;
      EXPECT_NEAR(own, time, 1e-14);
      body.x = body.x + own * body.v;
    }
    EXPECT_GT(time, 0);
    EXPECT_EQ(ContactFinder(world).Find(world.bodies, kTolerance, kTolerance).size(), static_cast<std::size_t>(rows));
    EXPECT_TRUE(world.loads.wrenches.empty());
  }
}

TEST(PackingParts, HaveTheMassAndInertiaOfTheirOutlines) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const double density = random.Uniform(1, 100);
    const double corner = random.Uniform(0.01, 0.2);
    const double width = 2 * corner + random.Uniform(0.01, 1);
    const double height = 2 * corner + random.Uniform(0.01, 1);
    const double a = random.Uniform(0.1, 1);
    const double b = random.Uniform(0.1, 1);
    const Body bodies[] = {MakeDisc({1, 2}, a, density), MakeBox({1, 2}, a, b, density),
                           MakeRoundedBox({1, 2}, width, height, corner, density), MakeOval({3, 4}, 0.3, a, b, density),
                           MakeRing({5, 6}, a + b, a, density)};
    for (const Body& body : bodies) {
      Outline outline = OutlineOf(body);
      outline.name = "part";
      ASSERT_NO_THROW(RequireValid(outline));
      const MassProperties properties = ComputeMassProperties(outline, density);
      EXPECT_NEAR(body.mass, properties.mass, 1e-13 * body.mass);
      EXPECT_NEAR(body.inertia, properties.inertia, 1e-12 * body.inertia);
      EXPECT_LE(Norm(properties.center), 1e-14);
    }
  }
}

}  // namespace
}  // namespace lcpbench
