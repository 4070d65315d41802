// The engine of the examples moves as the model does: the same scheme, coded apart, with contacts of its own.
#define main EngineLoopMain
#include "examples/engine_loop.cc"  // NOLINT(bugprone-suspicious-include): a program of one file
#undef main

#include <gtest/gtest.h>

#include "model/motion/make_motion.h"
#include "model/shape/shapes.h"
#include "solvers/registry.h"

namespace {

using lcpbench::Body;

// The discs of the engine in a ring of the bowl's radius.
lcpbench::World WorldOf(const std::vector<Disc>& discs) {
  lcpbench::World world;
  for (const Disc& disc : discs) {
    Body body = lcpbench::MakeBody(lcpbench::Disc(disc.radius), 1);
    for (auto& piece : body.outline) piece = Transformed(piece, 0, {disc.offset, 0});
    body.name = "disc" + std::to_string(world.bodies.size());
    body.mass = disc.mass;
    body.inertia = disc.inertia;
    body.x = {disc.x, disc.y};
    body.theta = disc.angle;
    world.bodies.push_back(body);
  }
  Body bowl = lcpbench::MakeBody(lcpbench::Ring(kBowl + 1, kBowl), 1);
  bowl.name = "bowl";
  bowl.fixed = true;
  world.bodies.push_back(bowl);
  world.loads.gravity = {0, kGravity};
  return world;
}

TEST(EngineLoop, MovesAsTheModelDoes) {
  const std::vector<Disc> discs = DropDiscs(15);
  lcpbench::VelocityOptions options;
  options.step = kStep;
  options.lcp.tolerance = 1e-9;
  const auto solver = lcpbench::MakeSolver("dantzig");
  const auto motion = lcpbench::MakeVelocityMotion(WorldOf(discs), options, *solver);
  Engine engine(discs, true);
  for (int step = 1; step <= 400; ++step) {
    ASSERT_TRUE(engine.Step());
    motion->Advance(kStep);
    ASSERT_EQ(motion->status(), lcpbench::MotionStatus::kMoving) << motion->detail();
    double worst = 0;  // [m], [rad]
    for (std::size_t i = 0; i < discs.size(); ++i) {
      const Body& body = motion->world().bodies[i];
      worst = std::max({worst, std::abs(engine.discs[i].x - body.x.x), std::abs(engine.discs[i].y - body.x.y),
                        std::abs(engine.discs[i].angle - body.theta)});
    }
    ASSERT_LE(worst, 1e-9) << step;  // rounding grows with every impact
  }
  EXPECT_GT(engine.contacts, 25U);
}

}  // namespace
