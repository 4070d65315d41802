#pragma once

#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// One backend. The key is the same in files, tests, benchmarks and the report.
struct SolverEntry {
  std::string_view key;
  std::string_view method;  ///< one line
  std::string_view source;  ///< paper or library
  bool available;           ///< false: not in this build (the row stays)
  bool uses_tolerance;      ///< false: a direct method, one run stands for every tier
  /// "" where theory (and our tests) promise a solution at `tolerance` for this problem, else the reason in words.
  std::string (*why_not_guaranteed)(const LcpProblem& problem, double tolerance);
  /// nullptr where not available. @throws InputError for unknown or impossible settings
  std::unique_ptr<LcpSolver> (*make)(const Settings& settings);
};

inline std::ostream& operator<<(std::ostream& out, const SolverEntry& entry) { return out << entry.key; }

/// Every backend, in the report's order.
std::span<const SolverEntry> AllSolvers();

/// @throws InputError naming the known keys
const SolverEntry& FindSolver(std::string_view key);

/// A solver by key. @throws InputError when unknown, not in this build, or for a wrong setting
std::unique_ptr<LcpSolver> MakeSolver(std::string_view key, const Settings& settings = {});

}  // namespace lcpbench
