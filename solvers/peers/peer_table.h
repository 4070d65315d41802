#pragma once

#include <span>
#include <string_view>

#include "solvers/lcp/method_class.h"

namespace lcpbench {

/// Another project whose solvers run here, each project in a worker program of its own (solvers/peers/protocol/): these
/// libraries clash in one process, keep global state, or crash.
struct PeerProject {
  std::string_view folder;   ///< of solvers/peers/; the program is lcpbench-worker-FOLDER
  std::string_view library;  ///< "Bullet", as people know it
  std::string_view licence;  ///< SPDX expression of the library as Debian ships it
};

/// One of its solvers.
struct PeerEntry {
  const PeerProject& project;   ///< whose it is
  std::string_view key;         ///< as in the registry
  std::string_view method;      ///< one line
  bool uses_tolerance = false;  ///< false: one run stands for every tier
  /// What limits its size.
  MethodClass method_class = MethodClass::kDenseMatrix;

  /// The library's own options: the adapter passes no tolerance.
  bool has_library_defaults() const { return key.ends_with("-default"); }
};

/// All peers, in the report's order.
std::span<const PeerEntry> AllPeers();

}  // namespace lcpbench
