#include "model/contact/loads.h"

#include "model/scenes/random.h"
#include "tests/model/contact/momenta.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

constexpr int kCases = 200;

Vec2 RandomVector(Random* random, double size) { return size * random->InUnitDisc(); }

std::vector<Body> RandomBodies(Random* random) {
  std::vector<Body> bodies(4);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    body.mass = random->Uniform(0.5, 3);
    body.inertia = random->Uniform(0.5, 3);
    body.x = Vec2{3.0 * static_cast<double>(i), 0} + RandomVector(random, 0.5);
    body.theta = random->Uniform(-3, 3);
    body.v = RandomVector(random, 2);
    body.omega = random->Uniform(-2, 2);
  }
  return bodies;
}

Attachment RandomAttachment(Random* random, int body) { return {body, RandomVector(random, 0.5)}; }

// Conservative loads of every kind.
Loads RandomLoads(Random* random) {
  Loads loads;
  loads.gravity = RandomVector(random, 10);
  const Attachment a = RandomAttachment(random, 0);
  const Attachment b = RandomAttachment(random, 1);
  const Attachment c = RandomAttachment(random, 2);
  const Attachment d = RandomAttachment(random, 3);
  loads.springs = {{a, b, random->Uniform(0, 9), random->Uniform(0, 2)}, {c, d, 3, 0}};
  const Vec2 force = RandomVector(random, 5);
  loads.wrenches = {{c, force, random->Uniform(-2, 2)}};
  loads.attraction = MutualAttraction{random->Uniform(-2, 2), 0.2};
  return loads;
}

// The bodies a time later, at constant velocity.
std::vector<Body> Moved(std::vector<Body> bodies, double time) {
  for (Body& body : bodies) {
    body.x = body.x + time * body.v;
    body.theta += time * body.omega;
  }
  return bodies;
}

double Power(const std::vector<Body>& bodies) {
  double power = 0;
  for (const Body& body : bodies) {
    if (!body.fixed) power += Dot(body.force, body.v) + body.torque * body.omega;
  }
  return power;
}

TEST(Loads, ThePowerOfConservativeLoadsIsTheLossOfPotentialEnergy) {
  Random random(1);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(&random);
    const Loads loads = RandomLoads(&random);
    if (k % 2 == 1) {
      // Held, but in the way of springs: no work on it is counted, so it must not move.
      bodies[3].fixed = true;
      bodies[3].v = {};
      bodies[3].omega = 0;
    }
    SetLoads(loads, bodies);
    constexpr double kStep = 1e-5;
    const double change =
        (PotentialEnergy(loads, Moved(bodies, kStep)) - PotentialEnergy(loads, Moved(bodies, -kStep))) / (2 * kStep);
    const double power = Power(bodies);
    EXPECT_NEAR(power, -change, 1e-7 * (1 + std::abs(power))) << k;
  }
}

TEST(Loads, DampersAndThrustersDoTheRestOfTheWork) {
  Random random(2);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(&random);
    Loads loads;
    const Attachment a = RandomAttachment(&random, 0);
    const Attachment b = RandomAttachment(&random, 1);
    const Attachment c = RandomAttachment(&random, 2);
    loads.dampers = {{a, b, random.Uniform(0.1, 9)}, {b, c, 2}};
    SetLoads(loads, bodies);
    EXPECT_NEAR(Power(bodies), DampingPower(loads, bodies), 1e-12 * (1 + std::abs(Power(bodies))));
    EXPECT_LT(DampingPower(loads, bodies), 0);
    EXPECT_EQ(PotentialEnergy(loads, bodies), 0);

    const Vec2 force = RandomVector(&random, 3);
    const Loads thrust{
        .gravity = {}, .springs = {}, .dampers = {}, .thrusters = {{c, force}}, .wrenches = {}, .attraction = {}};
    SetLoads(thrust, bodies);
    const Vec2 arm = Rotate(SinCos(bodies[2].theta), c.point);
    const Vec2 turned = Rotate(SinCos(bodies[2].theta), force);
    EXPECT_NEAR(Power(bodies), Dot(turned, bodies[2].v + bodies[2].omega * Perp(arm)), 1e-12);
    EXPECT_EQ(PotentialEnergy(thrust, bodies), 0);
  }
}

