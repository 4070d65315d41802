#include "model/motion/acceleration_motion.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "model/loads.h"
#include "model/mass_properties.h"
#include "model/scenes/random.h"
#include "model/shapes.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kG = 9.81;
constexpr double kSeconds = 10;

Body Movable(const Outline& outline, Vec2 x, double theta = 0) {
  Body body = MakeBody(outline, 1);
  body.x = x;
  body.theta = theta;
  return body;
}

Body Fixed(const Outline& outline, Vec2 x = {}, double theta = 0) {
  Body body;
  body.name = outline.name;
  body.fixed = true;
  body.x = x;
  body.theta = theta;
  for (const OutlineLoop& loop : outline.loops) body.outline.insert(body.outline.end(), loop.begin(), loop.end());
  return body;
}

// A line from right to left, so that the material is below it.
Body Floor(double half_width = 100) {
  return Fixed({"floor", {{{StraightEdge{{half_width, 0}, {-half_width, 0}}, 0, 1}}}});
}

Body Anchor() {
  Body body;
  body.name = "anchor";
  body.fixed = true;
  return body;
}

// The inside of a circle.
Body Track(double radius) { return Fixed({"track", {{{ArcEdge{{}, radius, Side::kConcave}, 2 * kPi, 0}}}}); }

World WorldWith(std::string name, std::vector<Body> bodies, Vec2 gravity = {0, -kG}) {
  World world;
  world.name = std::move(name);
  world.bodies = std::move(bodies);
  world.loads.gravity = gravity;
  return world;
}

double Energy(const World& world) {
  return KineticEnergy(world.bodies) + PotentialEnergy(world.loads, world.bodies);
}

struct Run {
  double worst_drift = 0;  // of the energy, absolute
  MotionStatistics statistics;
};

// A solver and a motion under it.
class Mover {
 public:
  explicit Mover(const World& world, AccelerationOptions options = {}, std::string_view solver = "dantzig")
      : solver_(MakeSolver(solver)), motion_(world, options, *solver_) {}
  AccelerationMotion* operator->() { return &motion_; }
  AccelerationMotion& operator*() { return motion_; }
  const Body& body(std::size_t i) const { return motion_.world().bodies[i]; }

 private:
  std::unique_ptr<LcpSolver> solver_;
  AccelerationMotion motion_;
};

// With LCPBENCH_MOTION_FIGURES set, what every scene came to.
void Print(const std::string& name, double drift, double period_error, const MotionStatistics& s, double wall) {
  if (std::getenv("LCPBENCH_MOTION_FIGURES") == nullptr) return;
  std::cout << "| " << name << " | " << std::setprecision(2) << drift << " | " << s.worst_penetration << " | "
            << s.worst_joint_error << " | " << period_error << " | " << s.steps << " | " << s.impacts << " | "
            << s.solves << " | " << wall << " s |\n";
}

// Moves on for `seconds`, observing at frames; energy relative to `scale` must stay within 1e-6 and penetration within
// the contact tolerance.
void ExpectConserved(Mover* mover, double scale, double seconds = kSeconds, double period_error = 0,
                     double tolerance = 1e-6) {
  constexpr double kFrame = 0.1;
  const double begin = Energy((*mover)->world());
  const double started = SteadyNow();
  double drift = 0;
  while ((*mover)->time() < seconds - 1e-9) {
    (*mover)->Advance(std::min(kFrame, seconds - (*mover)->time()));
    ASSERT_EQ((*mover)->status(), MotionStatus::kMoving) << (*mover)->detail();
    drift = std::max(drift, std::abs(Energy((*mover)->world()) - begin));
  }
  const MotionStatistics& statistics = (*mover)->statistics();
  Print((*mover)->world().name, drift / scale, period_error, statistics, SteadyNow() - started);
  EXPECT_LE(drift / scale, tolerance);
  EXPECT_LE(statistics.worst_penetration, AccelerationOptions().contact_tolerance);
  EXPECT_LE(statistics.worst_joint_error, AccelerationOptions().contact_tolerance);
  EXPECT_EQ(statistics.failed_solves, 0);
  EXPECT_GT(statistics.steps, 0);
}

