// Scenes that were right when people asked about their like elsewhere, and must stay so.

#include "model/scene_file/scene_file.h"
#include "tests/model/motion/mover.h"

namespace lcpbench {
namespace {

World Report(const std::string& name) {
  return ReadSceneFile(LCPBENCH_SOURCE_DIR "/tests/data/reports/ok/" + name + ".json").world;
}

// A disc passes from a slope into an arc: the curvature of its way, and with it the force, jumps.
TEST(Reports, TheForceJumpsWhereASlopeJoinsAnArc) {
  const Mover motion(Report("slope-jump"));
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
  const Mover motion(Report("ghost-break"));
  motion->Advance(1);
  EXPECT_NEAR(motion.body(1).x.x, 0, 1e-9);
  EXPECT_NEAR(motion.body(1).v.x, 1, 1e-9);
  EXPECT_NEAR(motion.body(1).x.y, 0.2, 1e-9);
  motion->Advance(0.1);
  EXPECT_EQ(motion->statistics().impacts, 0);
  EXPECT_GE(motion.body(1).v.x, 1 - 1e-9);
}

}  // namespace
}  // namespace lcpbench
