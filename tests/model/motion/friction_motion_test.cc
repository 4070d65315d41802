// Motion with friction at the velocity level: docs/friction.md section 9.

#include "model/motion/acceleration_motion.h"
#include "model/motion/velocity_motion.h"
#include "model/scenes/friction/machines.h"
#include "model/scenes/friction/piles.h"
#include "model/scenes/friction/slopes.h"
#include "model/scenes/scene.h"
#include "solvers/registry.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

Mover Drive(const World& world, double step, std::string_view key, VelocityOptions options = {}) {
  options.step = step;
  options.lcp.tolerance = 1e-12;
  options.lcp.max_iterations = key == "pgs" ? 100'000 : 0;
  return {world, options, key};
}

// x = g sin(slope) t^2 / 3, the step's error t h / 3 g sin(slope) included.
TEST(FrictionMotion, RollsADiscToTheOrderOfTheStep) {
  const double slope = 0.3;
  for (const int steps : {25, 50, 100}) {
    const double h = 1.0 / steps;
    const Mover driven = Drive(WorldOf(DiscsOnSlope(1, slope, 0.3, 0)), h, "pgs");
    const Vec2 from = driven.body(1).x;
    driven->Advance(1);
    const double way = Norm(driven.body(1).x - from);
    EXPECT_NEAR(way, kGravity * std::sin(slope) / 3 * (1 + h), 1e-9);
    EXPECT_NEAR(driven.body(1).theta, -slope - way / 0.5, 1e-9);
    EXPECT_LT(driven->statistics().worst_penetration, 1e-12);
  }
}

TEST(FrictionMotion, KeepsTheEnergyLawInEveryStep) {
  constexpr double kStep = 0.005;
  int in_all = 0;
  for (const char* key :
       {"slope-stacks", "rolling-discs", "ladders", "wheel-step", "ovals-rocking", "three-discs", "pyramids",
        "card-house", "drum", "capstan", "pulled-chain", "gears-friction", "cam-lock", "wedge-jam", "voussoir-arch"}) {
    SCOPED_TRACE(key);
    in_all += ExpectEnergyLaw(Drive(StartScene(key, 24, 5), kStep, "auto"), kStep, 20);
  }
  EXPECT_GE(in_all, 280);
}

TEST(FrictionMotion, KeepsWhatRestsWhereItIs) {
  const std::vector<World> scenes = {WorldOf(SlopeStacks(1, 10, 0.3, 0.6, 4, 0.2)),
                                     WorldOf(Arches(1, 15, 0.75, 0.7)),
                                     WorldOf(CardHouse(3, 0.3, 0.6)),
                                     WorldOf(Pyramids(1, 4, 0.6)),
                                     WorldOf(Ladders(2, 1.2, 0.5)),
                                     WorldOf(LockedCams(1, 0.3, 3, 0.6))};
  for (const World& world : scenes) {
    const Mover driven = Drive(world, 1.0 / 60, "auto");
    driven.KeepMoving(2);
    double creep = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      creep = std::max(creep, Norm(driven.body(i).x - world.bodies[i].x));
    }
    EXPECT_LT(creep, 1e-9) << world.bodies.back().name;
  }
}

// Under weights alone and at constant speed: no body gets so fast that a step takes it through the wall.
TEST(FrictionMotion, KeepsBodiesInATurningDrumAtItsOwnStep) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Mover driven = Drive(StartScene("drum", 20, seed), FindScene("drum").step, "auto");
    const double omega = driven.body(0).omega;
    driven.KeepMoving(2);
    EXPECT_EQ(driven.body(0).omega, omega);
  }
}

TEST(FrictionMotion, StopsASlidingBoxWhereFrictionHasTakenItsEnergy) {
  const double mu = 0.3;
  World world = WorldOf(SlopeStacks(1, 1, 0, mu, 2, 1));
  world.bodies[1].v = {3, 0};
  const double h = 0.001;
  const Mover driven = Drive(world, h, "pgs");
  driven->Advance(2);
  EXPECT_NEAR(driven.body(1).x.x, 9 / (2 * mu * kGravity), 3 * h);
  EXPECT_NEAR(driven.body(1).v.x, 0, 1e-12);
  EXPECT_NEAR(driven.body(1).x.y, 0.5, 1e-12);
}

TEST(FrictionMotion, EndsWhereTheSolverTakesNoFriction) {
  const Mover driven = Drive(WorldOf(Ladders(1, 1.2, 0.5)), 0.01, "dantzig");
  driven->Advance(0.1);
  EXPECT_EQ(driven->status(), MotionStatus::kSolverFailed);
  EXPECT_NE(driven->detail().find("friction rows"), std::string::npos) << driven->detail();
  const std::unique_ptr<LcpSolver> solver = MakeSolver("dantzig");
  EXPECT_THROW(MakeAccelerationMotion(WorldOf(Ladders(1, 1.2, 0.5)), {}, *solver), InputError);
}

TEST(FrictionMotion, StartsFromTheTangentialForcesOfTheStepBefore) {
  std::vector<std::int64_t> sweeps;
  for (const bool warm : {true, false}) {
    VelocityOptions options;
    options.warm_start = warm;
    const Mover driven = Drive(WorldOf(SlopeStacks(2, 3, 0.3, 0.6, 4, 0.5)), 0.01, "pgs", options);
    sweeps.push_back(0);
    int step = 0;
    driven->set_observer([&](const MotionProblem& met) {
      if (++step > 1) sweeps.back() += met.result.iterations;
    });
    driven->Advance(0.2);
  }
  EXPECT_LT(10 * sweeps[0], sweeps[1]);
}

// A disc that is held between two walls too close for it: c < 0 on opposed rows, which no forces undo.
TEST(FrictionMotion, RepeatsAStepThatDepthMakesUnsolvable) {
  World world;
  world.name = "squeezed";
  world.bodies = {MakeFixed("walls", {WholeEdge({-0.49, -2}, {-0.49, 2}), WholeEdge({0.49, 2}, {0.49, -2})}),
                  MakeDisc({}, 0.5, 10)};
  for (Body& body : world.bodies) body.friction = 0.5;
  world.loads.gravity = {0, -kGravity};
  const Mover driven = Drive(world, 0.01, "relaxation");
  std::vector<std::string> ids;
  driven->set_observer([&](const MotionProblem& met) { ids.push_back(met.problem.id()); });
  driven->Advance(0.01);
  ASSERT_EQ(ids.size(), 2u);
  EXPECT_EQ(ids[1], "squeezed-step0-without-depth");
  EXPECT_EQ(driven->status(), MotionStatus::kMoving);
}

}  // namespace
}  // namespace lcpbench
