#include "model/motion/contact_finder.h"
#include "model/motion/velocity_motion.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/model/contact/momenta.h"
#include "tests/model/motion/mover.h"
#include "tests/solvers/solvers_under_test.h"

namespace lcpbench {
namespace {

/// A fixed body with straight edges a-b, b-c, ...; material on the left.
Body Walls(const std::vector<Vec2>& corners) {
  Body walls = MakeFixed("walls");
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) walls.outline.push_back(WholeEdge(corners[k], corners[k + 1]));
  return walls;
}

/// `count` discs of random radii above each other with room between, in an open box of width 1.
World FallingDiscs(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Body> bodies{Walls({{0.5, 10}, {0.5, 0}, {-0.5, 0}, {-0.5, 10}})};
  for (int i = 0; i < count; ++i) {
    const double radius = random.Uniform(0.07, 0.13);
    const double x = random.Uniform(-0.3, 0.3);
    bodies.push_back(Movable(Disc(radius), {x, 0.15 + 0.3 * i}));
  }
  return WorldWith("test", std::move(bodies), {0, -kG});
}

TEST(VelocityMotion, FallsFreelyByTheSumOfItsSteps) {
  VelocityOptions options;
  options.step = 1.0 / 128;  // exact sums
  Mover driven(WorldWith("test", {Movable(Disc(0.1), {0, 5}, 0, {1, 2}, 3)}, {0, -8}), options);
  const int n = 100;
  driven->Advance(n * options.step);
  const Body& body = driven.body(0);
  const double h = options.step;
  EXPECT_NEAR(body.x.x, n * h, 1e-14);
  EXPECT_NEAR(body.x.y, 5 + 2 * n * h - 8 * h * h * n * (n + 1) / 2, 1e-12);
  EXPECT_NEAR(body.v.y, 2 - 8 * n * h, 1e-13);
  EXPECT_EQ(body.theta, 3 * n * h);
  EXPECT_EQ(driven->statistics().steps, n);
  EXPECT_EQ(driven->time(), n * h);
}

TEST(VelocityMotion, HoldsARestingBodyByItsWeight) {
  const std::vector<Body> bodies{Movable(Disc(0.3), {0, 0.3}), Movable(Box(0.8, 0.4), {0, 0.2})};
  for (const Body& body : bodies) {
    Mover driven(MotionLevel::kVelocity, WorldWith("test", {Walls({{5, 0}, {-5, 0}}), body}, {0, -kG}));
    int steps = 0;
    driven->set_observer([&](const MotionProblem& met) {
      EXPECT_EQ(met.kind, MotionProblemKind::kTimeStep);
      EXPECT_GE(met.problem.size(), 1);
      EXPECT_NEAR(met.result.f.sum(), body.mass * kG * 1e-3, 1e-9 * body.mass * kG * 1e-3);
      ++steps;
    });
    driven->Advance(0.2);
    EXPECT_EQ(steps, 200);
    EXPECT_LT(driven->statistics().worst_penetration, 1e-12);
    const Body& after = driven.body(1);
    EXPECT_NEAR(after.x.y, body.x.y, 1e-12);
    EXPECT_NEAR(after.v.y, 0, 1e-12);
    EXPECT_NEAR(after.omega, 0, 1e-12);
  }
}

TEST(VelocityMotion, ChangesEnergyByTheLawOfTheScheme) {
  const auto expect = [](const World& world, const VelocityOptions& options, int steps) {
    const Mover driven(world, options);
    EXPECT_GT(ExpectEnergyLaw(driven, options.step, steps), 0);
    EXPECT_EQ(driven->statistics().failed_solves, 0);
  };
  VelocityOptions options;
  options.step = 5e-3;
  for (const std::uint64_t seed : {1, 2, 3}) expect(FallingDiscs(12, seed), options, 300);
  options.restitution = 0.7;
  expect(FallingDiscs(5, 4), options, 200);
  options = {};
  for (const char* key : {"disc-pile", "boxes-and-discs", "disc-track", "discs-in-v"}) {
    SCOPED_TRACE(key);
    expect(StartScene(key, 40, 1), options, 60);
  }
}

TEST(VelocityMotion, PilesComeToRest) {
  VelocityOptions options;
  options.step = 4e-3;
  const World world = FallingDiscs(15, 7);
  Mover driven(world, options);
  driven->set_observer([&](const MotionProblem& met) {
    EXPECT_EQ(met.result.status, LcpStatus::kSolved)
        << "t = " << met.time << ", n = " << met.problem.size() << ": " << met.result.detail;
  });
  const double fallen = PotentialEnergy(world.loads, world.bodies);
  driven->Advance(12);
  const auto& bodies = driven->world().bodies;
  EXPECT_LT(KineticEnergy(bodies), 1e-9 * fallen);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    EXPECT_LT(std::abs(bodies[i].x.x), 0.5);
    EXPECT_GT(bodies[i].x.y, 0.06);
    EXPECT_LT(bodies[i].x.y, 1.5);
  }
  // Impacts move surfaces by V h along curves of radius r: depths of (V h)^2 / r, here 6 m/s * 4 ms on 0.07 m.
  EXPECT_LT(driven->statistics().worst_penetration, 0.01);
  EXPECT_EQ(driven->statistics().failed_solves, 0);
}

