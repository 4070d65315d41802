/// recorder-chipmunk: demos of Chipmunk 7 (folder demo of its source), built anew from the sizes, masses and positions
/// that the demos state, stepped by Chipmunk with the demo's step, iterations and slop.
///
/// Chipmunk integrates positions first, then detects contacts, then adds loads and solves. So a step is recorded from
/// inside, where the first body's velocity is about to be integrated: positions, contacts and joints are those that the
/// solver meets, velocities are those before the step.
/// Lengths are Chipmunk's own unit (a pixel of its demos) and stay so.

#include <chipmunk/chipmunk.h>
#include <chipmunk/chipmunk_structs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "benchmarks/recorders/recording.h"

namespace lcpbench::recorders {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What shapes do not touch each other: those of one group, and those without a common bit.
const cpShapeFilter kOneGroup = cpShapeFilterNew(1, CP_ALL_CATEGORIES, CP_ALL_CATEGORIES);

struct Surface {
  double friction = 0;
  double elasticity = 0;
  cpShapeFilter filter = CP_SHAPE_FILTER_ALL;
};

/// A space, and what its demo does between steps. It lives as long as the program.
struct Scene {
  cpSpace* space = cpSpaceNew();
  cpBody* ground = cpSpaceGetStaticBody(space);
  double time_step = 1.0 / 60;
  std::function<void()> before_step = [] {};

  cpBody* Add(double mass, double moment, cpVect position) {
    cpBody* const body = cpSpaceAddBody(space, cpBodyNew(mass, moment));
    cpBodySetPosition(body, position);
    return body;
  }
  cpShape* Attach(cpShape* shape, Surface surface = {}) {
    cpShapeSetFriction(shape, surface.friction);
    cpShapeSetElasticity(shape, surface.elasticity);
    cpShapeSetFilter(shape, surface.filter);
    return cpSpaceAddShape(space, shape);
  }
  void Join(cpConstraint* joint) { cpSpaceAddConstraint(space, joint); }

