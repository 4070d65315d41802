#include "model/motion/acceleration_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
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
#include "tests/solvers_under_test.h"

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

double Energy(const World& world) { return KineticEnergy(world.bodies) + PotentialEnergy(world.loads, world.bodies); }

struct Run {
  double worst_drift = 0;  // of the energy, absolute
  MotionStatistics statistics;
};

// A solver and a motion under it.
class Mover {
 public:
  explicit Mover(const World& world, const AccelerationOptions& options = {}, std::string_view solver = "dantzig")
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
  EXPECT_NEAR(mover.body(1).omega, 0.7, 1e-12);
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
  const auto integrand = [&](double s) {
    const double q = amplitude * std::sin(s);
    const double drop = potential(amplitude) - potential(q);
    return amplitude * std::cos(s) * std::sqrt(inertia(q) / (2 * drop));
  };
  constexpr unsigned kOneInterval = 0;
  return 4 * boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, 0.0, kPi / 2, kOneInterval);
}

TEST(AccelerationMotion, AnEllipseRocksAndSlidesOnAPlaneWithItsExactPeriod) {
  const double a = 0.5;
  const double b = 0.3;
  const double amplitude = 0.9;
  const auto height = [&](double q) {
    return std::sqrt(a * a * std::sin(q) * std::sin(q) + b * b * std::cos(q) * std::cos(q));
  };
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
  const Body pipe = Fixed(
      {"quarter pipe", {{{ArcEdge{{0, R}, R, Side::kConcave}, 0, -kPi / 2}, {StraightEdge{{0, 0}, {-30, 0}}, 0, 1}}}});
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
    Body disc = Movable(Disc(0.15 + 0.01 * k), {-1.2 + 1.2 * (k % 3), -0.9 + 0.9 * std::floor(k / 3.0)});
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
    const Vec2 x{-1.5 + k % 4, -0.5 + std::floor(k / 4.0)};
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
  balls.reserve(static_cast<std::size_t>(count));
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
  Body body =
      Movable(Box(0.3, 0.2), {length * std::sin(amplitude), -length * std::cos(amplitude)}, turns ? amplitude : 0);
  World world = WorldWith(name, {Anchor(), body});
  world.joints = {joint};
  const double swung = turns ? body.inertia + body.mass * length * length : body.mass * length * length;
  const double period =
      4 * std::sqrt(swung / (body.mass * kG * length)) * boost::math::ellint_1(std::sin(amplitude / 2));
  Mover again(world);
  again->Advance(5 * period);
  EXPECT_NEAR(Norm(again.body(1).x - body.x), 0, 1e-7);
  Mover mover(world);
  ExpectConserved(&mover, body.mass * kG * length * (1 - std::cos(amplitude)), kSeconds,
                  Norm(again.body(1).x - body.x));
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
  World world =
      WorldWith("double pendulum", {Anchor(), Movable(Box(0.8, 0.1), {0.4, 0}), Movable(Box(0.6, 0.1), {1.1, 0})});
  world.joints = {Joint(ConstraintType::kPin, 1, {-0.4, 0}, 0, {}),
                  Joint(ConstraintType::kPin, 2, {-0.3, 0}, 1, {0.4, 0})};
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
  EXPECT_NEAR(mover.body(1).x.y, r, 1e-8);
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

// Integrates the dampers' power beside the motion, by Boole's rule, as long as nothing hits: e = 0 takes energy of its
// own.
void ExpectDampersToTakeWhatIsLost(const World& world, double seconds) {
  constexpr double kFrame = 0.001;
  constexpr std::array<double, 5> kWeights = {7, 32, 12, 32, 7};
  Mover mover(world);
  const double begin = Energy(world);
  double dissipated = 0;
  double power = DampingPower(world.loads, mover->world().bodies);
  while (mover->time() < seconds) {
    double sum = kWeights[0] * power;
    for (std::size_t k = 1; k < 5; ++k) {
      mover->Advance(kFrame);
      power = DampingPower(world.loads, mover->world().bodies);
      sum += kWeights[k] * power;
    }
    dissipated += 4 * kFrame * sum / 90;
    ASSERT_EQ(mover->statistics().impacts, 0);
    ASSERT_NEAR(Energy(mover->world()) - begin, dissipated, 1e-9) << mover->time();
  }
  EXPECT_LT(dissipated, -5e-3);
}

TEST(AccelerationMotion, DampersTakeTheEnergyThatTheyDissipate) {
  World chain = WorldWith("damped chain", {Anchor(), Movable(Disc(0.1), {0.5, 0}), Movable(Box(0.2, 0.1), {1, 0.1})});
  chain.joints = {Joint(ConstraintType::kPin, 1, {-0.5, 0}, 0, {})};
  for (Body& body : chain.bodies) body.outline.clear();
  chain.loads.springs = {{{1, {}}, {2, {0.1, 0}}, 8, 0.6}};
  chain.loads.dampers = {{{1, {}}, {2, {0.1, 0}}, 0.05}, {{0, {0, 1}}, {2, {}}, 0.02}};
  ExpectDampersToTakeWhatIsLost(chain, 2);
  World track = WorldWith("damped disc in track", {Track(1), Movable(Disc(0.2), {0.48, -0.64})});
  track.loads.dampers = {{{0, {0, 2}}, {1, {}}, 0.05}};
  ExpectDampersToTakeWhatIsLost(track, 2);
}

TEST(AccelerationMotion, TheSameStartGivesTheSameBits) {
  Random random(21);
  std::vector<Body> bodies = {Fixed(Bowl(1.6, 1.4, 1.2))};
  for (int k = 0; k < 6; ++k) {
    const Outline outline = k % 2 == 0 ? Ellipse(0.16, 0.1) : RoundedBox(0.3, 0.2, 0.05);
    bodies.push_back(Movable(outline, {-0.4 + 0.4 * (k % 3), -0.6 + 0.45 * std::floor(k / 3.0)}, random.Uniform(0, 6)));
  }
  const World world = WorldWith("bowl", bodies);
  AccelerationOptions options;
  options.impact.restitution = 0.3;
  Mover first(world, options);
  Mover second(world, options);
  const double started = SteadyNow();
  first->Advance(1);
  Print("ovals in a bowl, 1 s", 0, 0, first->statistics(), SteadyNow() - started);
  second->Advance(1);
  EXPECT_EQ(first->status(), MotionStatus::kMoving) << first->detail();
  EXPECT_EQ(first->statistics().solves, second->statistics().solves);
  EXPECT_GT(first->statistics().impacts, 10);
  EXPECT_LE(first->statistics().worst_penetration, options.contact_tolerance);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& a = first.body(i);
    const Body& b = second.body(i);
    EXPECT_TRUE(a.x.x == b.x.x && a.x.y == b.x.y && a.theta == b.theta) << i;
    EXPECT_TRUE(a.v.x == b.v.x && a.v.y == b.v.y && a.omega == b.omega) << i;
  }
}

