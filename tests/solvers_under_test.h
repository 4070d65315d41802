#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
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

/// For tests over solvers: skips those that are not in this build.
class SolverTest : public testing::TestWithParam<SolverEntry> {
 protected:
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
};

}  // namespace lcpbench
