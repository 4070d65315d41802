#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "solvers/lcp/method_class.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A solver of another project, run in a worker process of its own (solvers/peers/protocol/): these libraries clash in
/// one process, keep global state, or crash.
struct PeerEntry {
  std::string_view key;      ///< as in the registry
  std::string_view method;   ///< one line
  std::string_view library;  ///< "Bullet", as people know it
  std::string_view licence;  ///< SPDX expression of the library as Debian ships it
  std::string_view worker;   ///< file name of the worker executable
  bool available;            ///< its worker is in this build
  bool uses_tolerance;       ///< false: one run stands for every tier
  /// What limits its size.
  MethodClass method_class;

  /// The library's own options: the adapter passes no tolerance.
  bool has_library_defaults() const { return key.ends_with("-default"); }
};

/// All peers, in the report's order.
std::span<const PeerEntry> AllPeers();

/// Starts the peer's worker with the first problem.
/// @throws InputError if it is not in this build
std::unique_ptr<LcpSolver> MakePeer(const PeerEntry& peer, const Settings& settings);

/// Where worker executables are: the environment variable LCPBENCH_WORKER_DIR, else the folder of the build, else that
/// of the installation. The first that holds `worker`; the last one's path if none does.
std::string WorkerPath(std::string_view worker);

}  // namespace lcpbench
