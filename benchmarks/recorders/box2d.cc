/// recorder-box2d: scenes of Box2D 2.4's testbed (folder testbed/tests of its source), built anew from the sizes,
/// masses and positions that the tests state, stepped by Box2D as the testbed does: 60 Hz, 8 and 3 iterations, gravity
/// 10 m/s².
///
/// Box2D detects contacts at the start of a step, then adds loads and solves. So a recorded step is a step of no
/// length, which detects and does nothing else, then the world is read, and then it goes on by a step of 1/60 s. Gaps
/// are Box2D's: polygons and edges have a skin of 0.01 m, in which it leaves an overlap of 0.005 m at rest.

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "benchmarks/recorders/recording.h"

namespace lcpbench::recorders {
namespace {

constexpr float kTimeStep = 1.0F / 60.0F;
constexpr int kVelocityIterations = 8;
constexpr int kPositionIterations = 3;
constexpr float kDegree = std::numbers::pi_v<float> / 180;

/// A world, and what its test does between steps.
struct Scene {
  b2World world{b2Vec2(0, -10)};
  b2Body* ground = nullptr;  ///< static, at the origin; it is there in every scene
  std::function<void()> before_step = [] {};

  Scene() { ground = AddStatic({0, 0}); }

  b2Body* Add(b2BodyDef definition, b2Vec2 position, float angle = 0) {
    definition.position = position;
    definition.angle = angle;
    return world.CreateBody(&definition);
  }
  b2Body* AddStatic(b2Vec2 position, float angle = 0) { return Add(b2BodyDef(), position, angle); }
  b2Body* AddDynamic(b2Vec2 position, float angle = 0) {
    b2BodyDef definition;
    definition.type = b2_dynamicBody;
    return Add(definition, position, angle);
  }