TEST(VelocityMotion, ConservesMomentumAndAngularMomentumWithoutLoads) {
  for (const double e : {0.0, 0.5, 1.0}) {
    Random random(11);
    std::vector<Body> bodies;
    for (int i = 0; i < 12; ++i) {
      const Vec2 place{0.5 * (i % 4) - 0.75, 0.5 * (i / 4) - 0.5};
      const Vec2 inward = -1 * place;
      const Outline shape = i % 3 == 0 ? Box(0.3, 0.2) : Disc(0.12);
      bodies.push_back(Movable(shape, place, 0, inward, random.Uniform(-2, 2)));
    }
    const World world = WorldWith("test", bodies, {});
    VelocityOptions options;
    options.restitution = e;
    Mover driven(world, options);
    double impulse = 0;
    driven->set_observer([&](const MotionProblem& met) { impulse += met.result.f.sum(); });
    driven->Advance(1);
    const auto& after = driven->world().bodies;
    EXPECT_GT(impulse, 0.05);  // they did meet
    const double scale = impulse + 1;
    EXPECT_NEAR(Momentum(after).x, Momentum(bodies).x, 1e-12 * scale);
    EXPECT_NEAR(Momentum(after).y, Momentum(bodies).y, 1e-12 * scale);
    EXPECT_NEAR(AngularMomentum(after), AngularMomentum(bodies), 1e-12 * scale);
    if (e == 0) {
      EXPECT_LT(KineticEnergy(after), KineticEnergy(bodies));
    }
  }
}

// The disc's centre is a pendulum of length R - r; after a quarter of its period it passes the lowest point.
TEST(VelocityMotion, SlidesInAConcaveTrackWithAnErrorOfOrderOne) {
  const double track = 1;
  const double radius = 0.2;
  const double length = track - radius;
  const Rotation start = SinCos(1.0);
  Body rail = MakeFixed("rail");
  rail.outline = {FullCircle({}, track, Side::kConcave)};
  const World world =
      WorldWith("test", {rail, Movable(Disc(radius), {length * start.sin, -length * start.cos})}, {0, -kG});
  const double quarter = std::sqrt(length / kG) * std::comp_ellint_1(SinCos(0.5).sin);
  const double speed = std::sqrt(2 * kG * length * (1 - start.cos));
  std::vector<double> place_errors;
  std::vector<double> speed_errors;
  for (const int steps : {200, 400, 800}) {
    VelocityOptions options;
    options.step = quarter / steps;
    Mover driven(world, options);
    driven->Advance(quarter);
    EXPECT_EQ(driven->statistics().steps, steps);
    const Body& disc = driven.body(1);
    place_errors.push_back(Norm(disc.x - Vec2{0, -length}));
    speed_errors.push_back(std::abs(Norm(disc.v) - speed));
    // One step moves the disc by V h along a circle: (V h)^2 / 2 (1/r - 1/R), r for the disc's centre's path.
    EXPECT_LT(driven->statistics().worst_penetration, 2 * speed * speed * options.step * options.step / length);
  }
  for (std::size_t k = 0; k + 1 < place_errors.size(); ++k) {
    EXPECT_NEAR(place_errors[k] / place_errors[k + 1], 2, 0.05) << place_errors[k];
    // Where the speed is largest its own error is of order 2.
    EXPECT_NEAR(speed_errors[k] / speed_errors[k + 1], 4, 0.1) << speed_errors[k];
  }
  EXPECT_LT(place_errors.back(), 0.01 * length);
}