  cpBody* AddBox(cpVect position, double mass, double width, double height, double radius, Surface surface) {
    cpBody* const body = Add(mass, cpMomentForBox(mass, width, height), position);
    Attach(cpBoxShapeNew(body, width, height, radius), surface);
    return body;
  }
  cpBody* AddDisc(cpVect position, double mass, double radius, Surface surface) {
    cpBody* const body = Add(mass, cpMomentForCircle(mass, 0, radius, cpvzero), position);
    Attach(cpCircleShapeNew(body, radius, cpvzero), surface);
    return body;
  }
  /// A segment from (0, half_length) to (0, -half_length), whose ends and sides have a radius.
  cpBody* AddBar(cpVect position, double mass, double moment, double half_length, double radius, Surface surface) {
    cpBody* const body = Add(mass, moment, position);
    Attach(cpSegmentShapeNew(body, cpv(0, half_length), cpv(0, -half_length), radius), surface);
    return body;
  }
  void AddWall(cpVect from, cpVect to, Surface surface = {.friction = 1, .elasticity = 1}) {
    Attach(cpSegmentShapeNew(ground, from, to, 0), surface);
  }
  void AddFrame(bool has_roof) {
    AddWall(cpv(-320, -240), cpv(-320, 240));
    AddWall(cpv(320, -240), cpv(320, 240));
    AddWall(cpv(-320, -240), cpv(320, -240));
    if (has_roof) AddWall(cpv(-320, 240), cpv(320, 240));
  }
  void Set(int iterations, double gravity, double slop = 0.1) {
    cpSpaceSetIterations(space, iterations);
    cpSpaceSetGravity(space, cpv(0, -gravity));
    cpSpaceSetCollisionSlop(space, slop);
  }
};

// --- Stacks

void PyramidStack(Scene& scene) {
  scene.time_step = 1.0 / 180;
  scene.Set(30, 100, 0.5);
  scene.AddFrame(false);
  for (int row = 0; row < 14; ++row) {
    for (int i = 0; i <= row; ++i) {
      scene.AddBox(cpv(i * 32 - row * 16, 300 - row * 32), 1, 30, 30, 0.5, {.friction = 0.8});
    }
  }
  scene.AddDisc(cpv(0, -220), 10, 15, {.friction = 0.9});
}

void PyramidTopple(Scene& scene) {
  constexpr double kWidth = 4;
  constexpr double kHeight = 30;
  scene.time_step = 1.0 / 180;
  scene.Set(30, 300, 0.5);
  scene.AddWall(cpv(-600, -240), cpv(600, -240));
  const Surface surface{.friction = 0.6};
  const auto add_domino = [&](cpVect position, bool is_lying) {
    cpBody* const body = scene.Add(1, cpMomentForBox(1, kWidth, kHeight), position);
    scene.Attach(is_lying ? cpBoxShapeNew(body, kHeight, kWidth, 0) : cpBoxShapeNew(body, kWidth - 1, kHeight, 0.5),
                 surface);
  };
  constexpr int kRows = 12;
  for (int row = 0; row < kRows; ++row) {
    const int count = kRows - row;
    for (int i = 0; i < count; ++i) {
      const cpVect foot =
          cpv((i - (count - 1) * 0.5) * 1.5 * kHeight, (row + 0.5) * (kHeight + 2 * kWidth) - kWidth - 240);
      add_domino(foot, false);
      add_domino(foot + cpv(0, (kHeight + kWidth) / 2), true);
      if (i == 0) add_domino(foot + cpv((kWidth - kHeight) / 2, kHeight + kWidth), false);
      if (i != count - 1) {
        add_domino(foot + cpv(kHeight * 0.75, (kHeight + 3 * kWidth) / 2), true);
      } else {
        add_domino(foot + cpv((kHeight - kWidth) / 2, kHeight + kWidth), false);
      }
    }
  }
}

void ContactGraph(Scene& scene) {
  scene.Set(30, 300, 0.5);
  scene.AddFrame(false);
  scene.Attach(cpSegmentShapeNew(scene.ground, cpv(-240, -180), cpv(-140, -180), 4), {.friction = 1, .elasticity = 1});
  for (int i = 0; i < 5; ++i) scene.AddBox(cpv(0, i * 32 - 220), 1, 30, 30, 0, {.friction = 0.8});
  scene.AddDisc(cpv(120, -220), 10, 15, {.friction = 0.9});
}

// --- Piles

std::vector<cpVect> RegularPolygon(int corners, double radius) {
  std::vector<cpVect> points;
  for (int i = 0; i < corners; ++i) points.push_back(cpvforangle(-2 * kPi * i / corners) * radius);
  return points;
}

void Plink(Scene& scene) {
  scene.Set(5, 100);
  const std::array<cpVect, 3> triangle{cpv(-15, -15), cpv(0, 10), cpv(15, -15)};
  for (int column = 0; column < 9; ++column) {
    for (int row = 0; row < 6; ++row) {
      const cpVect offset = cpv(column * 80 - 320 + (row % 2) * 40, row * 70 - 240);
      scene.Attach(cpPolyShapeNew(scene.ground, 3, triangle.data(), cpTransformTranslate(offset), 0),
                   {.friction = 1, .elasticity = 1});
    }
  }
  const std::vector<cpVect> pentagon = RegularPolygon(5, 10);
  std::vector<cpBody*> bodies;
  Uniform uniform;
  for (int i = 0; i < 300; ++i) {
    bodies.push_back(scene.Add(1, cpMomentForPoly(1, 5, pentagon.data(), cpvzero, 0), cpv(uniform(-320, 320), 350)));
    scene.Attach(cpPolyShapeNew(bodies.back(), 5, pentagon.data(), cpTransformIdentity, 0), {.friction = 0.4});
  }
  scene.before_step = [bodies, uniform]() mutable {
    for (cpBody* const body : bodies) {
      const cpVect position = cpBodyGetPosition(body);
      if (position.y < -260 || std::abs(position.x) > 340) cpBodySetPosition(body, cpv(uniform(-320, 320), 260));
    }
  };
}

void Tumble(Scene& scene) {
  scene.time_step = 1.0 / 180;
  scene.Set(10, 600);
  cpBody* const drum = cpSpaceAddBody(scene.space, cpBodyNewKinematic());
  cpBodySetAngularVelocity(drum, 0.4);
  const std::array<cpVect, 4> corners{cpv(-200, -200), cpv(-200, 200), cpv(200, 200), cpv(200, -200)};
  for (std::size_t i = 0; i < 4; ++i) {
    scene.Attach(cpSegmentShapeNew(drum, corners[i], corners[(i + 1) % 4], 0), {.friction = 1, .elasticity = 1});
  }
  constexpr double kWidth = 30;
  constexpr double kHeight = 60;
  const Surface surface{.friction = 0.7};
  Uniform uniform;
  for (int column = 0; column < 7; ++column) {
    for (int row = 0; row < 3; ++row) {
      const cpVect position = cpv(column * kWidth - 150, row * kHeight - 150);
      const double kind = uniform(0, 3);
      if (kind < 1) {
        scene.AddBox(position, 1, kWidth, kHeight, 0, surface);
      } else if (kind < 2) {
        scene.AddBar(position, 1, cpMomentForBox(1, kWidth, kHeight), (kHeight - kWidth) / 2, kWidth / 2, surface);
      } else {
        for (const double side : {0.5, -0.5}) {
          scene.AddDisc(position + cpv(0, side * (kHeight - kWidth)), 1, kWidth / 2, surface);
        }
      }
    }
  }
}

/// The benchmark's basin, with a regular polygon of as many segments and about its size in place of its terrain, and
/// `add(place, size)` for bodies at random places, of one size or of sizes that vary 8-fold.
void FillBasin(Scene& scene, int count, double size, bool is_variable, const std::function<void(cpVect, double)>& add) {
  scene.Set(10, 100, 0.5);
  const std::vector<cpVect> corners = RegularPolygon(47, 200);
  for (std::size_t i = 0; i < corners.size(); ++i) scene.AddWall(corners[i], corners[(i + 1) % corners.size()], {});
  Uniform uniform;
  for (int i = 0; i < count; ++i) {
    const double factor = is_variable ? std::pow(1.5, uniform(-1.5, 3.5)) : 1;
    cpVect place;
    do {
      const double x = uniform(-1, 1);
      place = cpv(x, uniform(-1, 1));
    } while (cpvlengthsq(place) >= 1);
    add(place * 180.0, size * factor);
  }
}

constexpr Surface kInBasin{.friction = 0.9, .filter = {CP_NO_GROUP, CP_ALL_CATEGORIES, CP_ALL_CATEGORIES}};

template <int count, bool is_variable>
void BasinCircles(Scene& scene) {
  FillBasin(scene, count, 5, is_variable,
            [&scene](cpVect place, double radius) { scene.AddDisc(place, radius * radius / 25, radius, kInBasin); });
}
template <int count, bool is_variable>
void BasinBoxes(Scene& scene) {
  FillBasin(scene, count, is_variable ? 8 : 10, is_variable, [&scene](cpVect place, double size) {
    const double mass = size * size / 100;
    cpBody* const body = scene.Add(mass, cpMomentForBox(mass, size, size), place);
    scene.Attach(cpBoxShapeNew(body, size - 2, size - 2, 1), kInBasin);
  });
}
void BasinHexagons(Scene& scene) {
  FillBasin(scene, 500, 5, false, [&scene](cpVect place, double radius) {
    const std::vector<cpVect> hexagon = RegularPolygon(6, radius - 1);
    const double mass = radius * radius;
    cpBody* const body = scene.Add(mass, cpMomentForPoly(mass, 6, hexagon.data(), cpvzero, 0), place);
    scene.Attach(cpPolyShapeNew(body, 6, hexagon.data(), cpTransformIdentity, 1), kInBasin);
  });
}

// --- Joints

void Chains(Scene& scene) {
  constexpr double kWidth = 20;
  constexpr double kHeight = 30;
  constexpr double kSpacing = 6;
  scene.time_step = 1.0 / 180;
  scene.Set(30, 100);
  scene.AddFrame(true);
  for (int chain = 0; chain < 8; ++chain) {
    cpBody* previous = nullptr;
    for (int link = 0; link < 10; ++link) {
      const cpVect position = cpv(40 * (chain - 3.5), 240 - (link + 0.5) * kHeight - (link + 1) * kSpacing);
      cpBody* const body = scene.AddBar(position, 1, cpMomentForBox(1, kWidth, kHeight), (kHeight - kWidth) / 2,
                                        kWidth / 2, {.friction = 0.8});
      cpConstraint* const joint =
          previous == nullptr
              ? cpSlideJointNew(body, scene.ground, cpv(0, kHeight / 2), cpv(position.x, 240), 0, kSpacing)
              : cpSlideJointNew(body, previous, cpv(0, kHeight / 2), cpv(0, -kHeight / 2), 0, kSpacing);
      cpConstraintSetMaxForce(joint, 80000);
      cpConstraintSetCollideBodies(joint, cpFalse);
      scene.Join(joint);
      previous = body;
    }
  }
  cpBodySetVelocity(scene.AddDisc(cpv(0, -220), 10, 15, {.friction = 0.9}), cpv(0, 300));
}

void Joints(Scene& scene) {
  scene.Set(10, 100);
  for (int i = 0; i < 5; ++i) {
    scene.AddWall(cpv(-320, 240 - 120 * i), cpv(320, 240 - 120 * i));
    scene.AddWall(cpv(-320 + 160 * i, -240), cpv(-320 + 160 * i, 240));
  }
  using Pair = std::pair<cpBody*, cpBody*>;
  const cpVect left = cpv(50, 60);
  const cpVect right = cpv(110, 60);
  const auto balls = [&](cpVect cell) {
    const Surface surface{.friction = 0.7};
    cpBody* const first = scene.AddDisc(cell + left, 1, 15, surface);
    return Pair{first, scene.AddDisc(cell + right, 1, 15, surface)};
  };
  // Two that turn about points of the ground: bars about their middles, levers about their upper ends.
  const auto turning = [&](cpVect cell, bool is_bar) {
    const double half_length = is_bar ? 30 : 15;
    const double mass = is_bar ? 2 : 1;
    const double moment = cpMomentForSegment(mass, cpv(0, half_length), cpv(0, -half_length), 0);
    const Surface surface{.friction = 0.7, .filter = is_bar ? kOneGroup : CP_SHAPE_FILTER_ALL};
    const auto add = [&](cpVect pivot) {
      return scene.AddBar(pivot - cpv(0, is_bar ? 0 : 15), mass, moment, half_length, 5, surface);
    };
    const Pair pair{add(cell + left), add(cell + right)};
    scene.Join(cpPivotJointNew(pair.first, scene.ground, cell + left));
    scene.Join(cpPivotJointNew(pair.second, scene.ground, cell + right));
    return pair;
  };
  const cpVect near_a = cpv(15, 0);
  const cpVect near_b = cpv(-15, 0);
  auto [a, b] = balls(cpv(-320, -240));
  scene.Join(cpPinJointNew(a, b, near_a, near_b));
  std::tie(a, b) = balls(cpv(-160, -240));
  scene.Join(cpSlideJointNew(a, b, near_a, near_b, 20, 40));
  std::tie(a, b) = balls(cpv(0, -240));
  scene.Join(cpPivotJointNew(a, b, cpv(80, -180)));
  std::tie(a, b) = balls(cpv(160, -240));
  scene.Join(cpGrooveJointNew(a, b, cpv(30, 30), cpv(30, -30), cpv(-30, 0)));
  std::tie(a, b) = balls(cpv(-320, -120));
  scene.Join(cpDampedSpringNew(a, b, near_a, near_b, 20, 5, 0.3));
  std::tie(a, b) = turning(cpv(-160, -120), true);
  scene.Join(cpDampedRotarySpringNew(a, b, 0, 3000, 60));
  std::tie(a, b) = turning(cpv(0, -120), false);
  scene.Join(cpRotaryLimitJointNew(a, b, -kPi / 2, kPi / 2));
  std::tie(a, b) = turning(cpv(160, -120), false);
  scene.Join(cpRatchetJointNew(a, b, 0, kPi / 2));
  std::tie(a, b) = turning(cpv(-320, 0), true);
  scene.Join(cpGearJointNew(a, b, 0, 2));
  std::tie(a, b) = turning(cpv(-160, 0), true);
  scene.Join(cpSimpleMotorNew(a, b, kPi));

  const Surface grouped{.friction = 0.7, .filter = kOneGroup};
  cpBody* const wheel_a = scene.AddDisc(left, 1, 15, grouped);
  cpBody* const wheel_b = scene.AddDisc(right, 1, 15, grouped);
  cpBody* const chassis = scene.AddBox(cpv(80, 100), 5, 80, 30, 0, grouped);
  for (const auto& [wheel, x] : {std::pair{wheel_a, -30.0}, std::pair{wheel_b, 30.0}}) {
    scene.Join(cpGrooveJointNew(chassis, wheel, cpv(x, -10), cpv(x, -40), cpvzero));
    scene.Join(cpDampedSpringNew(chassis, wheel, cpv(x, 0), cpvzero, 50, 20, 10));
  }
}

void TheoJansen(Scene& scene) {
  constexpr double kOffset = 30;
  constexpr double kSide = 30;
  constexpr double kRadius = 3;
  constexpr double kCrankRadius = 13;
  scene.time_step = 1.0 / 180;
  scene.Set(20, 500);
  scene.AddFrame(false);
  const Surface grouped{.filter = kOneGroup};
  const auto add_segment = [&](double mass, cpVect end_a, cpVect end_b, cpVect position) {
    cpBody* const body = scene.Add(mass, cpMomentForSegment(mass, end_a, end_b, 0), position);
    scene.Attach(cpSegmentShapeNew(body, end_a, end_b, kRadius), grouped);
    return body;
  };
  cpBody* const chassis = add_segment(2, cpv(-kOffset, 0), cpv(kOffset, 0), cpvzero);
  cpBody* const crank = scene.Add(1, cpMomentForCircle(1, kCrankRadius, 0, cpvzero), cpvzero);
  scene.Attach(cpCircleShapeNew(crank, kCrankRadius, cpvzero), grouped);
  scene.Join(cpPivotJointNew2(chassis, crank, cpvzero, cpvzero));
  const auto add_leg = [&](double offset, cpVect pin) {
    const cpVect hip = cpv(offset, 0);
    cpBody* const upper = add_segment(1, cpvzero, cpv(0, kSide), hip);
    scene.Join(cpPivotJointNew2(chassis, upper, hip, cpvzero));
    cpBody* const lower = add_segment(1, cpvzero, cpv(0, -kSide), cpv(offset, -kSide));
    scene.Attach(cpCircleShapeNew(lower, 2 * kRadius, cpv(0, -kSide)), {.friction = 1, .filter = kOneGroup});
    scene.Join(cpPinJointNew(chassis, lower, hip, cpvzero));
    scene.Join(cpGearJointNew(upper, lower, 0, 1));
    for (const auto& [leg, anchor] : {std::pair{upper, cpv(0, kSide)}, std::pair{lower, cpvzero}}) {
      cpConstraint* const rod = cpPinJointNew(crank, leg, pin, anchor);
      cpPinJointSetDist(rod, std::hypot(kSide, offset));
      scene.Join(rod);
    }
  };
  for (int i = 0; i < 2; ++i) {
    add_leg(kOffset, cpvforangle(2 * i * kPi / 2) * kCrankRadius);
    add_leg(-kOffset, cpvforangle((2 * i + 1) * kPi / 2) * kCrankRadius);
  }
  cpConstraint* const motor = cpSimpleMotorNew(chassis, crank, 20.0 / 3);
  cpConstraintSetMaxForce(motor, 100000);
  scene.Join(motor);
}

void Pump(Scene& scene) {
  scene.time_step = 1.0 / 120;
  scene.Set(10, 600);
  const std::initializer_list<std::pair<cpVect, cpVect>> walls{
      {cpv(-256, 16), cpv(-256, 300)},  {cpv(-256, 16), cpv(-192, 0)},   {cpv(-192, 0), cpv(-192, -64)},
      {cpv(-128, -64), cpv(-128, 144)}, {cpv(-192, 80), cpv(-192, 176)}, {cpv(-192, 176), cpv(-128, 240)},
      {cpv(-128, 144), cpv(192, 64)}};
  constexpr cpBitmask kFeeder = 1U << 31U;  // it reaches through the walls
  for (const auto& [from, to] : walls) {
    scene.Attach(cpSegmentShapeNew(scene.ground, from, to, 2),
                 {.friction = 0.5, .filter = cpShapeFilterNew(CP_NO_GROUP, ~kFeeder, ~kFeeder)});
  }

  cpBody* const plunger = scene.Add(1, kInfinity, cpv(-160, -80));
  const std::array<cpVect, 4> corners{cpv(-30, -80), cpv(-30, 80), cpv(30, 64), cpv(30, -80)};
  scene.Attach(cpPolyShapeNew(plunger, 4, corners.data(), cpTransformIdentity, 0),
               {.friction = 0.5, .elasticity = 1, .filter = cpShapeFilterNew(CP_NO_GROUP, 1, 1)});
  std::vector<cpBody*> balls;
  for (int i = 0; i < 5; ++i) balls.push_back(scene.AddDisc(cpv(-224 + i, 80 + 64 * i), 1, 30, {.friction = 0.5}));

  const auto add_gear = [&](double mass, double radius, cpVect centre, double angle) {
    cpBody* const gear = scene.Add(mass, cpMomentForCircle(mass, radius, 0, cpvzero), centre);
    cpBodySetAngle(gear, angle);
    scene.Attach(cpCircleShapeNew(gear, radius, cpvzero), {.filter = CP_SHAPE_FILTER_NONE});
    scene.Join(cpPivotJointNew2(scene.ground, gear, centre, cpvzero));
    return gear;
  };
  cpBody* const small = add_gear(10, 80, cpv(-160, -160), -kPi / 2);
  cpBody* const big = add_gear(40, 160, cpv(80, -160), kPi / 2);
  scene.Join(cpPinJointNew(small, plunger, cpv(80, 0), cpvzero));
  scene.Join(cpGearJointNew(small, big, -kPi / 2, -2));

  constexpr double kBottom = -300;
  constexpr double kTop = 32;
  constexpr double kHalf = (kTop - kBottom) / 2;
  // The moment is the demo's: of a segment in the world's coordinates.
  cpBody* const feeder =
      scene.AddBar(cpv(-224, (kBottom + kTop) / 2), 1, cpMomentForSegment(1, cpv(-224, kBottom), cpv(-224, kTop), 0),
                   kHalf, 20, {.filter = cpShapeFilterNew(CP_NO_GROUP, kFeeder, kFeeder)});
  scene.Join(cpPivotJointNew2(scene.ground, feeder, cpv(-224, kBottom), cpv(0, -kHalf)));
  scene.Join(cpPinJointNew(feeder, small, cpBodyWorldToLocal(feeder, cpv(-224, -160)), cpv(0, 80)));

  cpConstraint* const motor = cpSimpleMotorNew(scene.ground, big, 20);
  cpConstraintSetMaxForce(motor, 1000000);
  scene.Join(motor);
  scene.before_step = [balls] {
    for (cpBody* const ball : balls) {
      if (cpBodyGetPosition(ball).x > 320) {
        cpBodySetVelocity(ball, cpvzero);
        cpBodySetPosition(ball, cpv(-224, 200));
      }
    }
  };
}

constexpr const char* kBasin =
    "a polygon of 47 equal sides and radius 200 in place of the terrain, random positions of our own";

constexpr SceneEntry<Scene> kScenes[] = {
    {"pyramid-stack", "PyramidStack.c", "", PyramidStack},
    {"pyramid-topple", "PyramidTopple.c", "", PyramidTopple},
    {"contact-graph", "ContactGraph.c", "", ContactGraph},
    {"plink", "Plink.c", "random positions of our own", Plink},
    {"tumble", "Tumble.c", "a random choice of bricks of our own", Tumble},
    {"basin-circles-100", "Bench.c (SimpleTerrainCircles_100)", kBasin, BasinCircles<100, false>},
    {"basin-circles-1000", "Bench.c (SimpleTerrainCircles_1000)", kBasin, BasinCircles<1000, false>},
    {"basin-vcircles-200", "Bench.c (SimpleTerrainVCircles_200)", kBasin, BasinCircles<200, true>},
    {"basin-boxes-100", "Bench.c (SimpleTerrainBoxes_100)", kBasin, BasinBoxes<100, false>},
    {"basin-vboxes-200", "Bench.c (SimpleTerrainVBoxes_200)", kBasin, BasinBoxes<200, true>},
    {"basin-hexagons-500", "Bench.c (SimpleTerrainHexagons_500)", kBasin, BasinHexagons},
    {"chains", "Chains.c", "its joints do not break", Chains},
    {"joints", "Joints.c", "", Joints},
    {"theo-jansen", "TheoJansen.c", "driven as by the right arrow key", TheoJansen},
    {"pump", "Pump.c", "driven as by the right arrow key", Pump},
};

// --- Reading the space

/// What the first body of a step calls before its velocity is integrated; Chipmunk's callback has no data of its own.
std::function<void()> on_solve;  // NOLINT(*-avoid-non-const-global-variables)

void UpdateVelocity(cpBody* body, cpVect gravity, cpFloat damping, cpFloat time_step) {
  if (on_solve) std::exchange(on_solve, nullptr)();
  cpBodyUpdateVelocity(body, gravity, damping, time_step);
}

/// Debian's Chipmunk prints two lines when the first space is made: to standard error here.
struct FirstSpace {
  FirstSpace() {
    const int output = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    cpSpaceFree(cpSpaceNew());
    std::fflush(stdout);
    dup2(output, STDOUT_FILENO);
    close(output);
  }
};

class Stage : private FirstSpace, public Scene {
 public:
  void Advance(int number, Step* step) {
    if (number == 0) Start();
    before_step();
    if (step != nullptr) {
      // Springs change velocities ahead of all other loads, and are loads here.
      velocities_.clear();
      for (const cpBody* const body : bodies_) velocities_.emplace_back(body->v, body->w);
      on_solve = [this, step] { Write(*step); };
    }
    cpSpaceStep(space, time_step);
  }