  b2Body* AddDynamic(b2Vec2 position, const std::function<void(b2BodyDef*)>& set_up) {
    b2BodyDef definition;
    definition.type = b2_dynamicBody;
    set_up(&definition);
    return Add(definition, position);
  }
  static b2RevoluteJointDef Hinge(b2Body* a, b2Body* b, b2Vec2 anchor) {
    b2RevoluteJointDef joint;
    joint.Initialize(a, b, anchor);
    return joint;
  }
  void AddMotor(b2Body* a, b2Body* b, b2Vec2 anchor, float speed, float most_torque) {
    b2RevoluteJointDef axle = Hinge(a, b, anchor);
    axle.motorSpeed = speed;
    axle.maxMotorTorque = most_torque;
    axle.enableMotor = true;
    world.CreateJoint(&axle);
  }
  void AddHinge(b2Body* a, b2Body* b, b2Vec2 anchor) {
    const b2RevoluteJointDef joint = Hinge(a, b, anchor);
    world.CreateJoint(&joint);
  }
};

struct Material {
  float density = 1;
  float friction = 0.2F;
  int16 group = 0;  ///< fixtures of one negative group do not touch
};

void Attach(b2Body* body, const b2Shape& shape, Material material = {}) {
  b2FixtureDef fixture;
  fixture.shape = &shape;
  fixture.density = material.density;
  fixture.friction = material.friction;
  fixture.filter.groupIndex = material.group;
  body->CreateFixture(&fixture);
}

/// By half of its width and height.
b2PolygonShape Box(float half_width, float half_height, b2Vec2 centre = {0, 0}, float angle = 0) {
  b2PolygonShape shape;
  shape.SetAsBox(half_width, half_height, centre, angle);
  return shape;
}

b2PolygonShape Polygon(std::initializer_list<b2Vec2> corners) {
  b2PolygonShape shape;
  shape.Set(corners.begin(), static_cast<int32>(corners.size()));
  return shape;
}

b2CircleShape Disc(float radius, b2Vec2 centre = {0, 0}) {
  b2CircleShape shape;
  shape.m_radius = radius;
  shape.m_p = centre;
  return shape;
}

b2EdgeShape Edge(b2Vec2 from, b2Vec2 to) {
  b2EdgeShape shape;
  shape.SetTwoSided(from, to);
  return shape;
}

float F(double number) { return static_cast<float>(number); }

void AddFloor(Scene& scene) { Attach(scene.ground, Edge({-40, 0}, {40, 0})); }

// --- Stacks

void AddPyramid(Scene& scene, int count) {
  for (int row = 0; row < count; ++row) {
    for (int i = 0; i < count - row; ++i) {
      b2Body* const box = scene.AddDynamic({-7 + 0.5625F * F(row) + 1.125F * F(i), 0.75F + 1.25F * F(row)});
      Attach(box, Box(0.5F, 0.5F), {.density = 5});
    }
  }
}

void Pyramid(Scene& scene) {
  AddFloor(scene);
  AddPyramid(scene, 20);
}

void Tiles(Scene& scene) {
  b2Body* const tiles = scene.AddStatic({0, -0.5F});
  for (int row = 0; row < 10; ++row) {
    for (int i = 0; i < 200; ++i) Attach(tiles, Box(0.5F, 0.5F, {-100 + F(i), -F(row)}));
  }
  AddPyramid(scene, 20);
}

void BoxStack(Scene& scene) {
  AddFloor(scene);
  Attach(scene.ground, Edge({20, 0}, {20, 20}));
  for (int i = 0; i < 15; ++i) {
    Attach(scene.AddDynamic({0, 0.55F + 1.1F * F(i)}), Box(0.5F, 0.5F), {.density = 1, .friction = 0.3F});
  }
}

void CircleStack(Scene& scene) {
  AddFloor(scene);
  for (int i = 0; i < 10; ++i) {
    b2Body* const disc = scene.AddDynamic({0, 4 + 3 * F(i)});
    Attach(disc, Disc(1));
    disc->SetLinearVelocity({0, -50});
  }
}

void CompoundShapes(Scene& scene) {
  Attach(scene.ground, Edge({50, 0}, {-50, 0}));
  const Material material{.density = 2};
  std::vector<b2Body*> bodies;
  for (const auto& [x, half_leg] : {std::pair{-15.0F, 1.5F}, std::pair{-5.0F, 2.0F}}) {
    b2Body* const table = bodies.emplace_back(scene.AddDynamic({x, 1}));
    Attach(table, Box(3, 0.5F, {0, 3.5F}), material);
    for (const float side : {-2.5F, 2.5F}) Attach(table, Box(0.5F, half_leg, {side, half_leg}), material);
  }
  for (const auto& [x, inner] : {std::pair{5.0F, b2Vec2(0, 4.0F / 3)}, std::pair{15.0F, b2Vec2(1, 2)}}) {
    b2Body* const ship = bodies.emplace_back(scene.AddDynamic({x, 1}));
    for (const float side : {-1.0F, 1.0F}) {
      Attach(ship, Polygon({{2 * side, 0}, {-inner.x * side, inner.y}, {0, 4}}), material);
    }
  }
  // What the test's button adds: obstructions inside of tables and ships.
  for (std::size_t i = 0; i < 4; ++i) {
    b2Body* const obstruction =
        scene.AddDynamic(bodies[i]->GetPosition(), [i](b2BodyDef* of) { of->gravityScale = i < 2 ? 1.0F : 0.0F; });
    if (i < 2) {
      Attach(obstruction, Box(4, 0.1F, {0, 3}), material);
    } else {
      Attach(obstruction, Disc(0.5F, {0, 2}), material);
    }
  }
}

// --- Piles and slopes

void Tumbler(Scene& scene) {
  b2Body* const drum = scene.AddDynamic({0, 10});
  for (const float side : {10.0F, -10.0F}) {
    Attach(drum, Box(0.5F, 10, {side, 0}), {.density = 5});
    Attach(drum, Box(10, 0.5F, {0, side}), {.density = 5});
  }
  scene.AddMotor(scene.ground, drum, {0, 10}, 0.05F * std::numbers::pi_v<float>, 1e8F);
  scene.before_step = [&scene, count = 0]() mutable {
    if (count++ < 800) Attach(scene.AddDynamic({0, 10}), Box(0.125F, 0.125F));
  };
}

void AddPair(Scene& scene) {
  scene.world.SetGravity({0, 0});
  Uniform uniform;
  for (int i = 0; i < 400; ++i) {
    const double x = uniform(-6, 0);
    Attach(scene.AddDynamic({F(x), F(uniform(4, 6))}), Disc(0.1F), {.density = 0.01F});
  }
  const auto fast = [](b2BodyDef* of) {
    of->bullet = true;
    of->linearVelocity = {10, 0};
  };
  Attach(scene.AddDynamic({-40, 5}, fast), Box(1.5F, 1.5F));
}

void Confined(Scene& scene) {
  for (const auto& [from, to] : {std::pair{b2Vec2(-10, 0), b2Vec2(10, 0)},
                                 {b2Vec2(-10, 0), b2Vec2(-10, 20)},
                                 {b2Vec2(10, 0), b2Vec2(10, 20)},
                                 {b2Vec2(-10, 20), b2Vec2(10, 20)}}) {
    Attach(scene.ground, Edge(from, to));
  }
  constexpr float kRadius = 0.5F;
  for (int column = 0; column < 9; ++column) {
    for (int row = 0; row < 16; ++row) {
      const float x = -10 + (2.1F * F(column) + 1 + 0.01F * F(row)) * kRadius;
      Attach(scene.AddDynamic({x, (2 * F(row) + 1) * kRadius}), Disc(kRadius), {.density = 1, .friction = 0.1F});
    }
  }
  Uniform uniform;
  for (int i = 0; i < 4; ++i) {
    const double x = 3 + uniform(-1, 1);
    Attach(scene.AddDynamic({F(x), F(3 + 4 * i + uniform(-1, 1))}), Disc(2), {.density = 1, .friction = 0});
  }
}

void Friction(Scene& scene) {
  AddFloor(scene);
  for (const auto& [x, y, angle] : {std::tuple{-4.0F, 22.0F, -0.25F}, {4.0F, 14.0F, 0.25F}, {-4.0F, 6.0F, -0.25F}}) {
    Attach(scene.AddStatic({x, y}, angle), Box(13, 0.25F));
  }
  Attach(scene.AddStatic({10.5F, 19}), Box(0.25F, 1));
  Attach(scene.AddStatic({-10.5F, 11}), Box(0.25F, 1));
  float x = -15;
  for (const float friction : {0.75F, 0.5F, 0.35F, 0.1F, 0.0F}) {
    Attach(scene.AddDynamic({x, 28}), Box(0.5F, 0.5F), {.density = 25, .friction = friction});
    x += 4;
  }
}

/// Contacts with the platform are driven.
class Belt : public b2ContactListener {
 public:
  explicit Belt(const b2Body* platform) : platform_(platform) {}
  void PreSolve(b2Contact* contact, const b2Manifold* /*before*/) override {
    if (contact->GetFixtureA()->GetBody() == platform_) contact->SetTangentSpeed(5);
    if (contact->GetFixtureB()->GetBody() == platform_) contact->SetTangentSpeed(-5);
  }

