#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where a backend comes from.
enum class SolverOrigin {
  kOwn,       ///< written here, on the libraries of this build
  kPeer,      ///< another project's, behind a worker process (solvers/peers/)
  kExternal,  ///< a command that the user named (RegisterExternalSolver)
};

/// One backend. The key is the same in files, tests, benchmarks and the report.
struct SolverEntry {
  std::string key;
  std::string method;           ///< one line
  std::string source;           ///< paper or library
  bool available = false;       ///< false: not in this build (the row stays)
  bool uses_tolerance = false;  ///< false: a direct method, one run stands for every tier
  /// "" where theory (and our tests) promise a solution at `tolerance` for this problem, else the reason in words.
  std::string (*why_not_guaranteed)(const LcpProblem& problem, double tolerance) = nullptr;
  /// Empty where not available. @throws InputError for unknown or impossible settings
  std::function<std::unique_ptr<LcpSolver>(const Settings& settings)> make;
  SolverOrigin origin = SolverOrigin::kOwn;
  std::string licence = "Apache-2.0";  ///< SPDX expression: of our code, or of the peer's library
};

inline std::ostream& operator<<(std::ostream& out, const SolverEntry& entry) { return out << entry.key; }

/// Every backend, in the report's order: own, peers, external. Valid until the next RegisterExternalSolver.
std::span<const SolverEntry> AllSolvers();

/// An older key of a solver, `suitesparse` for `ipm`, finds it too.
/// @throws InputError naming the known keys
const SolverEntry& FindSolver(std::string_view key);

/// A solver by key. @throws InputError when unknown, not in this build, or for a wrong setting
std::unique_ptr<LcpSolver> MakeSolver(std::string_view key, const Settings& settings = {});

/// The version of the library behind a peer or external solver, as its worker says; "" for own solvers, and for workers
/// that do not start. Starts the worker on the first call.
std::string WorkerVersion(std::string_view key);

/// Adds a solver that runs as a command of the user's (solvers/external/protocol.h). Not thread-safe.
/// @param command  program and arguments
/// @throws InputError unless the key is new and made of a-z, 0-9, '-', '_', and the command is not empty
void RegisterExternalSolver(const std::string& key, const std::vector<std::string>& command);

}  // namespace lcpbench
