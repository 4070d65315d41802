#include "benchmarks/motions/scene_source.h"

#include <unistd.h>

#include "model/scenes/scene.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/model/scenes/scene_checks.h"

namespace lcpbench {

namespace {

// A file of this process alone: tests run beside each other.
std::string PathOf(const std::string& file) {
  return (std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + "_" + file)).string();
}

class MovingScenes : public ::testing::TestWithParam<SceneFamily> {};

/// The scene as it is read back from the file that it was written to.
MovingScene WrittenAndRead(const MovingScene& scene, const std::string& file) {
  const std::string path = PathOf(file);
  std::ofstream(path, std::ios::binary) << FormatMovingScene(scene);
  MovingScene read = LoadScene(path, 1, 1);
  std::filesystem::remove(path);
  return read;
}

/// The problems of its first steps, to the last bit.
std::vector<std::string> Problems(const MovingScene& scene, int steps) {
  const auto solver = MakeSolver("dantzig");
  const auto motion = StartMotion(scene, {}, *solver);
  std::vector<std::string> problems;
  motion->set_observer([&](const MotionProblem& met) { problems.push_back(FormatLcpRecord(met.problem, false)); });
  motion->Advance(steps * scene.step);
  return problems;
}

TEST_P(MovingScenes, RunAtTheirOwnLevelWithoutStalling) {
  for (const std::uint64_t seed : {1ULL, 2ULL}) {
    const MovingScene scene = LoadScene(std::string(GetParam().key), 30, seed);
    const auto solver = MakeSolver("dantzig");
    const auto motion = StartMotion(scene, {}, *solver);
    int problems = 0;
    double busiest = 0;
    motion->set_observer([&](const MotionProblem& met) {
      ++problems;
      busiest = std::max(busiest, static_cast<double>(met.problem.size()));
      EXPECT_TRUE(Verify(met.problem, met.result, 1e-9).passes) << met.problem.id();
    });
    for (int k = 0; k < 100 && motion->status() == MotionStatus::kMoving; ++k) motion->Advance(scene.step);
    EXPECT_EQ(motion->status(), MotionStatus::kMoving) << motion->detail();
    EXPECT_NEAR(motion->time(), 100 * scene.step, 1e-9);
    EXPECT_GE(problems, 50);
    EXPECT_GE(busiest, 15);
    // Not a chatter of impacts.
    EXPECT_LE(problems, 1000);
    EXPECT_LE(motion->statistics().worst_penetration, 1e-4);
    EXPECT_LE(motion->statistics().worst_joint_error, 1e-4);
  }
}

TEST_P(MovingScenes, AreReadBackFromTheirFilesWithTheSameProblems) {
  const MovingScene scene = LoadScene(std::string(GetParam().key), 24, 3);
  const MovingScene read = WrittenAndRead(scene, std::string(GetParam().key) + ".json");
  EXPECT_EQ(read.level, scene.level);
  EXPECT_EQ(read.step, scene.step);
  EXPECT_EQ(read.restitution, scene.restitution);
  const std::vector<std::string> expected = Problems(scene, 4);
  EXPECT_EQ(Problems(read, 4), expected);
}

INSTANTIATE_TEST_SUITE_P(Families, MovingScenes, ::testing::ValuesIn(AllScenes().begin(), AllScenes().end()),
                         [](const auto& of) { return testing::TestNameOf(of.param.key); });

/// Families of contacts that lie still: gravity keeps them together.
TEST(MovingPiles, KeepMostOfTheirContactsActive) {
  for (const std::string key : {"discs-in-v", "disc-pile", "boxes-and-discs", "rockers"}) {
    const MovingScene scene = LoadScene(key, 40, 1);
    const auto solver = MakeSolver("dantzig");
    const auto motion = StartMotion(scene, {}, *solver);
    int active = 0;
    motion->set_observer(
        [&](const MotionProblem& met) { active = static_cast<int>((met.result.f.array() > 0).count()); });
    motion->Advance(0.3);
    EXPECT_GE(active, 20) << key;
  }
}

/// Two balls that touch the floor and come down at two speeds, under the file's words on impacts.
MovingScene TwoBalls(MotionLevel level, double fast, double slow, const std::string& impacts) {
  const std::string path = PathOf("two_balls.json");
  std::ofstream(path) << R"({"lcpbench_scene": 1, "motion": {"level": ")" << ToString(level) << R"(", "step": 0.001, )"
                      << impacts << R"(}, "bodies": [
      {"name": "floor", "fixed": true, "shape": {"chains": [[[4, 0], [-4, 0]]]}},
      {"name": "fast", "density": 1, "shape": {"disc": {"radius": 0.1}}, "position": [0, 0.1], "velocity": [0, )"
                      << -fast << R"(]},
      {"name": "slow", "density": 1, "shape": {"disc": {"radius": 0.1}}, "position": [1, 0.1], "velocity": [0, )"
                      << -slow << "]}]}";
  MovingScene scene = WrittenAndRead(LoadScene(path, 1, 1), "two_balls_again.json");
  std::filesystem::remove(path);
  return scene;
}

std::vector<double> SpeedsAfter(const MovingScene& scene) {
  const auto solver = MakeSolver("dantzig");
  const auto motion = StartMotion(scene, {}, *solver);
  motion->Advance(0.01);
  return {motion->world().bodies[1].v.y, motion->world().bodies[2].v.y};
}

TEST(StartMotion, PassesTheRestingSpeedToBothLevels) {
  for (const double e : {0.3, 0.8, 1.0}) {
    for (const double v : {1e-2, 5e-5, 1e-5, 1e-6}) {
      SCOPED_TRACE(v);
      const std::string restitution = "\"restitution\": " + std::to_string(e);
      const auto speed = [&](MotionLevel level, const std::string& more) {
        return SpeedsAfter(TwoBalls(level, v, v, restitution + more)).front();
      };
      EXPECT_NEAR(speed(MotionLevel::kAcceleration, ""), v < 1e-4 ? 0 : e * v, 1e-3 * v) << "the default, 1e-4 m/s";
      for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
        EXPECT_NEAR(speed(level, ", \"resting_speed\": 1e-7"), e * v, 1e-3 * v) << ToString(level);
        EXPECT_NEAR(speed(level, ", \"resting_speed\": 0.1"), 0, 1e-3 * v) << ToString(level);
      }
    }
  }
}

// In one impact Newton's law has one e, that of the fastest approach; Poisson's has one for each contact.
TEST(StartMotion, PassesTheImpactLawToBothLevels) {
  const std::string impacts = R"("restitution": 0.5, "resting_speed": 0.1, "impact_law": )";
  const auto speeds = [&](MotionLevel level, const std::string& law) {
    return SpeedsAfter(TwoBalls(level, 2, 0.05, impacts + law));
  };
  const std::vector<double> newton = speeds(MotionLevel::kAcceleration, R"("newton")");
  EXPECT_NEAR(newton[0], 1, 1e-9);
  EXPECT_NEAR(newton[1], 0.025, 1e-9);
  for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
    const std::vector<double> poisson = speeds(level, R"("poisson")");
    EXPECT_NEAR(poisson[0], 1, 1e-9) << ToString(level);
    EXPECT_NEAR(poisson[1], 0, 1e-9) << ToString(level);
    int impacts_met = 0;
    const auto solver = MakeSolver("dantzig");
    const auto motion = StartMotion(TwoBalls(level, 2, 0.05, impacts + R"("poisson")"), {}, *solver);
    motion->set_observer(
        [&](const MotionProblem& met) { impacts_met += met.kind == MotionProblemKind::kImpact ? 1 : 0; });
    motion->Advance(0.01);
    EXPECT_EQ(impacts_met, 2) << "compression, and once more after the restitution";
  }
}

/// Answers like dantzig, and remembers what it was asked for.
class Listening final : public LcpSolver {
 public:
  LcpOptions heard;