 private:
  const b2Body* platform_;
};

void ConveyorBelt(Scene& scene) {
  Attach(scene.ground, Edge({-20, 0}, {20, 0}));
  b2Body* const platform = scene.AddStatic({-5, 5});
  Attach(platform, Box(10, 0.5F), {.density = 0, .friction = 0.8F});
  for (int i = 0; i < 5; ++i) Attach(scene.AddDynamic({-10 + 2 * F(i), 7}), Box(0.5F, 0.5F), {.density = 20});
  static Belt belt(platform);
  scene.world.SetContactListener(&belt);
}

// --- Joints

/// Links side by side along x, each joined to the one before; `first` to the first one.
/// @return the last one
b2Body* AddLinks(Scene& scene, b2Body* first, b2Vec2 begin, int count, float half_width, float spacing) {
  b2Body* previous = first;
  for (int i = 0; i < count; ++i) {
    b2Body* const link = scene.AddDynamic({begin.x + spacing * (F(i) + 0.5F), begin.y});
    Attach(link, Box(half_width, 0.125F), {.density = 20, .friction = 0.2F});
    scene.AddHinge(previous, link, {begin.x + spacing * F(i), begin.y});
    previous = link;
  }
  return previous;
}

/// Things that fall on bridges and cantilevers.
void AddLoad(Scene& scene, int triangles, int discs) {
  for (int i = 0; i < triangles; ++i) {
    Attach(scene.AddDynamic({-8 + 8 * F(i), 12}), Polygon({{-0.5F, 0}, {0.5F, 0}, {0, 1.5F}}));
  }
  for (int i = 0; i < discs; ++i) Attach(scene.AddDynamic({-6 + 6 * F(i), 10}), Disc(0.5F));
}

void Bridge(Scene& scene) {
  AddFloor(scene);
  b2Body* const last = AddLinks(scene, scene.ground, {-15, 5}, 30, 0.5F, 1);
  scene.AddHinge(last, scene.ground, {15, 5});
  AddLoad(scene, 2, 3);
}

void Chain(Scene& scene) {
  AddFloor(scene);
  AddLinks(scene, scene.ground, {0, 25}, 30, 0.6F, 1);
}

/// Beams of welded links; some of the welds turn as springs.
void Cantilever(Scene& scene) {
  AddFloor(scene);
  struct Beam {
    b2Vec2 begin;
    int count;
    float half_width;
    float frequency;  ///< of the springs [Hz], 0: rigid
    bool is_held;
  };
  for (const Beam& beam : {Beam{{-15, 5}, 8, 0.5F, 0, true}, Beam{{-15, 15}, 3, 1, 5, true},
                           Beam{{-5, 5}, 8, 0.5F, 0, false}, Beam{{5, 10}, 8, 0.5F, 8, false}}) {
    b2Body* previous = beam.is_held ? scene.ground : nullptr;
    for (int i = 0; i < beam.count; ++i) {
      b2Body* const link = scene.AddDynamic({beam.begin.x + 2 * beam.half_width * (F(i) + 0.5F), beam.begin.y});
      Attach(link, Box(beam.half_width, 0.125F), {.density = 20});
      if (previous != nullptr) {
        b2WeldJointDef weld;
        weld.Initialize(previous, link, {beam.begin.x + 2 * beam.half_width * F(i), beam.begin.y});
        if (beam.frequency > 0) b2AngularStiffness(weld.stiffness, weld.damping, beam.frequency, 0.7F, previous, link);
        scene.world.CreateJoint(&weld);
      }
      previous = link;
    }
  }
  AddLoad(scene, 2, 2);
}

void WreckingBall(Scene& scene) {
  AddFloor(scene);
  b2Body* const last = AddLinks(scene, scene.ground, {0, 15}, 9, 0.5F, 1);
  b2Body* const ball = scene.AddDynamic({9, 15}, [](b2BodyDef* of) { of->angularDamping = 0.4F; });
  b2FixtureDef fixture;
  const b2CircleShape disc = Disc(1.5F);
  fixture.shape = &disc;
  fixture.density = 100;
  fixture.filter.categoryBits = 2;
  ball->CreateFixture(&fixture);
  for (b2Body* body = scene.world.GetBodyList(); body != nullptr; body = body->GetNext()) {
    if (body == ball || body->GetType() != b2_dynamicBody) continue;
    b2Filter filter;
    filter.maskBits = 0xFFFF & ~2;
    body->GetFixtureList()->SetFilterData(filter);
  }
  scene.AddHinge(last, ball, {9, 15});
  b2DistanceJointDef rope;
  rope.bodyA = scene.ground;
  rope.bodyB = ball;
  rope.localAnchorA = {0, 15};
  rope.minLength = 0;
  rope.maxLength = 9.01F;
  scene.world.CreateJoint(&rope);
}

void SliderCrank(Scene& scene) {
  AddFloor(scene);
  b2Body* const crank = scene.AddDynamic({0, 7});
  Attach(crank, Box(0.5F, 2), {.density = 2});
  scene.AddMotor(scene.ground, crank, {0, 5}, std::numbers::pi_v<float>, 10000);
  b2Body* const follower = scene.AddDynamic({0, 13});
  Attach(follower, Box(0.5F, 4), {.density = 2});
  scene.AddHinge(crank, follower, {0, 9});
  b2Body* const piston = scene.AddDynamic({0, 17}, [](b2BodyDef* of) { of->fixedRotation = true; });
  Attach(piston, Box(1.5F, 1.5F), {.density = 2});
  scene.AddHinge(follower, piston, {0, 17});
  b2PrismaticJointDef guide;
  guide.Initialize(scene.ground, piston, {0, 17}, {0, 1});
  guide.maxMotorForce = 1000;
  guide.enableMotor = true;
  scene.world.CreateJoint(&guide);
  Attach(scene.AddDynamic({0, 23}), Box(1.5F, 1.5F), {.density = 2});
}

void Dominos(Scene& scene) {
  AddFloor(scene);
  Attach(scene.AddStatic({-1.5F, 10}), Box(6, 0.25F));
  for (int i = 0; i < 10; ++i) {
    Attach(scene.AddDynamic({-6 + F(i), 11.25F}), Box(0.1F, 1), {.density = 20, .friction = 0.1F});
  }
  Attach(scene.AddStatic({1, 6}), Box(7, 0.25F, {0, 0}, 0.3F));
  b2Body* const post = scene.AddStatic({-7, 4});
  Attach(post, Box(0.25F, 1.5F));

  b2Body* const seesaw = scene.AddDynamic({-0.9F, 1}, -0.15F);
  Attach(seesaw, Box(6, 0.125F), {.density = 10});
  b2RevoluteJointDef pivot = scene.Hinge(scene.ground, seesaw, {-2, 1});
  pivot.collideConnected = true;
  scene.world.CreateJoint(&pivot);

  b2Body* const hammer = scene.AddDynamic({-10, 15});
  Attach(hammer, Box(0.25F, 0.25F), {.density = 10});
  scene.AddHinge(post, hammer, {-7, 15});

  b2Body* const bin = scene.AddDynamic({6.5F, 3});
  const Material slippery{.density = 10, .friction = 0.1F};
  Attach(bin, Box(1, 0.1F, {0, -0.9F}), slippery);
  for (const float side : {-0.9F, 0.9F}) Attach(bin, Box(0.1F, 1, {side, 0}), slippery);
  scene.AddHinge(scene.ground, bin, {6, 2});
  b2Body* const lid = scene.AddDynamic({6.5F, 4.1F});
  Attach(lid, Box(1, 0.1F), {.density = 30});
  scene.AddHinge(bin, lid, {7.5F, 4});

  b2Body* const arm = scene.AddDynamic({7.4F, 1});
  Attach(arm, Box(0.1F, 1), {.density = 10});
  b2DistanceJointDef spring;
  spring.bodyA = seesaw;
  spring.bodyB = arm;
  spring.localAnchorA = {6, 0};
  spring.localAnchorB = {0, -1};
  spring.length = b2Distance(arm->GetWorldPoint(spring.localAnchorB), seesaw->GetWorldPoint(spring.localAnchorA));
  b2LinearStiffness(spring.stiffness, spring.damping, 1, 1, seesaw, arm);
  scene.world.CreateJoint(&spring);
  for (int i = 0; i < 4; ++i) Attach(scene.AddDynamic({5.9F + 0.4F * F(i), 2.4F}), Disc(0.2F), {.density = 10});
}

/// One of the walker's legs, left (side -1) or right: two triangles, four rods and a hinge.
void AddLeg(Scene& scene, b2Body* chassis, b2Body* wheel, b2Vec2 offset, b2Vec2 crank, float side) {
  const auto at = [&](float x, float y) { return b2Vec2(x * side, y); };
  const b2Vec2 foot = at(5.4F, -6.1F), knee = at(7.2F, -1.2F), shin = at(4.3F, -1.9F);
  const b2Vec2 hip = at(3.1F, 0.8F), thigh = at(6, 1.5F), top = at(2.5F, 3.7F);
  const auto damped = [](b2BodyDef* of) { of->angularDamping = 10; };
  b2Body* const lower = scene.AddDynamic(offset, damped);
  b2Body* const upper = scene.AddDynamic(hip + offset, damped);
  Attach(lower, Polygon({foot, knee, shin}), {.group = -1});
  Attach(upper, Polygon({{0, 0}, thigh - hip, top - hip}), {.group = -1});
  const auto add_rod = [&](b2Body* a, b2Body* b, b2Vec2 end_a, b2Vec2 end_b) {
    b2DistanceJointDef rod;
    rod.Initialize(a, b, end_a + offset, end_b + offset);
    b2LinearStiffness(rod.stiffness, rod.damping, 10, 0.5F, a, b);
    scene.world.CreateJoint(&rod);
  };
  add_rod(lower, upper, knee, thigh);
  add_rod(lower, upper, shin, hip);
  add_rod(lower, wheel, shin, crank);
  add_rod(upper, wheel, top, crank);
  scene.AddHinge(upper, chassis, hip + offset);
}

void TheoJansen(Scene& scene) {
  Attach(scene.ground, Edge({-50, 0}, {50, 0}));
  for (const float side : {-50.0F, 50.0F}) Attach(scene.ground, Edge({side, 0}, {side, 10}));
  for (int i = 0; i < 40; ++i) Attach(scene.AddDynamic({-40 + 2 * F(i), 0.5F}), Disc(0.25F));
  const b2Vec2 offset(0, 8), pivot(0, 0.8F);
  b2Body* const chassis = scene.AddDynamic(pivot + offset);
  Attach(chassis, Box(2.5F, 1), {.group = -1});
  b2Body* const wheel = scene.AddDynamic(pivot + offset);
  Attach(wheel, Disc(1.6F), {.group = -1});
  scene.AddMotor(wheel, chassis, pivot + offset, 2, 400);
  for (const float angle : {0.0F, 120.0F, -120.0F}) {
    wheel->SetTransform(wheel->GetPosition(), angle * kDegree);
    for (const float side : {-1.0F, 1.0F}) AddLeg(scene, chassis, wheel, offset, pivot + b2Vec2(0, -0.8F), side);
  }
}

void Car(Scene& scene) {
  const auto add_ground = [&](b2Vec2 from, b2Vec2 to) {
    Attach(scene.ground, Edge(from, to), {.density = 0, .friction = 0.6F});
  };
  add_ground({-20, 0}, {20, 0});
  b2Vec2 end(20, 0);
  for (int round = 0; round < 2; ++round) {
    for (const float height : {0.25F, 1.0F, 4.0F, 0.0F, 0.0F, -1.0F, -2.0F, -2.0F, -1.25F, 0.0F}) {
      const b2Vec2 next(end.x + 5, height);
      add_ground(end, next);
      end = next;
    }
  }
  add_ground({120, 0}, {160, 0});
  add_ground({200, 0}, {240, 0});
  add_ground({240, 0}, {250, 5});
  add_ground({260, 0}, {300, 0});
  add_ground({300, 0}, {300, 20});

  b2Body* const teeter = scene.AddDynamic({140, 1});
  Attach(teeter, Box(10, 0.25F));
  b2RevoluteJointDef pivot = scene.Hinge(scene.ground, teeter, {140, 1});
  pivot.lowerAngle = -8 * kDegree;
  pivot.upperAngle = 8 * kDegree;
  pivot.enableLimit = true;
  scene.world.CreateJoint(&pivot);
  teeter->ApplyAngularImpulse(100, true);

  b2Body* previous = scene.ground;
  for (int i = 0; i < 20; ++i) {
    b2Body* const plank = scene.AddDynamic({161 + 2 * F(i), -0.125F});
    Attach(plank, Box(1, 0.125F), {.density = 1, .friction = 0.6F});
    scene.AddHinge(previous, plank, {160 + 2 * F(i), -0.125F});
    previous = plank;
  }
  scene.AddHinge(previous, scene.ground, {200, -0.125F});
  for (int i = 0; i < 5; ++i) Attach(scene.AddDynamic({230, 0.5F + F(i)}), Box(0.5F, 0.5F), {.density = 0.5F});

  b2Body* const car = scene.AddDynamic({0, 1});
  Attach(car, Polygon({{-1.5F, -0.5F}, {1.5F, -0.5F}, {1.5F, 0}, {0, 0.9F}, {-1.15F, 0.9F}, {-1.5F, 0.2F}}));
  for (const bool is_driven : {true, false}) {
    b2Body* const wheel = scene.AddDynamic({is_driven ? -1.0F : 1.0F, is_driven ? 0.35F : 0.4F});
    Attach(wheel, Disc(0.4F), {.density = 1, .friction = 0.9F});
    b2WheelJointDef suspension;
    suspension.Initialize(car, wheel, wheel->GetPosition(), {0, 1});
    const float frequency = 2 * std::numbers::pi_v<float> * 4;
    suspension.stiffness = wheel->GetMass() * frequency * frequency;
    suspension.damping = 2 * wheel->GetMass() * 0.7F * frequency;
    suspension.lowerTranslation = -0.25F;
    suspension.upperTranslation = 0.25F;
    suspension.enableLimit = true;
    suspension.motorSpeed = -50;  // as long as the key D is held
    suspension.maxMotorTorque = is_driven ? 20.0F : 10.0F;
    suspension.enableMotor = is_driven;
    scene.world.CreateJoint(&suspension);
  }
}

constexpr SceneEntry<Scene> kScenes[] = {
    {"pyramid", "pyramid.cpp", "", Pyramid},
    {"tiles", "tiles.cpp", "", Tiles},
    {"box-stack", "box_stack.cpp", "", BoxStack},
    {"circle-stack", "circle_stack.cpp", "", CircleStack},
    {"compound-shapes", "compound_shapes.cpp", "the obstructions are there from the start", CompoundShapes},
    {"tumbler", "tumbler.cpp", "", Tumbler},
    {"add-pair", "add_pair.cpp", "random positions of our own", AddPair},
    {"confined", "confined.cpp",
     "9 columns of 16 discs (the test's constants are 0) and 4 of the discs that a key adds; with gravity", Confined},
    {"friction", "friction.cpp", "", Friction},
    {"conveyor-belt", "conveyor_belt.cpp", "", ConveyorBelt},
    {"bridge", "bridge.cpp", "", Bridge},
    {"chain", "chain.cpp", "", Chain},
    {"cantilever", "cantilever.cpp", "", Cantilever},
    {"wrecking-ball", "wrecking_ball.cpp", "", WreckingBall},
    {"slider-crank", "slider_crank_2.cpp", "", SliderCrank},
    {"dominos", "dominos.cpp", "", Dominos},
    {"theo-jansen", "theo_jansen.cpp", "", TheoJansen},
    {"car", "car.cpp", "driven from the start on", Car},
};

// --- Reading the world

/// In double precision, as the arithmetic of rows is ours.
struct Vector {
  double x = 0, y = 0;
};
Vector From(b2Vec2 v) { return {v.x, v.y}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
double Dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
double Cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }

class Stage : public Scene {
 public:
  Stage() { world.SetAllowSleeping(false); }