TEST(VelocityMotion, KeepsAChainOfPinsTogetherToTheSquareOfTheStep) {
  const double half = 0.25;
  std::vector<Body> bodies{MakeFixed("ceiling")};
  World world;
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(Movable(Box(2 * half, 0.1), {half * (2 * i + 1), 0}));
  }
  world = WorldWith("test", bodies, {0, -kG});
  for (int i = 0; i < 6; ++i) {
    world.joints.push_back({ConstraintType::kPin, i + 1, i, Vertex{{-half, 0}}, Vertex{{i == 0 ? 0 : half, 0}}});
  }
  std::vector<double> errors;
  for (const double h : {2e-3, 1e-3, 5e-4}) {
    VelocityOptions options;
    options.step = h;
    Mover driven(world, options);
    double spin = 0;
    for (int k = 0; k < 50; ++k) {
      driven->Advance(0.02);
      for (const Body& body : driven->world().bodies) spin = std::max(spin, std::abs(body.omega));
    }
    const MotionStatistics& statistics = driven->statistics();
    EXPECT_GT(spin, 1);
    // A step turns each arm by omega h: its end leaves its tangent by (omega h)^2 half / 2, for both bodies of a pin.
    EXPECT_LT(statistics.worst_joint_error, 1.5 * spin * spin * h * h * half);
    EXPECT_EQ(statistics.failed_solves, 0);
    errors.push_back(statistics.worst_joint_error);
  }
  EXPECT_LT(errors[2], errors[0] / 8);
}

TEST(VelocityMotion, CarriesBodiesOnALiftWithAPrescribedAcceleration) {
  Body lift = Walls({{1, 0}, {-1, 0}});
  lift.v = {0.5, -0.25};
  lift.acceleration = {0, 2};
  Mover driven(MotionLevel::kVelocity,
               WorldWith("test", {lift, Movable(Disc(0.1), {0, 0.1}, 0, {0, -0.25})}, {0, -kG}));
  driven->Advance(1);
  const Body& moved = driven.body(0);
  EXPECT_NEAR(moved.x.x, 0.5, 1e-12);
  EXPECT_NEAR(moved.x.y, -0.25 + 1, 1e-12);
  EXPECT_NEAR(moved.v.y, 1.75, 1e-12);
  EXPECT_NEAR(driven.body(1).x.y - moved.x.y, 0.1, 1e-9);
  EXPECT_LT(driven->statistics().worst_penetration, 1e-9);
}

TEST(VelocityMotion, ReportsTheRayOfWallsThatCloseOnADiscAndGoesOn) {
  // Material lies on the left of an edge.
  Body left = Walls({{0, -1}, {0, 1}});
  Body right = Walls({{0, 1}, {0, -1}});
  left.x = {-0.11, 0};
  left.v = {0.1, 0};
  right.x = {0.11, 0};
  right.v = {-0.1, 0};
  Mover driven(MotionLevel::kVelocity, WorldWith("test", {left, right, Movable(Disc(0.1), {0, 0})}, {}));
  int rays = 0;
  int solved = 0;
  driven->set_observer([&](const MotionProblem& met) {
    if (met.result.status == LcpStatus::kSolved) ++solved;
    if (met.result.status != LcpStatus::kInfeasible) return;
    ASSERT_TRUE(met.result.farkas_ray.has_value());
    EXPECT_TRUE(VerifyFarkasRay(met.problem, *met.result.farkas_ray).accepted);
    ++rays;
  });
  driven->Advance(0.11);  // the walls touch the disc after 0.1 s
  EXPECT_EQ(driven->status(), MotionStatus::kMoving);
  EXPECT_GE(rays, 9);
  EXPECT_EQ(driven->statistics().unsolvable, rays);
  EXPECT_EQ(driven->statistics().steps, solved);
  EXPECT_NEAR(driven->time(), 0.11, 1e-12);
  EXPECT_NEAR(driven.body(2).x.x, 0, 1e-9);
  EXPECT_NEAR(driven.body(0).x.x, -0.099, 1e-12);
  EXPECT_GT(driven->statistics().worst_penetration, 5e-4);
}