TEST(AccelerationMotion, ADiscSlidesInAConcaveTrackWithThePeriodOfAPendulum) {
  const double R = 1.3;
  const double r = 0.2;
  const double amplitude = 1.1;
  const double length = R - r;
  Body disc = Movable(Disc(r), {length * std::sin(amplitude), -length * std::cos(amplitude)});
  disc.omega = 0.7;
  Mover mover(WorldWith("disc in track", {Track(R), disc}));
  ExpectConserved(&mover, disc.mass * kG * length * (1 - std::cos(amplitude)));
  EXPECT_DOUBLE_EQ(mover.body(1).omega, 0.7);
  const double period = 4 * std::sqrt(length / kG) * boost::math::ellint_1(std::sin(amplitude / 2));
  // Starts at the right turning point: at whole periods it is back.
  Mover again(WorldWith("disc in track, period", {Track(R), disc}));
  again->Advance(4 * period);
  EXPECT_NEAR(again.body(1).x.x, disc.x.x, 1e-8);
  EXPECT_NEAR(Norm(again.body(1).v), 0, 1e-7);
}


// The time between the turning points of q, whose kinetic energy is inertia(q) q'^2 / 2 and whose potential energy is
// potential(q), even in q: a whole period.
double PeriodOf(const std::function<double(double)>& inertia, const std::function<double(double)>& potential,
                double amplitude) {
  // q = amplitude sin s removes the singularity at the turning point.
  boost::math::quadrature::tanh_sinh<double> integrator;
  const auto integrand = [&](double s) {
    const double q = amplitude * std::sin(s);
    const double drop = potential(amplitude) - potential(q);
    return amplitude * std::cos(s) * std::sqrt(inertia(q) / (2 * drop));
  };
  return 4 * integrator.integrate(integrand, 0.0, kPi / 2 * (1 - 1e-9));
}

TEST(AccelerationMotion, AnEllipseRocksAndSlidesOnAPlaneWithItsExactPeriod) {
  const double a = 0.5;
  const double b = 0.3;
  const double amplitude = 0.9;
  const auto height = [&](double q) { return std::sqrt(a * a * std::sin(q) * std::sin(q) + b * b * std::cos(q) * std::cos(q)); };
  Body ellipse = Movable(Ellipse(a, b), {0, height(amplitude)}, amplitude);
  ellipse.v = {0.4, 0};
  const double m = ellipse.mass;
  const World world = WorldWith("ellipse on a plane", {Floor(), ellipse});
  Mover mover(world);
  ExpectConserved(&mover, m * kG * (height(amplitude) - b));
  EXPECT_NEAR(mover.body(1).x.x, 4, 1e-9);
  const auto slope = [&](double q) { return (a * a - b * b) * std::sin(q) * std::cos(q) / height(q); };
  const double period = PeriodOf([&](double q) { return ellipse.inertia + m * slope(q) * slope(q); },
                                 [&](double q) { return m * kG * height(q); }, amplitude);
  Mover again(world);
  again->Advance(5 * period);
  EXPECT_NEAR(again.body(1).theta, amplitude, 1e-7);
}