  void Advance(int number, Step* step) {
    before_step();
    if (step != nullptr) {
      world.Step(0, kVelocityIterations, kPositionIterations);
      if (bodies_.empty()) NumberBodies();
      if (world.GetBodyCount() != body_count_) {
        std::fprintf(stderr, "recorder-box2d: bodies are still added at step %d; expected a later --first\n", number);
        std::exit(2);
      }
      Write(step);
    }
    world.Step(kTimeStep, kVelocityIterations, kPositionIterations);
  }

  Json Gravity() const { return Numbers({world.GetGravity().x, world.GetGravity().y}); }
  static double TimeStep() { return kTimeStep; }
  Json Bodies() const {
    Json list = Json::array();
    for (const b2Body* body : bodies_) {
      const double mass = body->GetType() == b2_dynamicBody ? body->GetMass() : 0;
      const Vector lever = From(body->GetLocalCenter());  // Box2D's inertia is about the body's origin
      const double inertia = body->IsFixedRotation() ? 0 : body->GetInertia() - mass * Dot(lever, lever);
      list.push_back(BodyOf(mass > 0 ? 1 / mass : 0, Rounded(inertia > 0 ? 1 / inertia : 0)));
    }
    return list;
  }

 private:
  /// The items of one of Box2D's lists in the order in which they were made.
  template <class Item>
  static std::vector<Item*> InOrder(Item* first) {
    std::vector<Item*> list;
    for (Item* item = first; item != nullptr; item = item->GetNext()) list.push_back(item);
    std::reverse(list.begin(), list.end());
    return list;
  }

