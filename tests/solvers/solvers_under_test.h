#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// All own solvers of this build that take plain problems, and one peer of each library. For tests of code that drives
/// solvers, which take a process or seconds for each solver; what solvers promise is tested for all of them.
inline std::vector<SolverEntry> OwnSolversAndAPeerOfEachLibrary() {
  std::vector<SolverEntry> chosen;
  std::set<std::string> libraries;
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available || !entry.takes_plain) continue;
    if (entry.origin == SolverOrigin::kOwn || libraries.insert(entry.source).second) chosen.push_back(entry);
  }
  return chosen;
}

/// The solvers of this build; the test SolversOfThisBuild names the others.
inline std::vector<SolverEntry> SolversOf(SolverOrigin origin) {
  std::vector<SolverEntry> solvers;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available && entry.origin == origin) solvers.push_back(entry);
  }
  return solvers;
}
/// Those that take plain problems.
inline std::vector<SolverEntry> PlainSolversOf(SolverOrigin origin) {
  std::vector<SolverEntry> solvers = SolversOf(origin);
  std::erase_if(solvers, [](const SolverEntry& entry) { return !entry.takes_plain; });
  return solvers;
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

/// Of each kind of rows beyond those of plain problems, a small problem with one solution: a block and a shaft on the
/// ground, pushed along.
inline std::vector<LcpProblem> ProblemsOfEveryKind() {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(4, 4);
  A(0, 1) = A(1, 0) = A(2, 3) = A(3, 2) = 0.25;
  const auto make = [&](const char* id, std::vector<FrictionRow> friction, std::vector<BoundedRow> bounded) {
    return LcpProblem::FromDense(id, A, Eigen::Vector4d(-1, 2, -2, -0.5), {{}, std::move(friction), std::move(bounded)},
                                 SymmetricPsd());
  };
  return {make("friction", {{1, 0, 0.5}, {3, 2, 0.25}}, {}), make("sliding", {{1, 0, 0.5, 1}}, {}),
          make("several friction rows of a contact", {{1, 0, 0.5}, {3, 0, 0.25}}, {}),
          make("bounded", {}, {{1, -1, 1}}), make("friction and bounded", {{1, 0, 0.5}}, {{3, 0, 1}})};
}

/// For tests over solvers. What is counted by Answers must reach the number of LeastRightAnswers at the end of a test,
/// so that a solver cannot pass by answering nothing.
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

  void SetUp() override { solver_ = GetParam().make({}); }

  LcpResult Solve(const LcpProblem& problem, const LcpOptions& options) {
    return SolveWith(solver_.get(), problem, options);
  }
  LcpResult Solve(const LcpProblem& problem, double tolerance, double limit_s = LcpOptions{}.time_limit_s) {
    return Solve(problem, LcpOptions{.tolerance = tolerance, .time_limit_s = limit_s});
  }

  /// Problems with friction and bounded rows are solved where the table says so, and the solver does not refuse what is
  /// special of them, or else refused by the kind of rows.
  void ExpectRowKindsAreTakenOrRefused() {
    for (const LcpProblem& problem : ProblemsOfEveryKind()) {
      SCOPED_TRACE(problem.id());
      std::string refused;
      if (!problem.bounded_rows().empty() && !GetParam().takes_bounded) refused = "bounded rows";
      if (!problem.friction_rows().empty() && !GetParam().takes_friction) refused = "friction rows";
      const LcpResult result = Solve(problem, 1e-6, 5);
      EXPECT_EQ(result.f.size(), problem.size());
      if (!refused.empty()) {
        EXPECT_EQ(result.status, LcpStatus::kUnsupported);
        EXPECT_EQ(result.detail, refused);
      } else if (result.status == LcpStatus::kUnsupported) {
        const bool is_named = result.detail.find("rows") != std::string::npos;
        EXPECT_TRUE(is_named || result.detail.find("bodies") != std::string::npos) << result.detail;
      } else {
        const Verdict verdict = Verify(problem, result, 1e-6);
        const bool is_solved = result.status == LcpStatus::kSolved;
        // Peers may fail, if they say so, and their defaults have another tolerance.
        EXPECT_TRUE(is_solved || GetParam().origin == SolverOrigin::kPeer) << result.detail;
        if (is_solved && !GetParam().library_defaults) {
          EXPECT_FALSE(verdict.false_success) << verdict.reason;
          EXPECT_TRUE(verdict.passes || (verdict.model_rho >= 0 && verdict.model_rho <= 1e-6)) << verdict.reason;
        }
      }
      const LcpResult of_arrays = SolveArraysWith(solver_.get(), problem, {.tolerance = 1e-6, .time_limit_s = 5});
      EXPECT_EQ(of_arrays.status, result.status);
      EXPECT_EQ(of_arrays.f, result.f);
    }
  }

  std::unique_ptr<LcpSolver> solver_;

 private:
  int asked_ = 0;
  int right_ = 0;
};

}  // namespace lcpbench
