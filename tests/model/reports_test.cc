// Scenes that were right when people asked about their like elsewhere, and must stay so.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "model/motion/make_motion.h"
#include "model/scene_file/scene_file.h"
#include "model/scenes/parts.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

World Report(const std::string& name) {
  return ReadSceneFile(LCPBENCH_SOURCE_DIR "/tests/data/reports/ok/" + name + ".json").world;
}

// A disc passes from a slope into an arc: the curvature of its way, and with it the force, jumps.
TEST(Reports, TheForceJumpsWhereASlopeJoinsAnArc) {
  const auto solver = MakeSolver("dantzig");
  const auto motion = MakeMotion(MotionLevel::kAcceleration, Report("slope-jump"), {}, *solver);
  double greatest = 0;
  double before = 0;
  double after = 0;
  constexpr double kJump = 1.4618;
  motion->set_observer([&](const MotionProblem& met) {
    if (met.kind != MotionProblemKind::kAcceleration || met.problem.size() != 1) return;
    const double f = met.result.f[0];
    greatest = std::max(greatest, f);
    if (met.time < kJump - 1e-4) before = f;
    if (after == 0 && met.time > kJump - 1e-4) after = f;
  });
  for (int k = 0; k < 1000 && motion->time() < 2.6; ++k) motion->Advance(0.0025);
  EXPECT_NEAR(before, 645.194, 5e-4);
  EXPECT_NEAR(after, 749.70, 5e-3);
  EXPECT_NEAR(greatest, 785.93, 5e-3);
  EXPECT_EQ(motion->statistics().impacts, 0);
}

// The box slides over a convex break of the ground: it leaves it, and meets nothing before it falls down behind.
TEST(Reports, ABreakInTheGroundStopsNothing) {
  const auto solver = MakeSolver("dantzig");
  const auto motion = MakeMotion(MotionLevel::kAcceleration, Report("ghost-break"), {}, *solver);
  motion->Advance(1);
  EXPECT_NEAR(motion->world().bodies[1].x.x, 0, 1e-9);
  EXPECT_NEAR(motion->world().bodies[1].v.x, 1, 1e-9);
  EXPECT_NEAR(motion->world().bodies[1].x.y, 0.2, 1e-9);
  motion->Advance(0.1);
  EXPECT_EQ(motion->statistics().impacts, 0);
  EXPECT_GE(motion->world().bodies[1].v.x, 1 - 1e-9);
}

TEST(Reports, MassPropertiesAreTheClosedForms) {
  struct Expected {
    double area;
    double inertia;  // about the centre of mass
  };
  const double half_disc = 4 / (3 * kPi);
  const auto half = [&](double a, double b) {
    const double area = kPi * a * b / 2;
    const double y = half_disc * b;
    return Expected{area, area * ((a * a + b * b) / 4 - y * y)};
  };
  const double sector = 2 * std::sin(kPi / 6) / (3 * kPi / 6);
  const double disc = kPi / 4;  // of radius 1/2
  // Half discs of radius 1/2 at the ends of a middle part.
  const double end = half_disc / 2;
  const double end_inertia = disc / 2 * (0.125 - end * end);
  const double d_area = 1 + disc / 2;
  const double d_x = (disc / 2 * end - 0.5) / d_area;
  const double d_inertia = 1.0 / 6 + 0.25 + end_inertia + disc / 2 * end * end - d_area * d_x * d_x;
  const double corner = 0.25 * half_disc;  // centroid of a quarter disc, from its centre along either axis
  const double quarter = kPi * 0.0625 / 4;
  const double corner_inertia = quarter * (0.0625 / 2 - 2 * corner * corner);
  const double rounded = 1.5 * 1 + 2 * 0.25 * 0.5 + 4 * quarter;
  const double rounded_inertia =
      1.5 * (1.5 * 1.5 + 1) / 12 + 2 * 0.125 * ((0.0625 + 0.25) / 12 + 0.875 * 0.875) +
      4 * (corner_inertia + quarter * ((0.75 + corner) * (0.75 + corner) + (0.25 + corner) * (0.25 + corner)));
  const std::vector<std::pair<std::string, Expected>> all = {
      {"half", half(1, 0.5)},
      {"slice", {kPi / 6, kPi / 12 - kPi / 6 * sector * sector}},
      {"cap", {2 + disc, 2 * (4 + 1) / 12.0 + 2 * (end_inertia + disc / 2 * (1 + end) * (1 + end))}},
      {"ring", {kPi * 0.75, kPi / 2 * (1 - 0.0625)}},
      {"dsh", {d_area, d_inertia}},
      {"hd", half(1, 1)},
      {"rb", {rounded, rounded_inertia}}};
  const World world = Report("masses-1");
  for (const auto& [name, expected] : all) {
    SCOPED_TRACE(name);
    const auto body =
        std::find_if(world.bodies.begin(), world.bodies.end(), [&](const Body& b) { return b.name == name; });
    ASSERT_NE(body, world.bodies.end());
    EXPECT_NEAR(body->mass / expected.area, 1, 1e-14);
    EXPECT_NEAR(body->inertia / expected.inertia, 1, 1e-14);
  }
}

}  // namespace
}  // namespace lcpbench