  void NumberBodies() {
    body_count_ = world.GetBodyCount();
    for (b2Body* body : InOrder(world.GetBodyList())) {
      for (const b2Fixture* fixture : InOrder(body->GetFixtureList())) {
        fixtures_.emplace(fixture, static_cast<int>(fixtures_.size()));
      }
      if (body->GetType() == b2_staticBody) continue;
      indices_[body] = static_cast<int>(bodies_.size());
      bodies_.push_back(body);
    }
    joints_ = InOrder(world.GetJointList());
  }

  void Write(Step* step) const {
    const b2Vec2 gravity = world.GetGravity();
    for (const b2Body* body : bodies_) {
      const b2Vec2 x = body->GetWorldCenter();
      const b2Vec2 v = body->GetLinearVelocity();
      const double weight = body->GetType() == b2_dynamicBody ? body->GetMass() * body->GetGravityScale() : 0;
      step->Body(Numbers({x.x, x.y}), Rounded(body->GetAngle()), Numbers({v.x, v.y}),
                 Rounded(body->GetAngularVelocity()), Numbers({weight * gravity.x, weight * gravity.y}), 0);
    }
    for (const b2Contact* contact = world.GetContactList(); contact != nullptr; contact = contact->GetNext()) {
      AddContact(*step, *contact);
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) AddJoint(*step, *joints_[k], k);
  }