TEST(Loads, InternalLoadsLeaveMomentaAlone) {
  Random random(4);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(&random);
    Loads loads = RandomLoads(&random);
    loads.gravity = {};
    loads.wrenches.clear();
    const Attachment a = RandomAttachment(&random, 1);
    const Attachment b = RandomAttachment(&random, 3);
    loads.dampers = {{a, b, 1}};
    SetLoads(loads, bodies);
    // An impulse of the loads over a short time.
    const Vec2 momentum = Momentum(bodies);
    const double angular = AngularMomentum(bodies);
    const double kinetic = KineticEnergy(bodies);
    constexpr double kTime = 0.1;
    for (Body& body : bodies) {
      body.v = body.v + (kTime / body.mass) * body.force;
      body.omega += kTime / body.inertia * body.torque;
    }
    EXPECT_NEAR(Norm(Momentum(bodies) - momentum), 0, 1e-12);
    EXPECT_NEAR(AngularMomentum(bodies), angular, 1e-11);
    EXPECT_NE(KineticEnergy(bodies), kinetic);
  }
}

TEST(Loads, ASpringPullsWhenLongAndPushesWhenShort) {
  std::vector<Body> bodies(2);
  bodies[1].x = {3, 0};
  ApplySpring({{0, {}}, {1, {}}, 2, 1}, bodies);
  EXPECT_EQ(bodies[0].force, (Vec2{4, 0}));
  EXPECT_EQ(bodies[1].force, (Vec2{-4, 0}));
  ApplySpring({{0, {}}, {1, {}}, 2, 5}, bodies);
  EXPECT_EQ(bodies[0].force.x, 0) << "forces add up";
  ClearLoads(bodies);
  ApplySpring({{0, {}}, {1, {}}, 2, 5}, bodies);
  EXPECT_EQ(bodies[0].force.x, -4);
}

TEST(Loads, WithoutADirectionOrWithBadNumbersAreRefused) {
  const double nan = std::nan("");
  std::vector<Body> bodies(2);
  const auto refuses = [&](const auto& load) {
    Loads loads;
    using Load = std::decay_t<decltype(load)>;
    if constexpr (std::is_same_v<Load, Spring>) loads.springs = {load};
    if constexpr (std::is_same_v<Load, Damper>) loads.dampers = {load};
    if constexpr (std::is_same_v<Load, Thruster>) loads.thrusters = {load};
    if constexpr (std::is_same_v<Load, Wrench>) loads.wrenches = {load};
    if constexpr (std::is_same_v<Load, MutualAttraction>) loads.attraction = load;
    if constexpr (std::is_same_v<Load, Vec2>) loads.gravity = load;
    if (!RefusalOf([&] { SetLoads(loads, bodies); }).empty()) return true;
    for (const Body& body : bodies) EXPECT_TRUE(IsFinite(body.force) && std::isfinite(body.torque));
    return false;
  };
  // Both bodies at the origin: only the spring without rest length is defined there.
  EXPECT_FALSE(refuses(Spring{{0, {}}, {1, {}}, 1, 0}));
  EXPECT_TRUE(refuses(Spring{{0, {}}, {1, {}}, 1, 0.5}));
  EXPECT_TRUE(refuses(Damper{{0, {}}, {1, {}}, 1}));
  EXPECT_TRUE(refuses(MutualAttraction{1, 0}));
  EXPECT_FALSE(refuses(MutualAttraction{1, 0.1}));
  bodies[1].x = {1, 0};
  EXPECT_TRUE(refuses(Spring{{0, {}}, {2, {}}, 1, 0}));
  EXPECT_TRUE(refuses(Spring{{-1, {}}, {1, {}}, 1, 0}));
  EXPECT_TRUE(refuses(Spring{{0, {}}, {1, {}}, -1, 0}));
  EXPECT_TRUE(refuses(Spring{{0, {}}, {1, {}}, 1, -1}));
  EXPECT_TRUE(refuses(Spring{{0, {nan, 0}}, {1, {}}, 1, 0}));
  EXPECT_TRUE(refuses(Damper{{0, {}}, {1, {}}, nan}));
  EXPECT_TRUE(refuses(Thruster{{0, {}}, {nan, 0}}));
  EXPECT_TRUE(refuses(Wrench{{0, {}}, {}, nan}));
  EXPECT_TRUE(refuses(Vec2{0, nan}));
  EXPECT_TRUE(refuses(MutualAttraction{nan, 0}));
}

}  // namespace
}  // namespace lcpbench
