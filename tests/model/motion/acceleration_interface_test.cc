// What motion at the acceleration level promises its callers: the same bits, the problems that observers see, any
// solver, also one that fails, and refusals.

#include "model/contact/assembly.h"
#include "solvers/registry.h"
#include "tests/model/motion/mover.h"
#include "tests/solvers/solvers_under_test.h"

namespace lcpbench {
namespace {

TEST(AccelerationMotion, TheSameStartGivesTheSameBits) {
  Random random(21);
  std::vector<Body> bodies = {Fixed(Bowl(1.6, 1.4, 1.2))};
  for (int k = 0; k < 6; ++k) {
    const Outline outline = k % 2 == 0 ? Ellipse(0.16, 0.1) : RoundedBox(0.3, 0.2, 0.05);
    bodies.push_back(Movable(outline, {-0.4 + 0.4 * (k % 3), -0.6 + 0.45 * std::floor(k / 3.0)}, random.Uniform(0, 6)));
  }
  const World world = WorldWith("bowl", bodies);
  Mover first(world, WithRestitution(0.3));
  Mover second(world, WithRestitution(0.3));
  first->Advance(1);
  second->Advance(1);
  EXPECT_EQ(first->status(), MotionStatus::kMoving) << first->detail();
  EXPECT_EQ(first->statistics().solves, second->statistics().solves);
  EXPECT_GT(first->statistics().impacts, 10);
  EXPECT_LE(first->statistics().worst_penetration, kContactTolerance);
  EXPECT_TRUE(first->world() == second->world());
}

TEST(AccelerationMotion, ProblemsThatAreObservedAreThoseOfTheModelWithoutStabilisation) {
  std::vector<Body> bodies = {Track(1), Movable(Disc(0.2), {0.5, -0.624}), Movable(Ellipse(0.15, 0.1), {0, -0.7})};
  const World world = WorldWith("observed", bodies);
  Mover mover(world);
  std::int64_t steps = 0;
  std::int64_t impacts = 0;
  double last = 0;
  mover->set_observer([&](const MotionProblem& met) {
    EXPECT_GE(met.time, last);
    last = met.time;
    ASSERT_EQ(met.problem.size(), static_cast<Index>(met.rows.size()));
    if (met.kind == MotionProblemKind::kImpact) {
      ++impacts;
      return;
    }
    ++steps;
    const AssembledLcp again = AssembleContactLcp(met.system);
    EXPECT_EQ(again.problem.b(), met.problem.b());
    EXPECT_TRUE(again.problem.J().toDense() == met.problem.J().toDense());
    for (const RowInfo& row : met.rows) {
      EXPECT_LE(row.d, 1e-6);
      EXPECT_LE(std::abs(row.d_dot), 1e-6);
    }
  });
  mover->Advance(2);
  EXPECT_GT(steps, 20);
  EXPECT_LE(steps, mover->statistics().steps);
  EXPECT_EQ(impacts, mover->statistics().impacts);
  EXPECT_GT(impacts, 0);
}

// A solver that answers what it is told to.
class TestSolver final : public LcpSolver {
 public:
  explicit TestSolver(double f) : f_(f) {}

 private:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) override {
    result->f.setConstant(f_);
    result->detail = "as told";
  }
  double f_;
};

TEST(AccelerationMotion, ForcesThatAreNotFiniteEndTheMotion) {
  TestSolver solver(std::nan(""));
  const auto moved = MakeAccelerationMotion(WorldWith("nan", {Floor(), Movable(Disc(0.1), {0, 0.3})}), {}, solver);
  Motion& motion = *moved;
  motion.Advance(3);
  EXPECT_EQ(motion.status(), MotionStatus::kSolverFailed);
  EXPECT_NE(motion.detail().find("as told"), std::string::npos) << motion.detail();
  // Where it failed: at the floor.
  EXPECT_NEAR(motion.time(), std::sqrt(2 * 0.2 / kG), 1e-9);
  EXPECT_NEAR(motion.world().bodies[1].x.y, 0.1, 1e-9);
}

TEST(AccelerationMotion, ASolverThatFailsIsCountedAndItsBestPointTaken) {
  TestSolver solver(0);
  const auto moved =
      MakeAccelerationMotion(WorldWith("no forces", {Floor(), Movable(Disc(0.1), {0, 0.1})}), {}, solver);
  Motion& motion = *moved;
  motion.Advance(0.01);
  EXPECT_EQ(motion.statistics().failed_solves, motion.statistics().solves);
  EXPECT_GT(motion.statistics().failed_solves, 0);
  // Falls through the floor, which shows.
  EXPECT_GT(motion.statistics().worst_penetration + std::abs(motion.world().bodies[1].x.y - 0.1), 1e-5);
}

TEST(AccelerationMotion, EverySolverDrivesIt) {
  const double R = 1;
  World world =
      WorldWith("two discs in a track", {Track(R), Movable(Disc(0.2), {0.8, 0}), Movable(Disc(0.3), {0, -0.7})});
  constexpr double kTime = 0.45;
  Mover reference(world);
  reference->Advance(kTime);
  for (const SolverEntry& entry : OwnSolversAndAPeerOfEachLibrary()) {
    if (entry.key == "band-pivoting") continue;  // RefusedProblemsEndAMotion
    Mover mover(world, AccelerationOptions{}, entry.key);
    mover->Advance(kTime);
    if (entry.origin != SolverOrigin::kOwn) {
      // A peer may get impacts wrong and stall for it: that is said, and the numbers stay finite.
      EXPECT_TRUE(mover->status() == MotionStatus::kMoving || !mover->detail().empty()) << entry.key;
      for (const Body& body : mover->world().bodies) EXPECT_TRUE(std::isfinite(body.x.x)) << entry.key;
      continue;
    }
    EXPECT_EQ(mover->status(), MotionStatus::kMoving) << entry.key << ": " << mover->detail();
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_NEAR(Norm(mover.body(i).x - reference.body(i).x), 0, 1e-5) << entry.key;
    }
  }
}

TEST(AccelerationMotion, RefusedProblemsEndAMotion) {
  const World world = WorldWith("resting", {Floor(), Movable(Disc(0.1), {0, 0.1})});
  Mover mover(world, AccelerationOptions{}, "band-pivoting");  // takes A given as a matrix
  mover->Advance(0.1);
  EXPECT_EQ(mover->status(), MotionStatus::kSolverFailed);
  EXPECT_NE(mover->detail().find("does not take problem"), std::string::npos) << mover->detail();
  EXPECT_NE(mover->detail().find("A given as a matrix"), std::string::npos) << mover->detail();
}

TEST(AccelerationMotion, RefusesWhatMakesNoSense) {
  const auto solver = MakeSolver("dantzig");
  const World world = WorldWith("fine", {Floor(), Movable(Disc(0.1), {0, 1})});
  const auto with = [&](auto change) {
    AccelerationOptions options;
    change(options);
    MakeAccelerationMotion(world, options, *solver);
  };
  EXPECT_NO_THROW(with([](AccelerationOptions&) {}));
  EXPECT_THROW(with([](AccelerationOptions& o) { o.impact.velocity_tolerance = -1; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.max_events = 0; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.impact.restitution = 1.1; }), InputError);
  Mover mover(world);
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(mover->Advance(wrong), InputError);
  }
  World wrong = world;
  wrong.bodies[1].mass = 0;
  EXPECT_THROW(MakeAccelerationMotion(wrong, {}, *solver), InputError);
}

}  // namespace
}  // namespace lcpbench