  void AddContact(Step& step, const b2Contact& contact) const {
    if (!contact.IsTouching() || !contact.IsEnabled()) return;
    const b2Fixture* const a = contact.GetFixtureA();
    const b2Fixture* const b = contact.GetFixtureB();
    if (a->IsSensor() || b->IsSensor()) return;
    b2WorldManifold manifold;
    contact.GetWorldManifold(&manifold);
    const auto name = [](const b2Fixture* fixture) {
      static constexpr const char* kNames[] = {"circle", "edge", "polygon", "chain"};
      return std::string(kNames[fixture->GetType()]);
    };
    const auto radius = [](const b2Fixture* fixture) {
      return fixture->GetType() == b2Shape::e_circle ? static_cast<double>(fixture->GetShape()->m_radius) : 0.0;
    };
    for (int k = 0; k < contact.GetManifold()->pointCount; ++k) {
      char id[64];
      std::snprintf(id, sizeof id, "%d-%d:%x", fixtures_.at(a), fixtures_.at(b),
                    contact.GetManifold()->points[k].id.key);
      step.Contact(IndexOf(indices_, a->GetBody()), IndexOf(indices_, b->GetBody()),
                   Numbers({manifold.points[k].x, manifold.points[k].y}),
                   Numbers({manifold.normal.x, manifold.normal.y}), manifold.separations[k], contact.GetFriction(), id,
                   {name(a), name(b)}, {radius(a), radius(b)});
    }
  }

