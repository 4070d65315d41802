#include "benchmarks/motions/motion_study.h"
#include "model/scenes/parts.h"
#include "support/input_error.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

/// The cells of the only row of one outcome's table.
std::vector<std::string> CellsOf(const MotionOutcome& outcome) {
  std::istringstream text(FormatMotionTable({outcome}));
  std::string line;
  for (int k = 0; k < 3; ++k) std::getline(text, line);
  std::istringstream row(line);
  std::vector<std::string> cells;
  for (std::string cell; row >> cell;) cells.push_back(cell);
  return cells;
}

TEST(MotionTable, ShowsADashForWhatWasNotMeasuredAndZeroForWhatWasMeasuredToBeZero) {
  using Cells = std::vector<std::string>;
  MotionOutcome outcome;
  outcome.driver.solver = "dantzig";
  outcome.tolerance = 1e-9;
  EXPECT_EQ(CellsOf(outcome), (Cells{"dantzig", "1.0e-09", "-", "-", "-", "-", "-", "-", "-", "0", "0", "0", "0"}));
  outcome.steps = 10;
  outcome.energy_drift = outcome.energy_error = outcome.penetration = outcome.distance = outcome.rho = 0;
  outcome.solves = 4;
  outcome.solve_time_s = 5e-5;
  EXPECT_EQ(CellsOf(outcome), (Cells{"dantzig", "1.0e-09", "0", "0", "0", "-", "0", "5.0", "0", "4", "0", "0", "0"}));
}

TEST(MotionDriver, IsReadBackAsItIsWritten) {
  for (const char* text : {"pgs", "pgs@10", "auto@cold", "pgs@10@cold"})
    EXPECT_EQ(ToString(ParseMotionDriver(text)), text);
  const MotionDriver driver = ParseMotionDriver("pgs@cold@1e-3@50");
  EXPECT_EQ(driver.solver, "pgs");
  EXPECT_EQ(driver.tolerance, 1e-3);
  EXPECT_EQ(driver.max_iterations, 50);
  EXPECT_FALSE(driver.warm_start);
  for (const char* text : {"pgs@", "pgs@0", "pgs@-1", "pgs@2.5", "pgs@warm", "pgs@1e99", "pgs@10 "}) {
    EXPECT_THROW(ParseMotionDriver(text), InputError) << text;
  }
}

// What is measured of friction, by scene and driver.
class FrictionStudy : public ::testing::Test {
 protected:
  static std::map<std::string, MotionOutcome> Drive(const std::string& scene, int steps,
                                                    const std::vector<std::string>& drivers) {
    MotionStudy study;
    study.scenes = {LoadScene(LCPBENCH_SOURCE_DIR "/data/scenes/" + scene + ".json", 1, 1)};
    for (const std::string& driver : drivers) study.drivers.push_back(ParseMotionDriver(driver));
    study.tolerances = {1e-9};
    study.steps = steps;
    study.budget_s = 1e3;
    const std::string folder = ::testing::TempDir() + "/friction-study-" + scene;
    std::map<std::string, MotionOutcome> found;
    for (const MotionOutcome& outcome : RunMotionStudy(study, folder)) found[ToString(outcome.driver)] = outcome;
    std::filesystem::remove_all(folder);
    return found;
  }
};

TEST_F(FrictionStudy, SlabsThatRestCreepTheMoreTheSoonerSweepsEnd) {
  auto found = Drive("slabs_on_slope", 30, {"auto", "relaxation", "pgs@50", "pgs@10", "pgs@10@cold"});
  for (const char* exact : {"auto", "relaxation"}) {
    EXPECT_LT(found[exact].creep, 1e-9) << exact;
    EXPECT_LT(found[exact].distance, 1e-9) << exact;
    EXPECT_LT(found[exact].created, 1e-8) << exact;
  }
  // Friction that pulls a slab the way it slides gives energy.
  EXPECT_GT(found["pgs@10"].created, 0.1);
  EXPECT_GT(found["pgs@50"].creep, 1e-4);
  EXPECT_GT(found["pgs@10"].creep, 2 * found["pgs@50"].creep);
  EXPECT_GT(found["pgs@10@cold"].creep, found["pgs@10"].creep);
}

TEST_F(FrictionStudy, AnArchStandsAndSinksUnderSweepsThatEndSoon) {
  auto found = Drive("arch_of_stones", 15, {"auto", "pgs@50", "pgs@10", "pgs@10@cold"});
  EXPECT_LT(found["auto"].distance, 1e-9);
  EXPECT_GT(found["pgs@50"].distance, 1e-5);
  EXPECT_GT(found["pgs@10"].distance, 3 * found["pgs@50"].distance);
  EXPECT_GT(found["pgs@10@cold"].distance, found["pgs@10"].distance);
}

// The relaxation opens a gap of mu u h, u = (u0 - mu g h) / (1 + mu^2) the speed after the first step.
TEST_F(FrictionStudy, ABlockThatSlidesHoversUnderTheRelaxationAlone) {
  auto found = Drive("sliding_block", 30, {"auto", "pgs", "relaxation"});
  EXPECT_LT(found["auto"].lost_gap, 1e-12);
  EXPECT_LT(found["auto"].creep, 1e-12);  // none where friction is at its limit
  EXPECT_LT(found["auto"].created, 1e-12);
  EXPECT_LT(found["pgs"].lost_gap, 1e-9);
  const double h = 1.0 / 60;
  EXPECT_NEAR(found["relaxation"].lost_gap, 0.3 * (3 - 0.3 * kGravity * h) / 1.09 * h, 1e-9);
}

}  // namespace
}  // namespace lcpbench