TEST(AccelerationMotion, AHalfDiscRocksWithItsPeriod) {
  const double r = 0.4;
  const Body shape = Movable(HalfDisc(r), {});
  const double offset = 4 * r / (3 * kPi);  // of the centre of mass from the circle's
  for (const double amplitude : {0.01, 0.6}) {
    // HalfDisc has its flat side below: turned over, the arc is.
    Body body = shape;
    body.theta = kPi + amplitude;
    body.x = {0, r - offset * std::cos(amplitude)};
    const double m = body.mass;
    const World world = WorldWith(amplitude < 0.1 ? "half disc, small" : "half disc", {Floor(), body});
    const double swing = m * kG * offset * (1 - std::cos(amplitude));
    Mover mover(world);
    ExpectConserved(&mover, swing, amplitude < 0.1 ? 2 : kSeconds);
    const double period =
        PeriodOf([&](double q) { return body.inertia + m * offset * offset * std::sin(q) * std::sin(q); },
                 [&](double q) { return -m * kG * offset * std::cos(q); }, amplitude);
    if (amplitude < 0.1) {
      EXPECT_NEAR(period, 2 * kPi * std::sqrt(body.inertia / (m * kG * offset)), 1e-4);
    }
    Mover again(world);
    again->Advance(3 * period);
    EXPECT_NEAR(again.body(1).theta, kPi + amplitude, 1e-6 * amplitude);
  }
}

TEST(AccelerationMotion, ADiscLeavesAHillWhereItsWeightCannotHoldItAnyMore) {
  const double R = 1;
  const double r = 0.25;
  const double L = R + r;
  const double v0 = 0.3;
  Body disc = Movable(Disc(r), {0, L});
  disc.v = {v0, 0};
  Mover mover(WorldWith("disc leaving a hill", {Fixed(Disc(R)), disc}));
  ExpectConserved(&mover, disc.mass * kG * L, 2);
  const double cosine = 2.0 / 3 + v0 * v0 / (3 * kG * L);
  EXPECT_NEAR(mover.body(1).v.x, std::sqrt(kG * L * cosine) * cosine, 1e-7);
  EXPECT_EQ(mover->statistics().impacts, 0);
}

TEST(AccelerationMotion, ADiscPassesFromAFloorIntoAnArcAndBack) {
  const double R = 1;
  const double r = 0.25;
  const double L = R - r;
  const double v0 = 1.2;
  // A floor that turns up into a quarter pipe at the origin.
  const Body pipe = Fixed({"quarter pipe",
                           {{{ArcEdge{{0, R}, R, Side::kConcave}, 0, -kPi / 2}, {StraightEdge{{0, 0}, {-30, 0}}, 0, 1}}}});
  Body disc = Movable(Disc(r), {-0.5, r});
  disc.v = {v0, 0};
  const World world = WorldWith("disc over a join", {pipe, disc});
  Mover mover(world);
  ExpectConserved(&mover, disc.mass * v0 * v0 / 2, 6);
  const double in_arc = 2 * std::sqrt(L / kG) * boost::math::ellint_1(v0 / (2 * std::sqrt(kG * L)));
  EXPECT_NEAR(mover.body(1).x.x, -v0 * (6 - 0.5 / v0 - in_arc), 1e-7);
  EXPECT_NEAR(mover.body(1).v.x, -v0, 1e-8);
}

Outline Room(double width, double height) {
  const double x = width / 2;
  const double y = height / 2;
  const auto edge = [](Vec2 a, Vec2 b) { return OutlinePiece{StraightEdge{a, b}, 0, 1}; };
  // Clockwise: the material is outside.
  return {"room", {{edge({-x, -y}, {-x, y}), edge({-x, y}, {x, y}), edge({x, y}, {x, -y}), edge({x, -y}, {-x, -y})}}};
}

AccelerationOptions Elastic() {
  AccelerationOptions options;
  options.impact.restitution = 1;
  return options;
}

TEST(AccelerationMotion, BilliardsKeepTheirEnergy) {
  Random random(3);
  std::vector<Body> bodies = {Fixed(Room(4, 3))};
  for (int k = 0; k < 9; ++k) {
    Body disc = Movable(Disc(0.15 + 0.01 * k), {-1.2 + 1.2 * (k % 3), -0.9 + 0.9 * (k / 3)});
    disc.v = 2 * random.InUnitDisc();
    bodies.push_back(disc);
  }
  Mover mover(WorldWith("billiards, 9 discs", bodies, {}), Elastic());
  ExpectConserved(&mover, KineticEnergy(bodies));
  EXPECT_GT(mover->statistics().impacts, 50);
}