  /// One joint's rows. The levers a and b are of the two anchors about the centres of mass, d is from anchor to anchor.
  class Rows {
   public:
    explicit Rows(b2Joint& joint)
        : lever_a_(From(joint.GetAnchorA()) - From(joint.GetBodyA()->GetWorldCenter())),
          lever_b_(From(joint.GetAnchorB()) - From(joint.GetBodyB()->GetWorldCenter())),
          d_(From(joint.GetAnchorB()) - From(joint.GetAnchorA())) {}

    Vector d() const { return d_; }
    const std::vector<JointRow>& rows() const { return rows_; }

    void AddPoint() {
      Add({1, 0}, lever_a_, d_.x);
      Add({0, 1}, lever_a_, d_.y);
    }
    /// Along a direction that turns with a, or that of d: a's lever there reaches to b's anchor.
    void AddAlong(Vector axis, double error, double sign = 1, bool is_limit = false) {
      Add({sign * axis.x, sign * axis.y}, {lever_a_.x + d_.x, lever_a_.y + d_.y}, error, is_limit);
    }
    void AddAngle(double error, double sign = 1, bool is_limit = false) {
      rows_.push_back({{0, 0, -sign, 0, 0, sign}, error, is_limit});
    }
    /// The stops of a coordinate, those that are reached.
    template <class AddStop>
    static void AddStops(double coordinate, double lower, double upper, double slop, const AddStop& add) {
      if (coordinate - lower <= slop) add(coordinate - lower, 1.0);
      if (upper - coordinate <= slop) add(upper - coordinate, -1.0);
    }

