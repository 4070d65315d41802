#include "tests/model/motion/mover.h"

#include "model/contact/assembly.h"
#include "model/contact/loads.h"
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

int ExpectEnergyLaw(const Mover& driven, double step, int count) {
  int steps = 0;
  double before = 0;  // T(v^) of the step that was met last
  double expected = 0;
  double scale = 0;
  const auto energy = [](const std::vector<Body>& bodies, const Eigen::VectorXd& v) {
    double sum = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Body& body = bodies[i];
      const auto k = static_cast<Index>(3 * i);
      if (!body.fixed) sum += (body.mass * v.segment<2>(k).squaredNorm() + body.inertia * v[k + 2] * v[k + 2]) / 2;
    }
    return sum;
  };
  driven->set_observer([&](const MotionProblem& met) {
    const LcpProblem& problem = met.problem;
    const Eigen::VectorXd& f = met.result.f;
    if (met.result.status != LcpStatus::kSolved) return;
    const Eigen::VectorXd free = FreeVelocity(met.system.bodies, step);
    Eigen::VectorXd w;
    problem.ComputeW(f, &w);
    const Eigen::VectorXd change = problem.inverse_mass().asDiagonal() * (problem.J().transpose() * f);
    double friction = 0;
    for (const FrictionRow& row : problem.friction_rows()) {
      friction += f[row.row] * w[row.row];
      EXPECT_LE(f[row.row] * w[row.row], 1e-9 * (1 + energy(met.system.bodies, free)));
    }
    const double quadratic = f.dot(problem.J() * change) / 2;
    before = energy(met.system.bodies, free);
    Eigen::VectorXd prescribed = free;
    for (std::size_t i = 0; i < met.system.bodies.size(); ++i) {
      if (!met.system.bodies[i].fixed) prescribed.segment<3>(static_cast<Index>(3 * i)).setZero();
    }
    expected = -quadratic + friction - f.dot(problem.b() - problem.J() * free) - f.dot(problem.J() * prescribed);
    scale = before + quadratic;
    ++steps;
  });
  for (int k = 0; k < count; ++k) {
    const int met = steps;
    driven.KeepMoving(step);
    if (steps == met) continue;
    const std::vector<Body>& bodies = driven->world().bodies;
    EXPECT_NEAR(KineticEnergy(bodies) - before, expected, 1e-8 * (scale + 1e-6)) << k;
  }
  driven->set_observer({});
  return steps;
}

}  // namespace lcpbench