TEST(AccelerationMotion, FreeBodiesKeepMomentumAndAngularMomentum) {
  Random random(8);
  std::vector<Body> bodies;
  for (int k = 0; k < 8; ++k) {
    const Vec2 x{-1.5 + k % 4, -0.5 + k / 4};
    const Outline outline = k % 3 == 0 ? Ellipse(0.35, 0.2) : k % 3 == 1 ? RoundedBox(0.5, 0.4, 0.1) : Box(0.4, 0.4);
    Body body = Movable(outline, x, random.Uniform(0, 6));
    // Inwards, so that they meet.
    body.v = -0.5 * x;
    body.omega = random.Uniform(-2, 2);
    bodies.push_back(body);
  }
  World world = WorldWith("free bodies", bodies, {});
  world.loads.attraction = MutualAttraction{.strength = 0.5, .softening = 0.3};
  Mover mover(world, Elastic());
  const Vec2 momentum = Momentum(bodies);
  const double angular = AngularMomentum(bodies);
  const double scale = KineticEnergy(bodies) - PotentialEnergy(world.loads, bodies);
  ExpectConserved(&mover, scale);
  EXPECT_GT(mover->statistics().impacts, 10);
  EXPECT_NEAR(Norm(Momentum(mover->world().bodies) - momentum), 0, 1e-9);
  EXPECT_NEAR(AngularMomentum(mover->world().bodies), angular, 1e-8);
}

std::vector<Body> Cradle(int count, double gap) {
  std::vector<Body> balls;
  for (int k = 0; k < count; ++k) balls.push_back(Movable(Disc(0.1), {(0.2 + gap) * k, 0}));
  balls[0].x.x -= 0.3;
  balls[0].v = {1, 0};
  return balls;
}

TEST(AccelerationMotion, InACradleWithSmallGapsTheLastBallLeavesWithTheFirstOnesVelocity) {
  Mover mover(WorldWith("cradle in a line", Cradle(5, 1e-4), {}), Elastic());
  ExpectConserved(&mover, KineticEnergy(mover->world().bodies), 1);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(mover.body(k).v.x, k == 4 ? 1 : 0, 1e-12) << k;
  EXPECT_EQ(mover->statistics().impacts, 4);
}

TEST(AccelerationMotion, TouchingBallsUnderOneRestitutionShareTheImpact) {
  for (const ImpactLaw law : {ImpactLaw::kNewton, ImpactLaw::kPoisson}) {
    AccelerationOptions options = Elastic();
    options.impact.law = law;
    Mover mover(WorldWith("touching cradle", Cradle(3, 0), {}), options);
    mover->Advance(1);
    EXPECT_NEAR(mover.body(0).v.x, -1.0 / 3, 1e-9);
    EXPECT_NEAR(mover.body(1).v.x, 2.0 / 3, 1e-9);
    EXPECT_NEAR(mover.body(2).v.x, 2.0 / 3, 1e-9);
    EXPECT_EQ(mover->statistics().impacts, 1);
  }
}

Constraint Joint(ConstraintType type, int body1, Vec2 p1, int body2, Vec2 p2, double length = 0) {
  Constraint joint;
  joint.type = type;
  joint.body1 = body1;
  joint.body2 = body2;
  joint.feature1 = Vertex{p1};
  joint.feature2 = Vertex{p2};
  joint.length = length;
  return joint;
}