   private:
    void Add(Vector n, Vector lever_a, double error, bool is_limit = false) {
      rows_.push_back({{-n.x, -n.y, -Cross(lever_a, n), n.x, n.y, Cross(lever_b_, n)}, error, is_limit});
    }
    Vector lever_a_, lever_b_, d_;
    std::vector<JointRow> rows_;
  };

  void AddJoint(Step& step, b2Joint& joint, std::size_t number) const {
    const b2Body* const a = joint.GetBodyA();
    const b2Body* const b = joint.GetBodyB();
    const double angle = static_cast<double>(b->GetAngle()) - a->GetAngle();
    Rows rows(joint);
    std::string kind;
    const auto add_slider = [&](const auto& slider) {
      const Vector axis = From(a->GetWorldVector(slider.GetLocalAxisA()));
      rows.AddAlong({-axis.y, axis.x}, Dot(rows.d(), {-axis.y, axis.x}));
    };
    const auto add_ends = [&](const auto& slider) {
      if (!slider.IsLimitEnabled()) return;
      const Vector axis = From(a->GetWorldVector(slider.GetLocalAxisA()));
      Rows::AddStops(slider.GetJointTranslation(), slider.GetLowerLimit(), slider.GetUpperLimit(), b2_linearSlop,
                     [&](double error, double sign) { rows.AddAlong(axis, error, sign, true); });
    };
    switch (joint.GetType()) {
      case e_revoluteJoint: {
        const auto& hinge = static_cast<const b2RevoluteJoint&>(joint);
        kind = "revolute";
        rows.AddPoint();
        if (hinge.IsLimitEnabled()) {
          Rows::AddStops(hinge.GetJointAngle(), hinge.GetLowerLimit(), hinge.GetUpperLimit(), b2_angularSlop,
                         [&](double error, double sign) { rows.AddAngle(error, sign, true); });
        }
        break;
      }
      case e_weldJoint: {
        const auto& weld = static_cast<const b2WeldJoint&>(joint);
        kind = "weld";
        rows.AddPoint();
        if (weld.GetStiffness() == 0) rows.AddAngle(angle - weld.GetReferenceAngle());
        break;
      }
      case e_prismaticJoint: {
        const auto& guide = static_cast<const b2PrismaticJoint&>(joint);
        kind = "prismatic";
        add_slider(guide);
        rows.AddAngle(angle - guide.GetReferenceAngle());
        add_ends(guide);
        break;
      }
      case e_wheelJoint:
        kind = "wheel";
        add_slider(static_cast<const b2WheelJoint&>(joint));
        add_ends(static_cast<const b2WheelJoint&>(joint));
        break;
      case e_distanceJoint: {
        const auto& rod = static_cast<const b2DistanceJoint&>(joint);
        kind = "distance";
        const Vector d = rows.d();
        const double length = std::hypot(d.x, d.y);
        const Vector along{d.x / length, d.y / length};
        if (rod.GetMinLength() == rod.GetMaxLength()) {
          rows.AddAlong(along, length - rod.GetLength());
        } else {
          kind = "rope";
          Rows::AddStops(length, rod.GetMinLength(), rod.GetMaxLength(), b2_linearSlop,
                         [&](double error, double sign) { rows.AddAlong(along, error, sign, true); });
        }
        break;
      }
      default:
        std::fprintf(stderr, "recorder-box2d: a joint of an unknown kind\n");
        std::exit(1);
    }
    step.Joint(IndexOf(indices_, a), IndexOf(indices_, b), kind, number, rows.rows());
  }

  int body_count_ = 0;
  std::vector<const b2Body*> bodies_;
  std::vector<b2Joint*> joints_;  // Box2D shows joints that may change only
  std::unordered_map<const b2Body*, int> indices_;
  std::unordered_map<const b2Fixture*, int> fixtures_;
};

const Engine kEngine = {.name = "box2d",
                        .version = "2.4.1",  // it says 2.4.0 of itself, which had no limits of distance joints
                        .licence = "MIT",
                        .folder = "testbed/tests/",
                        .rebuilt = " of Debian's source package box2d 2.4.1-3, rebuilt",
                        .left_out = "friction, restitution, motors, springs, damping; sleeping is off",
                        .dimension = 2};

}  // namespace
}  // namespace lcpbench::recorders

int main(int argc, char** argv) {
  using namespace lcpbench::recorders;
  return RunRecorder<Stage>(argc, argv, kEngine, kScenes);
}
