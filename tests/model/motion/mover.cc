#include "tests/model/motion/mover.h"

#include "model/contact/loads.h"
#include "model/shape/shapes.h"
#include "solvers/registry.h"

namespace lcpbench {

Body Movable(const Outline& outline, Vec2 x, double theta, Vec2 v, double omega) {
  Body body = MakeBody(outline, 1);
  body.x = x;
  body.theta = theta;
  body.v = v;
  body.omega = omega;
  return body;
}

Body Fixed(const Outline& outline, Vec2 x, double theta) {
  Body body = MakeFixed(outline.name, AllPieces(outline));
  body.x = x;
  body.theta = theta;
  return body;
}

Body Floor(double half_width) { return Fixed({"floor", {{{StraightEdge{{half_width, 0}, {-half_width, 0}}, 0, 1}}}}); }

Body Anchor() { return MakeFixed("anchor"); }

Body Track(double radius) { return Fixed({"track", {{{ArcEdge{{}, radius, Side::kConcave}, 2 * kPi, 0}}}}); }

Constraint Joint(ConstraintType type, int body1, Vec2 p1, int body2, Vec2 p2, double length) {
  return {type, body1, body2, Vertex{p1}, Vertex{p2}, {}, {}, 0, length};
}

World WorldWith(std::string name, std::vector<Body> bodies, Vec2 gravity) {
  World world;
  world.name = std::move(name);
  world.bodies = std::move(bodies);
  world.loads.gravity = gravity;
  return world;
}

double Energy(const World& world) { return KineticEnergy(world.bodies) + PotentialEnergy(world.loads, world.bodies); }

AccelerationOptions WithRestitution(double e) {
  AccelerationOptions options;
  options.impact.restitution = e;
  return options;
}

Mover::Mover(MotionLevel level, const World& world, const MotionOptions& options, std::string_view solver)
    : solver_(MakeSolver(solver)), motion_(MakeMotion(level, world, options, *solver_)) {}

Mover::Mover(const World& world, const AccelerationOptions& options, std::string_view solver)
    : Mover(MotionLevel::kAcceleration, world, {.acceleration = options, .velocity = {}}, solver) {}

Mover::Mover(const World& world, const VelocityOptions& options, std::string_view solver)
    : Mover(MotionLevel::kVelocity, world, {.acceleration = {}, .velocity = options}, solver) {}

void Mover::KeepMoving(double seconds) const {
  motion_->Advance(seconds);
  EXPECT_EQ(motion_->status(), MotionStatus::kMoving) << motion_->detail();
}

void ExpectConserved(Mover* mover, double scale, double seconds) {
  constexpr double kFrame = 0.1;
  const double begin = Energy((*mover)->world());
  double drift = 0;
  while ((*mover)->time() < seconds - 1e-9) {
    mover->KeepMoving(std::min(kFrame, seconds - (*mover)->time()));
    ASSERT_FALSE(::testing::Test::HasFailure());
    drift = std::max(drift, std::abs(Energy((*mover)->world()) - begin));
  }
  const MotionStatistics& statistics = (*mover)->statistics();
  EXPECT_LE(drift / scale, 1e-6);
  EXPECT_LE(statistics.worst_penetration, kContactTolerance);
  EXPECT_LE(statistics.worst_joint_error, kContactTolerance);
  EXPECT_EQ(statistics.failed_solves, 0);
  EXPECT_GT(statistics.steps, 0);
}

}  // namespace lcpbench