TEST(AccelerationMotion, ABoxThatFallsOnACornerComesToLieFlat) {
  for (const double tilt : {0.3, -0.7, 1e-4}) {
    const World world = WorldWith("falling box", {Floor(), Movable(Box(0.4, 0.2), {0, 0.6}, tilt)});
    AccelerationOptions options;
    options.impact.restitution = 0.4;
    Mover mover(world, options);
    const double started = SteadyNow();
    mover->Advance(5);
    Print("box falling flat", 0, 0, mover->statistics(), SteadyNow() - started);
    EXPECT_EQ(mover->status(), MotionStatus::kMoving) << mover->detail();
    EXPECT_NEAR(mover.body(1).theta, 0, 1e-5) << tilt;
    EXPECT_NEAR(mover.body(1).x.y, 0.1, 1e-5) << tilt;
    EXPECT_NEAR(mover.body(1).omega, 0, 1e-5) << tilt;
    EXPECT_LE(mover->statistics().worst_penetration, options.contact_tolerance);
  }
}

TEST(AccelerationMotion, AStackOfBoxesStaysWhereItIs) {
  std::vector<Body> bodies = {Floor()};
  for (int k = 0; k < 4; ++k) bodies.push_back(Movable(Box(0.4 - 0.05 * k, 0.2), {0.02 * k, 0.1 + 0.2 * k}));
  Mover mover(WorldWith("stack of boxes", bodies));
  ExpectConserved(&mover, bodies[1].mass * kG * 0.1, 2);
  for (std::size_t i = 1; i < bodies.size(); ++i) EXPECT_NEAR(Norm(mover.body(i).x - bodies[i].x), 0, 1e-8) << i;
}

TEST(AccelerationMotion, ARoundedBoxTumblesElasticallyWithoutLosingEnergy) {
  Body box = Movable(RoundedBox(0.3, 0.5, 0.12), {0, 0.25});
  box.omega = 1.5;
  const World world = WorldWith("tumbling rounded box", {Floor(), box});
  Mover mover(world, Elastic());
  ExpectConserved(&mover, KineticEnergy(world.bodies), 5);
}

