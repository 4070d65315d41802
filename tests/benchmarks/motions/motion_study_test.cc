#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/motions/motion_study.h"

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
  outcome.solver = "dantzig";
  outcome.tolerance = 1e-9;
  EXPECT_EQ(CellsOf(outcome), (Cells{"dantzig", "1.0e-09", "-", "-", "-", "-", "-", "-", "-", "0", "0", "0", "0"}));
  outcome.steps = 10;
  outcome.energy_drift = outcome.energy_error = outcome.penetration = outcome.distance = outcome.rho = 0;
  outcome.solves = 4;
  outcome.solve_time_s = 5e-5;
  EXPECT_EQ(CellsOf(outcome), (Cells{"dantzig", "1.0e-09", "0", "0", "0", "-", "0", "5.0", "0", "4", "0", "0", "0"}));
}

}  // namespace
}  // namespace lcpbench
