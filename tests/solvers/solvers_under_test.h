#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "solvers/registry.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {

/// All own solvers of this build, and one of each library of peers that is in it: for tests of what drives solvers,
/// which cost a process or seconds for each. What solvers themselves promise is tested for all of them.
inline std::vector<SolverEntry> OwnSolversAndAPeerOfEachLibrary() {
  std::vector<SolverEntry> chosen;
  std::set<std::string> libraries;
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available) continue;
    if (entry.origin == SolverOrigin::kOwn || libraries.insert(entry.source).second) chosen.push_back(entry);
  }
  return chosen;
}

/// All own solvers, also those that are not in this build: for tests that skip these by name.
inline std::vector<SolverEntry> OwnSolvers() {
  std::vector<SolverEntry> own;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin == SolverOrigin::kOwn) own.push_back(entry);
  }
  return own;
}

/// The key, as the name of a test instance.
inline std::string SolverTestName(const testing::TestParamInfo<SolverEntry>& info) {
  std::string name = info.param.key;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// How many of a test's problems a solver must answer rightly, at least, by tests/data/right_answers.csv.
inline int LeastRightAnswers(const std::string& test, const std::string& solver) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/tests/data/right_answers.csv");
  std::vector<std::string> tests;
  for (std::string line, cell; std::getline(file, line);) {
    if (line.starts_with("#")) continue;
    std::vector<std::string> cells;
    for (std::istringstream stream(line); std::getline(stream, cell, ',');) cells.push_back(cell);
    if (tests.empty()) tests = cells;
    if (cells.at(0) != solver && cells[0] != "other") continue;
    const auto column = static_cast<std::size_t>(std::find(tests.begin(), tests.end(), test) - tests.begin());
    if (column < cells.size() && !cells[column].empty()) return std::stoi(cells[column]);
  }
  ADD_FAILURE() << "right_answers.csv has no column " << test;
  return 0;
}

/// For tests over solvers: skips those that are not in this build. What is counted by Answers must reach the number of
/// LeastRightAnswers at the end of a test, so that a solver cannot pass by answering nothing.
class SolverTest : public testing::TestWithParam<SolverEntry> {
 protected:
  /// Counts a problem, and whether its answer is right. @return is_right
  bool Answers(bool is_right) {
    ++asked_;
    right_ += is_right ? 1 : 0;
    return is_right;
  }
  bool Answers(const LcpResult& result) { return Answers(result.status == LcpStatus::kSolved); }

  void TearDown() override {
    if (asked_ == 0) return;
    std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    test.resize(test.find('/'));
    EXPECT_GE(right_, LeastRightAnswers(test, GetParam().key)) << "right answers of " << asked_ << " problems";
  }

  void SetUp() override {
    if (!GetParam().available) GTEST_SKIP() << GetParam().key << " is not in this build";
    solver_ = GetParam().make({});
  }

  LcpResult Solve(const LcpProblem& problem, const LcpOptions& options) {
    return SolveWith(solver_.get(), problem, options);
  }
  LcpResult Solve(const LcpProblem& problem, double tolerance, double limit_s = LcpOptions{}.time_limit_s) {
    return Solve(problem, LcpOptions{.tolerance = tolerance, .time_limit_s = limit_s});
  }

  std::unique_ptr<LcpSolver> solver_;

 private:
  int asked_ = 0;
  int right_ = 0;
};

}  // namespace lcpbench