TEST(AccelerationMotion, AKinematicTableCarriesADisc) {
  Body table = Fixed(Box(2, 0.2), {0.3, 0});
  table.v = {0.5, 0.2};
  table.acceleration = {-0.3, 0.8};
  const double r = 0.25;
  Mover mover(WorldWith("lift", {table, Movable(Disc(r), {0, 0.1 + r})}), {});
  // Meets the disc with 0.2 m/s: e = 0 makes that the disc's, too.
  mover->Advance(1.25);
  const double t = mover->time();
  EXPECT_DOUBLE_EQ(mover.body(0).x.x, 0.3 + t * (0.5 - 0.3 * t / 2));
  EXPECT_DOUBLE_EQ(mover.body(0).x.y, t * (0.2 + 0.8 * t / 2));
  EXPECT_NEAR(mover.body(1).x.x, 0, 1e-12);
  EXPECT_NEAR(mover.body(1).x.y, 0.1 + r + t * (0.2 + 0.8 * t / 2), 1e-9);
  EXPECT_NEAR(mover.body(1).v.y, 0.2 + 0.8 * t, 1e-9);
}

TEST(AccelerationMotion, ASpinningRoundDrumLeavesADiscAloneAndAnOvalOneThrowsIt) {
  const Outline round{"drum", {{{ArcEdge{{}, 1, Side::kConcave}, 2 * kPi, 0}}}};
  const Outline oval{"drum", {{{EllipseEdge{{}, 1, 0.8, 0, Side::kConcave}, 2 * kPi, 0}}}};
  const std::array<Outline, 2> drums = {round, oval};
  for (const Outline& outline : drums) {
    Body drum = Fixed(outline);
    drum.omega = 3;
    const World world =
        WorldWith(&outline == &drums[0] ? "round drum" : "oval drum", {drum, Movable(Disc(0.2), {0, -0.6})});
    Mover mover(world);
    const double started = SteadyNow();
    mover->Advance(2);
    Print("kinematic drum", 0, 0, mover->statistics(), SteadyNow() - started);
    EXPECT_EQ(mover->status(), MotionStatus::kMoving) << mover->detail();
    EXPECT_DOUBLE_EQ(mover.body(0).theta, 6);
    const bool is_round = &outline == drums.data();
    EXPECT_EQ(std::abs(mover.body(1).x.x) < 1e-9, is_round);
    EXPECT_LE(mover->statistics().worst_penetration, 1e-6);
  }
}

TEST(AccelerationMotion, ARopeGetsTautAndThenHoldsADiscOnACircle) {
  const double length = 0.8;
  Body disc = Movable(Disc(0.1), {0.48, 0});
  World world = WorldWith("rope", {Anchor(), disc});
  world.joints = {Joint(ConstraintType::kRope, 1, {}, 0, {}, length)};
  Mover mover(world);
  // Falls freely to (0.48, -0.64), where e = 0 leaves the velocity along the circle.
  const double v = std::sqrt(2 * kG * 0.64);
  const double along = v * 0.6;
  mover->Advance(v / kG + 0.05);
  EXPECT_EQ(mover->statistics().impacts, 1);
  EXPECT_NEAR(Norm(mover.body(1).x), length, 1e-8);
  EXPECT_NEAR(Energy(mover->world()), disc.mass * (along * along / 2 - kG * 0.64), 1e-9);
  // Elastic: back the way it came along the rope.
  Mover bouncing(world, Elastic());
  ExpectConserved(&bouncing, disc.mass * kG * 0.64, 5);
  EXPECT_LE(Norm(bouncing.body(1).x), length + 1e-6);
}

TEST(AccelerationMotion, ABulletDoesNotPassThroughAThinWall) {
  Random random(5);
  for (int k = 0; k < 40; ++k) {
    const double speed = 10 * std::pow(1000, random.Uniform());
    Body bullet =
        Movable(k % 2 == 0 ? Disc(0.01) : Box(0.02, 0.015), {-1, random.Uniform(-0.4, 0.4)}, random.Uniform(0, 6));
    bullet.v = {speed, 0};
    Mover mover(WorldWith("bullet", {Fixed(Box(0.002, 1)), bullet}, {}), Elastic());
    mover->Advance(2 / speed);
    EXPECT_GE(mover->statistics().impacts, 1) << k;
    EXPECT_LT(mover.body(1).x.x, 0) << k;
  }
}

