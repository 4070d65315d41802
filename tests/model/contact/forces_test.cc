#include "model/contact/forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "model/geometry/trig.h"
#include "support/input_error.h"
#include "tests/model/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kCases = 500;

std::vector<Body> RandomBodies(int count, Random* random) {
  std::vector<Body> bodies;
  for (int k = 0; k < count; ++k) {
    bodies.push_back(RandomBody(random));
    bodies.back().name = "body " + std::to_string(k);
  }
  ClearLoads(bodies);
  return bodies;
}

Spring RandomSpring(Random* random) {
  return {{0, random->Vector(1)}, {1, random->Vector(1)}, random->Uniform(0, 9), random->Uniform(0, 2)};
}

Damper RandomDamper(Random* random) { return {{0, random->Vector(1)}, {1, random->Vector(1)}, random->Uniform(0, 9)}; }

MutualAttraction RandomAttraction(Random* random) { return {random->Uniform(-2, 2), random->Uniform(0.1, 1)}; }

// The sum of all forces, and of all torques about the world's origin.
void ExpectMomentumConserved(const std::vector<Body>& bodies) {
  Vec2 force;
  double torque = 0;
  double scale = 0;
  for (const Body& body : bodies) {
    force = force + body.force;
    torque += body.torque + Cross(body.x, body.force);
    scale = std::max({scale, Norm(body.force), std::abs(body.torque)});
  }
  EXPECT_GT(scale, 0);
  EXPECT_NEAR(Norm(force), 0, 1e-14 * scale);
  EXPECT_NEAR(torque, 0, 1e-13 * scale);
}

// The work per time of all loads.
double Power(const std::vector<Body>& bodies) {
  double power = 0;
  for (const Body& body : bodies) power += Dot(body.force, body.v) + body.torque * body.omega;
  return power;
}

using Energy = std::function<double(const std::vector<Body>&)>;

// Power of the loads against the loss of energy along the bodies' velocities.
void ExpectWorkIsLossOfEnergy(std::vector<Body> bodies, const Energy& energy) {
  const double h = 1e-5;
  const auto at = [&](double time) {
    std::vector<Body> moved = bodies;
    for (Body& body : moved) {
      if (body.fixed) continue;
      body.x = body.x + time * body.v;
      body.theta += time * body.omega;
    }
    return energy(moved);
  };
  for (Body& body : bodies) {
    if (!body.fixed) continue;
    body.v = {};
    body.omega = 0;
  }
  const double loss = -(at(h) - at(-h)) / (2 * h);
  EXPECT_NEAR(Power(bodies), loss, 1e-7 * (1 + std::abs(loss)));
}

TEST(Forces, BetweenTwoBodiesConserveMomentum) {
  Random random(1);
  for (int k = 0; k < kCases; ++k) {
    SCOPED_TRACE(k);
    std::vector<Body> bodies = RandomBodies(2, &random);
    ApplySpring(RandomSpring(&random), bodies);
    ExpectMomentumConserved(bodies);
    ApplyDamper(RandomDamper(&random), bodies);
    ExpectMomentumConserved(bodies);
    ApplyMutualAttraction(RandomAttraction(&random), bodies);
    ExpectMomentumConserved(bodies);
  }
}

TEST(Forces, OfMutualAttractionConserveMomentumOfManyBodies) {
  Random random(2);
  std::vector<Body> bodies = RandomBodies(40, &random);
  ApplyMutualAttraction({1.5, 0}, bodies);
  Vec2 force;
  double torque = 0;
  for (const Body& body : bodies) {
    force = force + body.force;
    torque += Cross(body.x, body.force);
    EXPECT_EQ(body.torque, 0);
  }
  EXPECT_NEAR(Norm(force), 0, 1e-9);
  EXPECT_NEAR(torque, 0, 1e-9);
}

TEST(Forces, WithAnEnergyDoWorkAtTheRateOfItsLoss) {
  Random random(3);
  for (int k = 0; k < kCases; ++k) {
    SCOPED_TRACE(k);
    std::vector<Body> bodies = RandomBodies(3, &random);
    bodies[2].fixed = true;
    const Vec2 g = random.Vector(10);
    std::vector<Body> loaded = bodies;
    ApplyGravity(g, loaded);
    EXPECT_EQ(loaded[2].force.x, 0);
    ExpectWorkIsLossOfEnergy(loaded, [&](const std::vector<Body>& b) { return GravityEnergy(g, b); });

    Spring spring = RandomSpring(&random);
    if (k % 2 == 0) spring.end2.body = 2;
    loaded = bodies;
    ApplySpring(spring, loaded);
    ExpectWorkIsLossOfEnergy(loaded, [&](const std::vector<Body>& b) { return SpringEnergy(spring, b); });

    const MutualAttraction attraction = RandomAttraction(&random);
    loaded = bodies;
    ApplyMutualAttraction(attraction, loaded);
    ExpectWorkIsLossOfEnergy(loaded, [&](const std::vector<Body>& b) { return MutualAttractionEnergy(attraction, b); });
  }
}

TEST(Forces, OfADamperTakePowerAndThatMuch) {
  Random random(4);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(2, &random);
    const Damper damper = RandomDamper(&random);
    ApplyDamper(damper, bodies);
    EXPECT_LE(DamperPower(damper, bodies), 0);
    EXPECT_LE(Power(bodies), 1e-12);
    EXPECT_NEAR(Power(bodies), DamperPower(damper, bodies), 1e-11 * (1 + std::abs(Power(bodies))));
  }
}