 private:
  void DoPrepare(const LcpProblem& problem) override { inner_->Prepare(problem); }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    heard = options;
    inner_->Solve(problem, options, result);
  }
  std::unique_ptr<LcpSolver> inner_ = MakeSolver("dantzig");
};

TEST(StartMotion, PassesToleranceAndTimeLimitToBothLevels) {
  LcpOptions lcp;
  lcp.tolerance = 3e-7;
  lcp.time_limit_s = 17;
  for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
    Listening solver;
    StartMotion(TwoBalls(level, 2, 2, "\"restitution\": 0"), lcp, solver)->Advance(0.01);
    EXPECT_EQ(solver.heard.tolerance, 3e-7) << ToString(level);
    EXPECT_EQ(solver.heard.time_limit_s, 17) << ToString(level);
  }
}

TEST(LoadInstant, IsTheFamilysProblemAndAFilesContacts) {
  const ContactSystem system = LoadInstant("rockers", 12, 5);
  EXPECT_EQ(FormatLcpRecord(AssembleContactLcp(system).problem, false),
            FormatLcpRecord(AssembleContactLcp(GenerateScene("rockers", 12, 5)).problem, false));
}

/// The first rope of a file: with the length that it has, and one that leaves it slack.
TEST(LoadInstant, LeavesOutSlackRopes) {
  const std::string file = LCPBENCH_SOURCE_DIR "/tests/data/reports/rope-of-no-length.json";
  World world = LoadScene(file, 1, 1).world;
  EXPECT_EQ(AssembleContactLcp(LoadInstant(file, 1, 1)).problem.size(), 0);
  for (const double y : {5.0, 4.9, 4.5, 4.01, 4.0}) {
    world.bodies[1].x.y = y;
    EXPECT_EQ(AssembleContactLcp(InstantWithContacts(world, MotionLevel::kVelocity, kFoundGap)).problem.size(),
              y == 4 ? 1 : 0)
        << y;
  }
}

}  // namespace
}  // namespace lcpbench