TEST(VelocityMotion, LeavesADiscInPeaceThatIsWiderThanItsSlot) {
  const Body slot = Walls({{0.0999, 1}, {0.0999, -1}, {-0.0999, -1}, {-0.0999, 1}});
  Mover driven(MotionLevel::kVelocity, WorldWith("test", {slot, Movable(Disc(0.1), {0, 0})}, {0, -kG}));
  driven->Advance(0.1);
  const MotionStatistics& statistics = driven->statistics();
  EXPECT_EQ(statistics.unsolvable, 100);
  EXPECT_EQ(statistics.solves, 200);
  // Relaxed steps only keep it from sinking deeper: it falls through the slot.
  EXPECT_NEAR(driven.body(1).x.x, 0, 1e-12);
  EXPECT_NEAR(driven.body(1).v.y, -kG * 0.1, 1e-9);
}

TEST(VelocityMotion, DoesNotPushACornerOutThroughTheFaceAroundTheNextCorner) {
  // The upper box overhangs: its lower left corner rests on the lower one, 1 cm from that one's right side.
  const Body floor = Walls({{5, 0}, {-5, 0}});
  Body lower = Movable(Box(1, 0.2), {0, 0.1 - 1e-6});
  Body upper = Movable(Box(1, 0.2), {0.99, 0.3 - 3e-6});
  Body prop = Movable(Box(0.2, 0.2), {1.2, 0.1 - 1e-6});
  lower.fixed = prop.fixed = true;
  const World world = WorldWith("test", {floor, lower, prop, upper}, {0, -kG});
  Mover driven(MotionLevel::kVelocity, world);
  driven->set_observer([&](const MotionProblem& met) {
    for (const RowInfo& row : met.rows) EXPECT_GT(row.d, -1e-5);
  });
  driven->Advance(0.1);
  EXPECT_EQ(driven.body(3).x.x, 0.99);
  EXPECT_NEAR(driven.body(3).x.y, 0.3, 1e-5);

  VelocityOptions credulous;
  credulous.doubtful_depth = 0.25;  // the deepest that is treated
  Mover pushed(world, credulous);
  pushed->Advance(0.1);
  EXPECT_GT(pushed.body(3).x.x, 0.995);
}

TEST(VelocityMotion, LetsNothingThroughAtTenDiametersAStep) {
  VelocityOptions options;
  options.step = 1e-2;
  for (const double e : {0.0, 1.0}) {
    options.restitution = e;
    Mover driven(WorldWith("test", {Walls({{50, 0}, {-50, 0}}), Movable(Disc(0.1), {0, 7.3}, 0, {30, -200})}, {}),
                 options);
    for (int k = 0; k < 20; ++k) {
      driven->Advance(0.01);
      EXPECT_GT(driven.body(1).x.y, 0.1 - 1e-12);
    }
    EXPECT_NEAR(driven.body(1).v.y, 200 * e, 1e-9);
  }
}

// Our own solvers must answer every step rightly. Peers drive the motion, too, but some get steps wrong: nobody shall
// believe them then, and the motion goes on with finite numbers.
class VelocityMotionSolvers : public testing::TestWithParam<SolverEntry> {};

TEST_P(VelocityMotionSolvers, DriveASmallPileWithVerifiedAnswers) {
  VelocityOptions options;
  options.step = 4e-3;
  options.lcp.tolerance = 1e-6;
  if (GetParam().key == "band-pivoting") return;  // takes A given as a matrix
  const World world = FallingDiscs(6, 5);
  Mover driven(world, options, GetParam().key);
  Mover reference(world, options);
  int judged = 0;
  driven->set_observer([&](const MotionProblem& met) {
    ++judged;
    if (GetParam().origin != SolverOrigin::kOwn) return;
    const Verdict verdict = Verify(met.problem, met.result, options.lcp.tolerance);
    EXPECT_TRUE(verdict.passes) << "t = " << met.time << ": " << met.result.status << ", " << met.result.detail << ", "
                                << verdict.reason;
  });
  driven->Advance(0.4);
  reference->Advance(0.4);
  EXPECT_EQ(judged, 100);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const double distance = Norm(driven.body(i).x - reference.body(i).x);
    EXPECT_LT(distance, GetParam().origin == SolverOrigin::kOwn ? 1e-3 : 1e3);
  }
}