TEST(Forces, OfADamperVanishInRigidMotion) {
  Random random(5);
  std::vector<Body> bodies = RandomBodies(2, &random);
  const Vec2 v = random.Vector(3);
  const double omega = 1.7;
  for (Body& body : bodies) {
    body.v = v + omega * Perp(body.x);
    body.omega = omega;
  }
  ApplyDamper({{0, random.Vector(1)}, {1, random.Vector(1)}, 5}, bodies);
  for (const Body& body : bodies) EXPECT_NEAR(Norm(body.force) + std::abs(body.torque), 0, 1e-12);
}

TEST(Forces, OfAThrusterTurnWithTheBody) {
  Random random(6);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(1, &random);
    const Thruster thruster{{0, random.Vector(1)}, random.Vector(4)};
    ApplyThruster(thruster, bodies);
    const Body& body = bodies[0];
    EXPECT_NEAR(Norm(Rotate(SinCos(-body.theta), body.force) - thruster.force), 0, 1e-13);
    EXPECT_NEAR(body.torque, Cross(thruster.at.point, thruster.force), 1e-13);
  }
}

TEST(Forces, OfAWrenchActAtItsPoint) {
  Random random(7);
  for (int k = 0; k < kCases; ++k) {
    std::vector<Body> bodies = RandomBodies(1, &random);
    const Wrench wrench{{0, random.Vector(1)}, random.Vector(4), random.Uniform(-3, 3)};
    ApplyWrench(wrench, bodies);
    const Body& body = bodies[0];
    EXPECT_EQ(body.force.x, wrench.force.x);
    EXPECT_EQ(body.force.y, wrench.force.y);
    const Vec2 arm = ToWorld(body, wrench.at.point) - body.x;
    EXPECT_NEAR(body.torque, Cross(arm, wrench.force) + wrench.torque, 1e-13);
  }
}

TEST(Forces, AddUpAndAreCleared) {
  Random random(8);
  std::vector<Body> once = RandomBodies(2, &random);
  std::vector<Body> twice = once;
  const Spring spring{{0, {0.1, 0.2}}, {1, {}}, 3, 0.5};
  ApplySpring(spring, once);
  ApplySpring(spring, twice);
  ApplySpring(spring, twice);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(twice[k].force.x, 2 * once[k].force.x);
    EXPECT_EQ(twice[k].torque, 2 * once[k].torque);
  }
  ClearLoads(twice);
  for (const Body& body : twice) EXPECT_EQ(Norm(body.force) + std::abs(body.torque), 0);
}

TEST(Forces, OfASpringPullWhenLongAndPushWhenShort) {
  std::vector<Body> bodies(2);
  bodies[1].x = {3, 0};
  ApplySpring({{0, {}}, {1, {}}, 2, 1}, bodies);
  EXPECT_EQ(bodies[0].force.x, 4);
  EXPECT_EQ(bodies[1].force.x, -4);
  ClearLoads(bodies);
  ApplySpring({{0, {}}, {1, {}}, 2, 5}, bodies);
  EXPECT_EQ(bodies[0].force.x, -4);
}

TEST(Forces, WithoutADirectionOrWithBadNumbersAreRefused) {
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::vector<Body> bodies(2);
  bodies[0].name = "ball";
  // Both bodies at the origin: only the spring without rest length is defined there.
  EXPECT_NO_THROW(ApplySpring({{0, {}}, {1, {}}, 1, 0}, bodies));
  EXPECT_THROW(ApplySpring({{0, {}}, {1, {}}, 1, 0.5}, bodies), InputError);
  EXPECT_THROW(ApplyDamper({{0, {}}, {1, {}}, 1}, bodies), InputError);
  EXPECT_THROW(ApplyMutualAttraction({1, 0}, bodies), InputError);
  EXPECT_NO_THROW(ApplyMutualAttraction({1, 0.1}, bodies));
  bodies[1].x = {1, 0};
  EXPECT_THROW(ApplySpring({{0, {}}, {2, {}}, 1, 0}, bodies), InputError);
  EXPECT_THROW(ApplySpring({{-1, {}}, {1, {}}, 1, 0}, bodies), InputError);
  EXPECT_THROW(ApplySpring({{0, {}}, {1, {}}, -1, 0}, bodies), InputError);
  EXPECT_THROW(ApplySpring({{0, {}}, {1, {}}, 1, -1}, bodies), InputError);
  EXPECT_THROW(ApplySpring({{0, {kNaN, 0}}, {1, {}}, 1, 0}, bodies), InputError);
  EXPECT_THROW(ApplyDamper({{0, {}}, {1, {}}, kNaN}, bodies), InputError);
  EXPECT_THROW(ApplyThruster({{0, {}}, {kNaN, 0}}, bodies), InputError);
  EXPECT_THROW(ApplyWrench({{0, {}}, {}, kNaN}, bodies), InputError);
  EXPECT_THROW(ApplyGravity({0, kNaN}, bodies), InputError);
  EXPECT_THROW(ApplyMutualAttraction({kNaN, 0}, bodies), InputError);
  for (const Body& body : bodies) EXPECT_TRUE(IsFinite(body.force) && std::isfinite(body.torque));
}

}  // namespace
}  // namespace lcpbench::testing