// A body on a joint to a fixed anchor, swinging as a pendulum of `length` and squared gyradius `gyradius2` about its
// centre of mass (0: it does not turn).
void ExpectPendulum(const std::string& name, const Constraint& joint, double length, bool turns) {
  const double amplitude = 1.3;
  Body body = Movable(Box(0.3, 0.2), {length * std::sin(amplitude), -length * std::cos(amplitude)}, turns ? amplitude : 0);
  World world = WorldWith(name, {Anchor(), body});
  world.joints = {joint};
  const double swung = turns ? body.inertia + body.mass * length * length : body.mass * length * length;
  const double period =
      4 * std::sqrt(swung / (body.mass * kG * length)) * boost::math::ellint_1(std::sin(amplitude / 2));
  Mover again(world);
  again->Advance(5 * period);
  EXPECT_NEAR(Norm(again.body(1).x - body.x), 0, 1e-7);
  Mover mover(world);
  ExpectConserved(&mover, body.mass * kG * length * (1 - std::cos(amplitude)), kSeconds, Norm(again.body(1).x - body.x));
}

TEST(AccelerationMotion, APendulumOnAPinSwingsWithItsPeriod) {
  ExpectPendulum("pendulum on a pin", Joint(ConstraintType::kPin, 1, {0, 0.8}, 0, {0, 0}), 0.8, true);
}

TEST(AccelerationMotion, APendulumOnARodSwingsWithItsPeriod) {
  ExpectPendulum("pendulum on a rod", Joint(ConstraintType::kRod, 1, {}, 0, {}, 0.8), 0.8, false);
}

TEST(AccelerationMotion, APendulumOnAPathSwingsWithItsPeriod) {
  Constraint joint = Joint(ConstraintType::kPathJoint, 1, {}, 0, {});
  joint.feature2 = ArcEdge{{}, 0.8, Side::kConcave};
  ExpectPendulum("pendulum on a path", joint, 0.8, false);
}

TEST(AccelerationMotion, ABeadRunsAroundAnEllipseAndKeepsItsEnergy) {
  Body bead = Movable(Disc(0.05), {1, 0});
  bead.v = {0, -3};
  World world = WorldWith("bead on an ellipse", {Anchor(), bead});
  Constraint joint = Joint(ConstraintType::kPathJoint, 1, {}, 0, {});
  joint.feature2 = EllipseEdge{{}, 1, 0.5, 0, Side::kConcave};
  world.joints = {joint};
  Mover mover(world);
  ExpectConserved(&mover, bead.mass * kG * 0.5);
}

TEST(AccelerationMotion, ADoublePendulumKeepsItsEnergyAndItsJoints) {
  World world = WorldWith("double pendulum", {Anchor(), Movable(Box(0.8, 0.1), {0.4, 0}), Movable(Box(0.6, 0.1), {1.1, 0})});
  world.joints = {Joint(ConstraintType::kPin, 1, {-0.4, 0}, 0, {}), Joint(ConstraintType::kPin, 2, {-0.3, 0}, 1, {0.4, 0})};
  Mover mover(world);
  ExpectConserved(&mover, world.bodies[1].mass * kG);
}

TEST(AccelerationMotion, ASwingingCradleKeepsItsEnergy) {
  const double r = 0.1;
  const double length = 0.7;
  std::vector<Body> bodies = {Anchor()};
  World world = WorldWith("swinging cradle", {}, {0, -kG});
  for (int k = 0; k < 5; ++k) {
    const double x = (2 * r + 1e-4) * k;
    const double angle = k == 0 ? -0.8 : 0;
    bodies.push_back(Movable(Disc(r), {x + length * std::sin(angle), -length * std::cos(angle)}));
    world.joints.push_back(Joint(ConstraintType::kRod, k + 1, {}, 0, {x, 0}, length));
  }
  world.bodies = bodies;
  Mover mover(world, Elastic());
  ExpectConserved(&mover, bodies[1].mass * kG * length * (1 - std::cos(0.8)));
  EXPECT_GE(mover->statistics().impacts, 40);
}