TEST(AccelerationMotion, ADiscThatGrazesACornerBetweenTwoStepsIsSeen) {
  // Passes under the corner so closely that gaps are open at the ends of most steps around it.
  for (int k = 0; k < 50; ++k) {
    const double overlap = 1e-3 * (k % 2 == 0 ? 1 : -1);
    Body disc = Movable(Disc(0.1), {-1 - 0.003 * k, -0.1 + overlap});
    disc.v = {2, 0};
    Body wedge = Fixed({"wedge",
                        {{{StraightEdge{{0, 0}, {1, 1}}, 0, 1},
                          {StraightEdge{{1, 1}, {-1, 1}}, 0, 1},
                          {StraightEdge{{-1, 1}, {0, 0}}, 0, 1}}}});
    Mover mover(WorldWith("graze", {wedge, disc}, {}), Elastic());
    mover->Advance(1);
    EXPECT_EQ(mover->statistics().impacts, overlap > 0 ? 1 : 0) << k;
  }
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
  AccelerationMotion motion(WorldWith("nan", {Floor(), Movable(Disc(0.1), {0, 0.3})}), {}, solver);
  motion.Advance(3);
  EXPECT_EQ(motion.status(), MotionStatus::kSolverFailed);
  EXPECT_NE(motion.detail().find("as told"), std::string::npos) << motion.detail();
  // Where it failed: at the floor.
  EXPECT_NEAR(motion.time(), std::sqrt(2 * 0.2 / kG), 1e-9);
  EXPECT_NEAR(motion.world().bodies[1].x.y, 0.1, 1e-9);
}

TEST(AccelerationMotion, ASolverThatFailsIsCountedAndItsBestPointTaken) {
  TestSolver solver(0);
  AccelerationMotion motion(WorldWith("no forces", {Floor(), Movable(Disc(0.1), {0, 0.1})}), {}, solver);
  motion.Advance(0.01);
  EXPECT_EQ(motion.statistics().failed_solves, motion.statistics().solves);
  EXPECT_GT(motion.statistics().failed_solves, 0);
  // Falls through the floor, which shows.
  EXPECT_GT(motion.statistics().worst_penetration + std::abs(motion.world().bodies[1].x.y - 0.1), 1e-5);
}

TEST(AccelerationMotion, WallsThatCloseOnADiscDoNotThrow) {
  Body left = Fixed(Box(0.2, 1), {-0.21, 0});
  Body right = Fixed(Box(0.2, 1), {0.21, 0});
  left.v = {0.1, 0};
  right.v = {-0.1, 0};
  Mover mover(WorldWith("press", {left, right, Movable(Disc(0.1), {0, 0})}));
  mover->Advance(0.3);
  EXPECT_GT(mover->statistics().failed_solves, 0);
  EXPECT_TRUE(std::isfinite(mover.body(2).x.x));
}

TEST(AccelerationMotion, EverySolverDrivesIt) {
  const double R = 1;
  World world =
      WorldWith("two discs in a track", {Track(R), Movable(Disc(0.2), {0.8, 0}), Movable(Disc(0.3), {0, -0.7})});
  constexpr double kTime = 0.45;
  Mover reference(world);
  reference->Advance(kTime);
  for (const SolverEntry& entry : OwnSolversAndAPeerOfEachLibrary()) {
    Mover mover(world, {}, entry.key);
    const double started = SteadyNow();
    mover->Advance(kTime);
    Print("by " + std::string(entry.key), 0, 0, mover->statistics(), SteadyNow() - started);
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

TEST(AccelerationMotion, RefusesWhatMakesNoSense) {
  const auto solver = MakeSolver("dantzig");
  const World world = WorldWith("fine", {Floor(), Movable(Disc(0.1), {0, 1})});
  const auto with = [&](auto change) {
    AccelerationOptions options;
    change(options);
    AccelerationMotion motion(world, options, *solver);
  };
  EXPECT_NO_THROW(with([](AccelerationOptions&) {}));
  EXPECT_THROW(with([](AccelerationOptions& o) { o.contact_tolerance = 0; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.velocity_tolerance = -1; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.absolute_error = std::nan(""); }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.largest_step = 0; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.search_range = 1e-7; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.position_threshold = 2; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.max_events = 0; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.impact.restitution = 1.1; }), InputError);
  EXPECT_THROW(with([](AccelerationOptions& o) { o.impact.pair_restitution = [](int, int) { return 0.5; }; }),
               InputError);
  AccelerationMotion motion(world, {}, *solver);
  EXPECT_THROW(motion.Advance(0), InputError);
  EXPECT_THROW(motion.Advance(-1), InputError);
  EXPECT_THROW(motion.Advance(std::numeric_limits<double>::infinity()), InputError);
  World wrong = world;
  wrong.bodies[1].mass = 0;
  EXPECT_THROW(AccelerationMotion(wrong, {}, *solver), InputError);
}

}  // namespace
}  // namespace lcpbench
