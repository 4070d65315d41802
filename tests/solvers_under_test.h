#pragma once

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

}  // namespace lcpbench
