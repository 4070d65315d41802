// Motion at the acceleration level against exact periods and conserved quantities.

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/ellint_1.hpp>

#include "model/contact/loads.h"
#include "tests/model/contact/momenta.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

constexpr double kSeconds = 10;

TEST(AccelerationMotion, ADiscSlidesInAConcaveTrackWithThePeriodOfAPendulum) {
  const double R = 1.3;
  const double r = 0.2;
  const double amplitude = 1.1;
  const double length = R - r;
  const Body disc = Movable(Disc(r), {length * std::sin(amplitude), -length * std::cos(amplitude)}, 0, {}, 0.7);
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
  const Body ellipse = Movable(Ellipse(a, b), {0, height(amplitude)}, amplitude, {0.4, 0});
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
  const Body disc = Movable(Disc(r), {0, L}, 0, {v0, 0});
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
  const Body disc = Movable(Disc(r), {-0.5, r}, 0, {v0, 0});
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

World Billiards() {
  Random random(3);
  std::vector<Body> bodies = {Fixed(Room(4, 3))};
  for (int k = 0; k < 9; ++k) {
    const Vec2 x{-1.2 + 1.2 * (k % 3), -0.9 + 0.9 * std::floor(k / 3.0)};
    bodies.push_back(Movable(Disc(0.15 + 0.01 * k), x, 0, 2 * random.InUnitDisc()));
  }
  return WorldWith("billiards, 9 discs", bodies, {});
}

World BeadOnAnEllipse() {
  World world = WorldWith("bead on an ellipse", {Anchor(), Movable(Disc(0.05), {1, 0}, 0, {0, -3})});
  world.joints = {Joint(ConstraintType::kPathJoint, 1, {}, 0, {})};
  world.joints[0].feature2 = EllipseEdge{{}, 1, 0.5, 0, Side::kConcave};
  return world;
}

World DoublePendulum() {
  World world =
      WorldWith("double pendulum", {Anchor(), Movable(Box(0.8, 0.1), {0.4, 0}), Movable(Box(0.6, 0.1), {1.1, 0})});
  world.joints = {Joint(ConstraintType::kPin, 1, {-0.4, 0}, 0, {}),
                  Joint(ConstraintType::kPin, 2, {-0.3, 0}, 1, {0.4, 0})};
  return world;
}

World SwingingCradle(double length, double angle) {
  const double r = 0.1;
  World world = WorldWith("swinging cradle", {Anchor()});
  for (int k = 0; k < 5; ++k) {
    const double x = (2 * r + 1e-4) * k;
    const double swing = k == 0 ? angle : 0;
    world.bodies.push_back(Movable(Disc(r), {x + length * std::sin(swing), -length * std::cos(swing)}));
    world.joints.push_back(Joint(ConstraintType::kRod, k + 1, {}, 0, {x, 0}, length));
  }
  return world;
}

TEST(AccelerationMotion, KeepsTheEnergyOfWhatSwingsTumblesAndHits) {
  const World tumbling =
      WorldWith("tumbling rounded box", {Floor(), Movable(RoundedBox(0.3, 0.5, 0.12), {0, 0.25}, 0, {}, 1.5)});
  struct Case {
    World world;
    double height = 0;  // that body 1's energy is enough for; 0: the scale is the energy of motion
    int impacts = 0;    // at least
    double seconds = kSeconds;
  };
  for (const Case& each : {Case{Billiards(), 0, 51}, Case{BeadOnAnEllipse(), 0.5}, Case{DoublePendulum(), 1},
                           Case{SwingingCradle(0.7, -0.8), 0.7 * (1 - std::cos(0.8)), 40}, Case{tumbling, 0, 1, 5}}) {
    SCOPED_TRACE(each.world.name);
    const std::vector<Body>& bodies = each.world.bodies;
    Mover mover(each.world, WithRestitution(1));
    ExpectConserved(&mover, each.height > 0 ? bodies[1].mass * kG * each.height : KineticEnergy(bodies), each.seconds);
    EXPECT_GE(mover->statistics().impacts, each.impacts);
  }
}

TEST(AccelerationMotion, FreeBodiesKeepMomentumAndAngularMomentum) {
  Random random(8);
  std::vector<Body> bodies;
  for (int k = 0; k < 8; ++k) {
    const Vec2 x{-1.5 + k % 4, -0.5 + std::floor(k / 4.0)};
    const Outline outline = k % 3 == 0 ? Ellipse(0.35, 0.2) : k % 3 == 1 ? RoundedBox(0.5, 0.4, 0.1) : Box(0.4, 0.4);
    const double theta = random.Uniform(0, 6);
    // Inwards, so that they meet.
    bodies.push_back(Movable(outline, x, theta, -0.5 * x, random.Uniform(-2, 2)));
  }
  World world = WorldWith("free bodies", bodies, {});
  world.loads.attraction = MutualAttraction{.strength = 0.5, .softening = 0.3};
  Mover mover(world, WithRestitution(1));
  const Vec2 momentum = Momentum(bodies);
  const double angular = AngularMomentum(bodies);
  const double scale = KineticEnergy(bodies) - PotentialEnergy(world.loads, bodies);
  ExpectConserved(&mover, scale);
  EXPECT_GT(mover->statistics().impacts, 10);
  EXPECT_NEAR(Norm(Momentum(mover->world().bodies) - momentum), 0, 1e-9);
  EXPECT_NEAR(AngularMomentum(mover->world().bodies), angular, 1e-8);
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
  ExpectConserved(&mover, body.mass * kG * length * (1 - std::cos(amplitude)));
}

TEST(AccelerationMotion, PendulumsOnAPinARodAndAPathSwingWithTheirPeriods) {
  ExpectPendulum("pendulum on a pin", Joint(ConstraintType::kPin, 1, {0, 0.8}, 0, {0, 0}), 0.8, true);
  ExpectPendulum("pendulum on a rod", Joint(ConstraintType::kRod, 1, {}, 0, {}, 0.8), 0.8, false);
  Constraint path = Joint(ConstraintType::kPathJoint, 1, {}, 0, {});
  path.feature2 = ArcEdge{{}, 0.8, Side::kConcave};
  ExpectPendulum("pendulum on a path", path, 0.8, false);
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

TEST(AccelerationMotion, AStackOfBoxesStaysWhereItIs) {
  std::vector<Body> bodies = {Floor()};
  for (int k = 0; k < 4; ++k) bodies.push_back(Movable(Box(0.4 - 0.05 * k, 0.2), {0.02 * k, 0.1 + 0.2 * k}));
  Mover mover(WorldWith("stack of boxes", bodies));
  ExpectConserved(&mover, bodies[1].mass * kG * 0.1, 2);
  for (std::size_t i = 1; i < bodies.size(); ++i) EXPECT_NEAR(Norm(mover.body(i).x - bodies[i].x), 0, 1e-8) << i;
}

}  // namespace
}  // namespace lcpbench
