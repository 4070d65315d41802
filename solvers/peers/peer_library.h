#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// One solver of a peer's library, as its worker serves it.
struct PeerSolver {
  std::string_view key;  ///< that of peer_table.h
  /// @throws InputError for unknown or impossible settings
  std::unique_ptr<LcpSolver> (*make)(const Settings& settings) = nullptr;
};

/// What one worker executable is built from: an adapter file defines ThisPeerLibrary() and is linked with
/// worker_main.cc and the one library.
struct PeerLibrary {
  std::string version;  ///< as the library itself says, where it does
  std::string licence;
  std::span<const PeerSolver> solvers;
};
PeerLibrary ThisPeerLibrary();

/// Runs `work`, the library's call alone, and notes its time in the result where parts are wanted: adapters put
/// everything else (copies, padding, orderings) before or after.
template <typename Work>
void TimeLibraryCall(const LcpOptions& options, LcpResult* result, Work work) {
  if (!options.time_parts) return work();
  const double start = SteadyNow();
  work();
  result->own_solve_s = SteadyNow() - start;
}

/// The same for what a solve has to convert, added up.
template <typename Work>
void TimeConversion(const LcpOptions& options, LcpResult* result, Work work) {
  if (!options.time_parts) return work();
  const double start = SteadyNow();
  work();
  const double before = result->own_convert_s > 0 ? result->own_convert_s : 0;
  result->own_convert_s = before + (SteadyNow() - start);
}

}  // namespace lcpbench
