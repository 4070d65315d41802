#include "benchmarks/studies/fresh_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

constexpr double kWrong = std::numeric_limits<double>::infinity();
constexpr double kNoTurn = std::numeric_limits<double>::quiet_NaN();

TEST(FreshTable, QuantilesAreByWeight) {
  EXPECT_EQ(WeightedQuantile({3, 1, 2}, {1, 1, 1}, 0.5), 2);
  EXPECT_EQ(WeightedQuantile({4, 1, 2, 3}, {1, 1, 1, 1}, 0.5), 2.5);
  EXPECT_EQ(WeightedQuantile({1, 2, 3}, {0.5, 0.5, 3}, 0.5), 3);
  // Three variants of one base weigh as much as one problem: half of the weight is at 1, half at 5.
  EXPECT_EQ(WeightedQuantile({1, 5, 5, 5}, {1, 1.0 / 3, 1.0 / 3, 1.0 / 3}, 0.5), 3);
  EXPECT_EQ(WeightedQuantile({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, std::vector<double>(10, 1), 0.9), 9.5);
  EXPECT_EQ(WeightedQuantile({1, kWrong, kWrong}, {1, 1, 1}, 0.5), kWrong);
  EXPECT_TRUE(std::isnan(WeightedQuantile({}, {}, 0.5)));
}

TEST(FreshTable, FailuresAreInfiniteAndThoseWithoutATurnLeftOut) {
  const FreshTimes times{"ours", true, {1, kWrong, 3, kNoTurn}};
  const FreshSummary summary = Summarize(times, {1, 2, 1, 7});
  EXPECT_EQ(summary.problems, 3U);
  EXPECT_DOUBLE_EQ(summary.right, 0.5);
  EXPECT_EQ(summary.median_s, kWrong);
  EXPECT_EQ(summary.p90_s, 3);
  EXPECT_TRUE(std::isnan(summary.p99_s));
}

TEST(FreshTable, HighPercentilesAreOfManyProblems) {
  std::vector<double> seconds(200);
  for (std::size_t k = 0; k < seconds.size(); ++k) seconds[k] = static_cast<double>(k);
  const FreshSummary summary = Summarize({"ours", true, seconds}, std::vector<double>(200, 1));
  EXPECT_DOUBLE_EQ(summary.median_s, 99.5);
  EXPECT_DOUBLE_EQ(summary.p90_s, 179.5);
  EXPECT_DOUBLE_EQ(summary.p99_s, 197.5);
}

FreshGroup ThreeSolvers() {
  FreshGroup group{"placed", "4-6", std::vector<double>(100, 1), {}};
  std::vector<double> ours(100, 2), right(100, 4), quick(100, 1);
  ours[0] = kWrong;
  for (std::size_t k = 0; k < 10; ++k) quick[k] = kWrong;
  group.solvers = {{"ours", true, ours}, {"right", false, right}, {"quick", false, quick}};
  return group;
}

TEST(FreshTable, TheBestPeerIsTheFastestOfThoseThatAreRight) {
  FreshGroup group = ThreeSolvers();
  ASSERT_NE(BestOf(group, false), nullptr);
  EXPECT_EQ(BestOf(group, false)->solver, "right");
  ASSERT_NE(BestOf(group, true), nullptr);  // 99 % are enough
  EXPECT_EQ(BestOf(group, true)->solver, "ours");
  group.solvers[0].seconds[1] = kWrong;
  EXPECT_EQ(BestOf(group, true), nullptr);
  // Few turns prove nothing.
  for (std::size_t k = 10; k < 100; ++k) group.solvers[1].seconds[k] = kNoTurn;
  EXPECT_EQ(BestOf(group, false), nullptr);
  EXPECT_EQ(BestOf(group, false, 0.9)->solver, "quick");
}

TEST(FreshTable, RatiosAreOverProblemsThatTheOtherSolves) {
  const FreshGroup group = ThreeSolvers();
  const FreshTimes& ours = group.solvers[0];
  EXPECT_DOUBLE_EQ(RatioTo(ours.seconds, group.solvers[1].seconds, group.weights), 0.5);
  const std::vector<double> fastest = FastestPeer(group);
  EXPECT_EQ(fastest[3], 4);
  EXPECT_EQ(fastest[50], 1);
  EXPECT_DOUBLE_EQ(RatioTo(ours.seconds, fastest, group.weights), 2);
  EXPECT_DOUBLE_EQ(RatioTo({1, 6, kNoTurn, 9}, {2, 2, 1, kWrong}, {3, 1, 5, 5}), 0.5);
  EXPECT_EQ(RatioTo({kWrong}, {2}, {1}), kWrong);
  EXPECT_TRUE(std::isnan(RatioTo({1}, {kWrong}, {1})));
}

TEST(FreshTable, SaysWhereNoPeerIsRight) {
  FreshGroup group = ThreeSolvers();
  std::ostringstream out;
  WriteFreshTables({group}, out);
  EXPECT_NE(out.str().find("| 4-6 | 100 | **ours** | 99.0 % | 2 s | 2 s | 2 s | 0.5 | 2 | 1 |"), std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find("| placed | 0.5 right |"), std::string::npos) << out.str();
  group.solvers.erase(group.solvers.begin() + 1);
  std::ostringstream without;
  WriteFreshTables({group}, without);
  EXPECT_NE(without.str().find("| placed | 2* quick |"), std::string::npos) << without.str();
  // One that is right on the few problems that it had is no rival, and does not hide the one that had all.
  std::vector<double> few(100, kNoTurn);
  few[0] = 1;
  group.solvers.push_back({"few", false, few});
  std::ostringstream hidden;
  WriteFreshTables({group}, hidden);
  EXPECT_NE(hidden.str().find("| placed | 2* quick |"), std::string::npos) << hidden.str();
  group.solvers[1].seconds.assign(100, kWrong);
  std::ostringstream none;
  WriteFreshTables({group}, none);
  EXPECT_NE(none.str().find("| placed | – |"), std::string::npos) << none.str();
}

}  // namespace
}  // namespace lcpbench
