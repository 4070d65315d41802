// billiards-break: a triangular rack of equal discs, seen from above, pressed by a cue ball at its apex.
//
// The triangular lattice of discs-in-v without its walls: nothing is fixed, the discs push one another only, and
// contact forces keep the momentum of the whole. About three rows per disc against two degrees of freedom: A is rank
// deficient (rank 0.72 of the rows at 1000), and its masses are all equal - what remains hard is the redundancy and
// the distance that the thrust of the cue ball travels through the rack.
//
// Rows with w > 0 at the solution, seeds 1 to 5: 20-40 % at 10 rows, 26-32 % at 100, 22-25 % at 1000, 8-22 % at 3000;
// at 1000 another 7-10 % have f = w = 0 in a basic solution.
//
// As one problem, the rack is at rest and every disc is pushed at random, the cue ball into the rack. As a sequence it
// is the break: the cue ball comes from the head of the table, without any load, between four cushions. Restitution is
// the simulation's to choose; 0.95 is that of billiard balls. The break is one simultaneous impact, every later one
// another problem of impulses.
//
// Discs are racked layer by layer. The last one or two rows are closed by discs in line behind the cue ball.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/packing_parts.h"
#include "model/scenes/scene.h"
#include "model/scenes/start.h"

namespace lcpbench {
namespace {

/// Of a pool ball [m], [kg].
constexpr double kRadius = 0.028575;
constexpr double kMass = 0.17;
/// The cue ball's push over its weight, for each layer of the rack.
constexpr double kPush = 3;
/// Pull towards the middle of the rack, over the weight, of a disc at its edge: a dished cloth.
constexpr double kDish = 0.3;
constexpr double kBreakSpeed = 8;  ///< [m/s]

struct Rack {
  ContactSystem system;
  int layers = 0;
  std::vector<int> cues;  ///< the cue ball and the discs in line behind it
  Vec2 aim;               ///< the unit direction of the cue ball's push
  double head = 0;        ///< distance that the cue ball starts from in the break [m]
};

int AddBall(ContactSystem* system, const char* kind, Vec2 x) {
  Body ball = MakeDisc(x, kRadius, kMass / (kPi * kRadius * kRadius));
  // A ball's inertia, not a plate's.
  ball.inertia = 0.4 * kMass * kRadius * kRadius;
  return AddBody(system, kind, ball);
}

void TouchBalls(ContactSystem* system, int ball, int other) {
  AddContact(system, ball, Circle(kRadius), other, Circle(kRadius));
}

Rack MakeRack(int rows, std::uint64_t seed) {
  Random random(seed);
  Rack rack{EmptyScene("billiards-break", rows, seed), 0, {}, {}, 0};
  ContactSystem& system = rack.system;
  const int table = AddBody(&system, "table", MakeFixed("table"));

  // The apex at the origin; disc i of layer k (both from 0) is the (i+1)-th of k + 1, on lines parallel to y.
  const double root3 = std::sqrt(3.0);
  std::vector<int> front{AddBall(&system, "ball", {})};
  const Vec2 slanted{1, random.Uniform(-0.3, 0.3)};
  rack.aim = (1 / Norm(slanted)) * slanted;
  rack.cues.push_back(AddBall(&system, "cue ball", -2 * kRadius * rack.aim));
  TouchBalls(&system, rack.cues[0], front[0]);
  int left = rows - 1;
  for (int layer = 1; left > 0; ++layer) {
    std::vector<int> current;
    for (int i = 0; i <= layer; ++i) {
      const int touched = (i > 0 ? 2 : 0) + (i < layer ? 1 : 0);
      if (touched > left) break;
      const int ball = AddBall(&system, "ball", {layer * root3 * kRadius, (2 * i - layer) * kRadius});
      if (i > 0) TouchBalls(&system, ball, current.back());
      if (i > 0) TouchBalls(&system, ball, front[static_cast<std::size_t>(i) - 1]);
      if (i < layer) TouchBalls(&system, ball, front[static_cast<std::size_t>(i)]);
      left -= touched;
      current.push_back(ball);
      rack.layers = layer;
    }
    if (static_cast<int>(current.size()) <= layer) break;
    front.swap(current);
  }
  for (; left > 0; --left) {
    const int last = rack.cues.back();
    const Vec2 behind = system.bodies[static_cast<std::size_t>(last)].x - 2 * kRadius * rack.aim;
    rack.cues.push_back(AddBall(&system, "ball", behind));
    TouchBalls(&system, last, rack.cues.back());
  }

  const double depth = rack.layers * root3 * kRadius;
  const double half_width = std::max(0.6, 1.5 * rack.layers * kRadius);
  rack.head = 0.5 + depth;
  const Vec2 low{-rack.head - 1, -half_width};
  const Vec2 high{depth + 1, half_width};
  // The cloth is on the right of the direction of travel.
  system.bodies[static_cast<std::size_t>(table)].outline = {
      WholeEdge(low, {low.x, high.y}), WholeEdge({low.x, high.y}, high), WholeEdge(high, {high.x, low.y}),
      WholeEdge({high.x, low.y}, low)};

  ApplyLoads(&system, {.weight = 0, .gust = kGravity}, &random);
  const Vec2 middle{2 * depth / 3, 0};
  const double reach = std::max(depth, kRadius);
  for (Body& body : system.bodies) {
    if (!body.fixed) body.force = body.force - (kDish * kMass * kGravity / reach) * (body.x - middle);
  }
  Body& cue = system.bodies[static_cast<std::size_t>(rack.cues.back())];
  cue.force = cue.force + (kPush * kMass * kGravity * (1 + rack.layers)) * rack.aim;
  return rack;
}

ContactSystem Generate(int rows, std::uint64_t seed) { return MakeRack(rows, seed).system; }

World Start(int rows, std::uint64_t seed) {
  const Rack rack = MakeRack(rows, seed);
  World world = WorldUnderGravity(rack.system, {});
  for (const int cue : rack.cues) {
    Body& body = world.bodies[static_cast<std::size_t>(cue)];
    // Straight at the apex, which the direction of the push hits off centre.
    body.x = body.x - Vec2{rack.head, 0};
    body.v = {kBreakSpeed, 0};
  }
  return world;
}

}  // namespace

extern const SceneFamily kBilliardsBreak{
    "billiards-break",
    "Rack of discs pressed, or broken, by a cue ball",
    "Equal masses and nothing fixed: the redundancy of a lattice alone. Its sequence is a series of "
    "simultaneous impacts.",
    &Generate,
    &Start,
    MotionLevel::kAcceleration,
    2e-3,
    0.95};

}  // namespace lcpbench
