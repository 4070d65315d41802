#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "solvers/registry.h"

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

}  // namespace lcpbench