INSTANTIATE_TEST_SUITE_P(All, VelocityMotionSolvers, testing::ValuesIn(OwnSolversAndAPeerOfEachLibrary()),
                         SolverTestName);

TEST(VelocityMotion, RefusesOptionsOutsideTheirRanges) {
  const World world = FallingDiscs(1, 1);
  const std::unique_ptr<LcpSolver> solver = MakeSolver("dantzig");
  const std::pair<double VelocityOptions::*, double> kWrong[] = {
      {&VelocityOptions::step, 0},
      {&VelocityOptions::step, std::numeric_limits<double>::infinity()},
      {&VelocityOptions::restitution, 1.1},
      {&VelocityOptions::doubtful_depth, 0}};
  for (const auto& [member, value] : kWrong) {
    VelocityOptions options;
    options.*member = value;
    EXPECT_THROW(MakeVelocityMotion(world, options, *solver), InputError) << value;
  }
  const std::unique_ptr<Motion> motion = MakeVelocityMotion(world, {}, *solver);
  EXPECT_THROW(motion->Advance(0), InputError);
  EXPECT_THROW(motion->Advance(std::nan("")), InputError);
}

TEST(RowMatching, FollowsRowsThroughChangesOfOrder) {
  const ContactSystem system = GenerateScene("boxes-and-discs", 60, 2);
  ContactSystem shuffled = system;
  std::reverse(shuffled.constraints.begin(), shuffled.constraints.end());
  shuffled.constraints.erase(shuffled.constraints.begin() + 7);
  RowMatching matching;
  const auto first = matching.Follow(system, AssembleContactLcp(system).rows);
  EXPECT_TRUE(std::none_of(first.begin(), first.end(), [](const auto& match) { return match.has_value(); }));
  const auto second = matching.Follow(shuffled, AssembleContactLcp(shuffled).rows);
  ASSERT_EQ(second.size(), 59u);
  for (int i = 0; i < 59; ++i) EXPECT_EQ(second[static_cast<std::size_t>(i)], 59 - (i < 7 ? i : i + 1));
}

TEST(RowMatching, TellsPlacesOfOnePairOfFeaturesApartByTheirNormals) {
  ContactSystem system;
  system.bodies = {MakeFixed("bowl"), MakeDisc({}, 1, 1)};
  for (int k = 0; k < 3; ++k) {
    system.constraints.push_back({ConstraintType::kContact, 1, 0, Circle(1), Circle(3)});
  }
  const auto row = [](int constraint, double angle) {
    RowInfo info;
    info.constraint = constraint;
    const Rotation direction = SinCos(angle);
    info.n = {direction.cos, direction.sin};
    return info;
  };
  RowMatching matching;
  matching.Follow(system, {row(0, 0), row(1, 2), row(2, 4)});
  const auto found = matching.Follow(system, {row(0, 4.1), row(1, 0.1)});
  EXPECT_EQ(found, (std::vector<std::optional<int>>{2, 0}));
  const auto back = matching.Follow(system, {row(0, 0.2), row(1, 2), row(2, 4.2)});
  EXPECT_EQ(back, (std::vector<std::optional<int>>{1, std::nullopt, 0}));
}

// Solved again every step, a gap rate of zero shrinks by rounding down to numbers without digits, on which no answer is
// accurate: they do not reach the solver.
TEST(VelocityMotion, TakesSpeedsBeyondAllDigitsForZero) {
  World world = WorldWith("test", {Walls({{0, 10}, {0, -10}}), Movable(Disc(0.1), {0, 0}, 0, {3e-310, 0})}, {0, -kG});
  world.joints = {{ConstraintType::kPathJoint, 1, 0, Vertex{}, StraightEdge{{0, 10}, {0, -10}}}};
  Mover driven(MotionLevel::kVelocity, world);
  int steps = 0;
  driven->set_observer([&](const MotionProblem& met) {
    ASSERT_EQ(met.problem.size(), 1);
    EXPECT_EQ(met.problem.b()[0], 0);
    ++steps;
  });
  driven->Advance(0.01);
  EXPECT_EQ(steps, 10);
  EXPECT_NEAR(driven.body(1).v.y, -0.01 * kG, 1e-12);
}

}  // namespace
}  // namespace lcpbench