  Json Gravity() const { return Numbers({space->gravity.x, space->gravity.y}); }
  double TimeStep() const { return time_step; }
  Json Bodies() const {
    Json list = Json::array();
    for (const cpBody* const body : bodies_) list.push_back(BodyOf(body->m_inv, Rounded(body->i_inv)));
    return list;
  }

 private:
  void Start() {
    cpSpaceSetSleepTimeThreshold(space, kInfinity);
    cpSpaceEachBody(
        space, [](cpBody* body, void*) { cpBodySetVelocityUpdateFunc(body, UpdateVelocity); }, nullptr);
    for (int k = 0; k < space->dynamicBodies->num; ++k) {
      const auto* const body = static_cast<const cpBody*>(space->dynamicBodies->arr[k]);
      indices_[body] = static_cast<int>(bodies_.size());
      bodies_.push_back(body);
    }
  }

  void Write(Step& step) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const cpBody* const body = bodies_[k];
      const auto& [v, omega] = velocities_[k];
      const cpVect force =
          body->m_inv > 0 ? (space->gravity + (body->v - v) * (1 / time_step)) * body->m + body->f : cpvzero;
      const double torque = body->i_inv > 0 ? (body->w - omega) / time_step * body->i + body->t : 0;
      step.Body(Numbers({body->p.x, body->p.y}), Rounded(body->a), Numbers({v.x, v.y}), Rounded(omega),
                Numbers({force.x, force.y}), Rounded(torque));
    }
    for (int k = 0; k < space->arbiters->num; ++k) {
      AddContacts(step, *static_cast<const cpArbiter*>(space->arbiters->arr[k]));
    }
    for (int k = 0; k < space->constraints->num; ++k) {
      AddJoint(step, static_cast<const cpConstraint*>(space->constraints->arr[k]), static_cast<std::size_t>(k));
    }
  }

  static const char* NameOf(const cpShape* shape) {
    static constexpr const char* kNames[] = {"circle", "segment", "polygon"};
    return kNames[shape->klass->type];
  }

  /// Segments and polygons may have a radius: it is their surface's where a single contact's outward normal n is not
  /// that of a side. Two contacts of a pair are Chipmunk's way of saying that sides lie on each other.
  static double RadiusOf(const cpShape* shape, cpVect n) {
    constexpr double kParallel = 1e-6;
    if (shape->klass->type == CP_CIRCLE_SHAPE) return cpCircleShapeGetRadius(shape);
    const cpTransform transform = shape->body->transform;
    if (shape->klass->type == CP_SEGMENT_SHAPE) {
      const cpVect side =
          cpvnormalize(cpTransformVect(transform, cpSegmentShapeGetB(shape) - cpSegmentShapeGetA(shape)));
      return std::abs(cpvdot(side, n)) > kParallel ? cpSegmentShapeGetRadius(shape) : 0;
    }
    const int count = cpPolyShapeGetCount(shape);
    for (int i = 0; i < count; ++i) {
      const cpVect side = cpvnormalize(
          cpTransformVect(transform, cpPolyShapeGetVert(shape, (i + 1) % count) - cpPolyShapeGetVert(shape, i)));
      if (std::abs(cpvdot(side, n)) <= kParallel && cpvcross(side, n) < 0) return 0;
    }
    return cpPolyShapeGetRadius(shape);
  }

  /// Chipmunk tells contacts of a pair of shapes apart by a hash of their features; here they are numbered as they
  /// appear.
  std::string Identity(const cpArbiter& arbiter, const cpContact& contact) {
    const auto [low, high] = std::minmax(arbiter.a->hashid, arbiter.b->hashid);
    std::vector<cpHashValue>& known = identities_[{low, high}];
    const auto found = std::find(known.begin(), known.end(), contact.hash);
    const auto number = found - known.begin();
    if (found == known.end()) known.push_back(contact.hash);
    return std::to_string(low) + "-" + std::to_string(high) + ":" + std::to_string(number);
  }

  void AddContacts(Step& step, const cpArbiter& arbiter) {
    const cpVect n = arbiter.n;
    std::array<double, 2> radius{};
    if (arbiter.count == 1) radius = {RadiusOf(arbiter.a, n), RadiusOf(arbiter.b, cpvneg(n))};
    for (int k = 0; k < arbiter.count; ++k) {
      const cpContact& contact = arbiter.contacts[k];
      const cpVect on_a = arbiter.body_a->p + contact.r1;
      const cpVect on_b = arbiter.body_b->p + contact.r2;
      const cpVect p = cpvlerp(on_a, on_b, 0.5);
      step.Contact(IndexOf(indices_, arbiter.body_a), IndexOf(indices_, arbiter.body_b), Numbers({p.x, p.y}),
                   Numbers({n.x, n.y}), cpvdot(on_b - on_a, n), arbiter.u, Identity(arbiter, contact),
                   {NameOf(arbiter.a), NameOf(arbiter.b)}, radius);
    }
  }

  void AddJoint(Step& step, const cpConstraint* joint, std::size_t number) const {
    const cpBody* const a = joint->a;
    const cpBody* const b = joint->b;
    std::vector<JointRow> rows;
    // A row along n for the points at these levers about the centres of mass.
    const auto add = [&](cpVect lever_a, cpVect lever_b, cpVect n, double error, bool is_limit = false) {
      rows.push_back({{-n.x, -n.y, -cpvcross(lever_a, n), n.x, n.y, cpvcross(lever_b, n)}, error, is_limit});
    };
    const auto add_angle = [&](double sign_a, double sign_b, double error, bool is_limit = false) {
      rows.push_back({{0, 0, -sign_a, 0, 0, sign_b}, error, is_limit});
    };
    const auto lever = [](const cpBody* body, cpVect anchor) {
      return cpTransformVect(body->transform, anchor - body->cog);
    };
    cpVect ra, rb, d;  // levers, and from anchor to anchor
    const auto set_anchors = [&](cpVect anchor_a, cpVect anchor_b) {
      ra = lever(a, anchor_a);
      rb = lever(b, anchor_b);
      d = (b->p + rb) - (a->p + ra);
    };
    std::string kind;
    if (cpConstraintIsPinJoint(joint) != 0) {
      kind = "pin";
      set_anchors(cpPinJointGetAnchorA(joint), cpPinJointGetAnchorB(joint));
      add(ra, rb, cpvnormalize(d), cpvlength(d) - cpPinJointGetDist(joint));
    } else if (cpConstraintIsSlideJoint(joint) != 0) {
      kind = "slide";
      set_anchors(cpSlideJointGetAnchorA(joint), cpSlideJointGetAnchorB(joint));
      const double length = cpvlength(d);
      if (length > cpSlideJointGetMax(joint)) {
        add(ra, rb, cpvneg(cpvnormalize(d)), cpSlideJointGetMax(joint) - length, true);
      } else if (length < cpSlideJointGetMin(joint)) {
        add(ra, rb, cpvnormalize(d), length - cpSlideJointGetMin(joint), true);
      }
    } else if (cpConstraintIsPivotJoint(joint) != 0) {
      kind = "pivot";
      set_anchors(cpPivotJointGetAnchorA(joint), cpPivotJointGetAnchorB(joint));
      add(ra, rb, cpv(1, 0), d.x);
      add(ra, rb, cpv(0, 1), d.y);
    } else if (cpConstraintIsGrooveJoint(joint) != 0) {
      kind = "groove";
      const cpVect begin = cpTransformPoint(a->transform, cpGrooveJointGetGrooveA(joint));
      const cpVect end = cpTransformPoint(a->transform, cpGrooveJointGetGrooveB(joint));
      const cpVect along = cpvnormalize(end - begin);
      rb = lever(b, cpGrooveJointGetAnchorB(joint));
      const double place = cpvdot(b->p + rb - begin, along);
      const double rest = cpvdist(begin, end) - place;
      ra = begin + along * place - a->p;
      add(ra, rb, cpvperp(along), cpvdot(b->p + rb - begin, cpvperp(along)));
      if (place <= 0) add(ra, rb, along, place, true);
      if (rest <= 0) add(ra, rb, cpvneg(along), rest, true);
    } else if (cpConstraintIsRotaryLimitJoint(joint) != 0) {
      kind = "rotary-limit";
      const double angle = b->a - a->a;
      const double lower = angle - cpRotaryLimitJointGetMin(joint);
      const double upper = cpRotaryLimitJointGetMax(joint) - angle;
      if (lower < 0) add_angle(1, 1, lower, true);
      if (upper < 0) add_angle(-1, -1, upper, true);
    } else if (cpConstraintIsRatchetJoint(joint) != 0) {
      kind = "ratchet";
      const double sign = cpRatchetJointGetRatchet(joint) > 0 ? 1 : -1;
      const double past = sign * (b->a - a->a - cpRatchetJointGetAngle(joint));
      if (past < 0) add_angle(sign, sign, past, true);
    } else if (cpConstraintIsGearJoint(joint) != 0) {
      kind = "gear";
      const double ratio = cpGearJointGetRatio(joint);
      add_angle(1, ratio, b->a * ratio - a->a - cpGearJointGetPhase(joint));
    }  // motors and springs are no rows
    step.Joint(IndexOf(indices_, a), IndexOf(indices_, b), kind, number, std::move(rows));
  }

  std::vector<std::pair<cpVect, double>> velocities_;
  std::vector<const cpBody*> bodies_;
  std::unordered_map<const cpBody*, int> indices_;
  std::map<std::pair<cpHashValue, cpHashValue>, std::vector<cpHashValue>> identities_;
};

const Engine kEngine = {
    .name = "chipmunk",
    .version = cpVersionString,
    .licence = "MIT",
    .folder = "demo/",
    .rebuilt = " of Debian's source package chipmunk 7.0.3-5, rebuilt",
    .left_out = "friction, restitution, motors, dampers, bounds of joints' forces; springs are loads; sleeping is off",
    .dimension = 2};

}  // namespace
}  // namespace lcpbench::recorders

int main(int argc, char** argv) {
  using namespace lcpbench::recorders;
  return RunRecorder<Stage>(argc, argv, kEngine, kScenes);
}