TEST(AccelerationMotion, ABouncingBallKeepsItsTimetable) {
  const double r = 0.1;
  const double drop = 0.5;
  const double e = 0.6;
  AccelerationOptions options;
  options.impact.restitution = e;
  const World world = WorldWith("bouncing ball", {Floor(), Movable(Disc(r), {0, r + drop})});
  Mover mover(world, options);
  // Falls for t0, then flights of 2 e^k t0.
  const double t0 = std::sqrt(2 * drop / kG);
  const double v0 = kG * t0;
  double landing = t0;
  double speed = v0;
  for (int k = 1; k <= 6; ++k) {
    speed *= e;
    const double top = landing + speed / kG;
    mover->Advance(top - mover->time());
    EXPECT_EQ(mover->statistics().impacts, k);
    EXPECT_NEAR(mover.body(1).x.y, r + speed * speed / (2 * kG), 1e-9) << k;
    EXPECT_NEAR(mover.body(1).v.y, 0, 1e-8) << k;
    landing += 2 * speed / kG;
  }
  // All bounces are over after this, and the ball rests.
  mover->Advance(t0 + 2 * t0 * e / (1 - e) + 0.5 - mover->time());
  EXPECT_EQ(mover->status(), MotionStatus::kMoving) << mover->detail();
  EXPECT_NEAR(mover.body(1).x.y, r, 1e-9);
  EXPECT_NEAR(mover.body(1).v.y, 0, 1e-9);
  // Down to the resting speed: v0 e^k >= 1e-4.
  EXPECT_EQ(mover->statistics().impacts, static_cast<int>(std::ceil(std::log(1e-4 / v0) / std::log(e))) + 1);
}

TEST(AccelerationMotion, WithoutARestingSpeedBouncingStalls) {
  AccelerationOptions options;
  options.impact.restitution = 0.5;
  options.impact.resting_speed = 0;
  options.velocity_tolerance = 1e-12;
  options.max_events = 10;
  Mover mover(WorldWith("zeno", {Floor(), Movable(Disc(0.1), {0, 0.2})}), options);
  mover->Advance(5);
  EXPECT_EQ(mover->status(), MotionStatus::kStalled);
  EXPECT_NE(mover->detail().find("more than 10 events"), std::string::npos) << mover->detail();
  const double stopped = mover->time();
  mover->Advance(1);
  EXPECT_EQ(mover->time(), stopped);
}

TEST(AccelerationMotion, DampersTakeTheEnergyThatTheyDissipate) {
  World world = WorldWith("damped chain", {Anchor(), Movable(Disc(0.1), {0.5, 0}), Movable(Box(0.2, 0.1), {1, 0.1}), Floor()});
  world.bodies[3].x = {0, -0.9};
  world.joints = {Joint(ConstraintType::kPin, 1, {-0.5, 0}, 0, {})};
  world.loads.springs = {{{1, {}}, {2, {0.1, 0}}, 8, 0.2}};
  world.loads.dampers = {{{1, {}}, {2, {0.1, 0}}, 0.05}, {{0, {0, 1}}, {2, {}}, 0.02}};
  Mover mover(world);
  const double begin = Energy(world);
  double dissipated = 0;
  // Simpson's rule; contacts make corners in the power, not jumps, and e = 0 impacts would take energy of their own.
  constexpr double kFrame = 0.002;
  double power = DampingPower(world.loads, mover->world().bodies);
  for (int k = 0; k < 1000; ++k) {
    mover->Advance(kFrame);
    const double middle = DampingPower(world.loads, mover->world().bodies);
    mover->Advance(kFrame);
    const double end = DampingPower(world.loads, mover->world().bodies);
    dissipated += (2 * kFrame) / 6 * (power + 4 * middle + end);
    power = end;
    if (mover->statistics().impacts > 0) break;
    ASSERT_NEAR(Energy(mover->world()) - begin, dissipated, 1e-8);
  }
  EXPECT_LT(dissipated, -1e-3);
}

}  // namespace
}  // namespace lcpbench
