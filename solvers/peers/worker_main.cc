// The main program of every peer's worker: lcpbench-worker-<peer> KEY [NAME=VALUE ...], started by ExternalSolver.

#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "solvers/peers/checked_solver.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/worker.h"
#include "support/input_error.h"

namespace {

lcpbench::Settings ParseSettings(int argc, char** argv) {
  lcpbench::Settings settings;
  for (int i = 2; i < argc; ++i) {
    const std::string pair = argv[i];
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw lcpbench::InputError("expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

// Settings of every peer: check=yes (default no) with check-shift, see CheckedSolver.
std::unique_ptr<lcpbench::LcpSolver> Make(const lcpbench::PeerLibrary& library, std::string_view key,
                                          const lcpbench::Settings& settings) {
  using lcpbench::CheckedSolver;
  lcpbench::SettingsReader reader(key, settings);
  const bool is_checked = reader.Choice("check", "no", {"no", "yes"}) == "yes";
  const double shift = reader.Number("check-shift", CheckedSolver::kShift, 0, 1);
  auto made = library.make(key, &reader);
  reader.Finish();
  return is_checked ? std::make_unique<CheckedSolver>(std::move(made), shift) : std::move(made);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lcpbench;
  constexpr int kMisuse = 2;
  try {
    const PeerLibrary library = ThisPeerLibrary();
    std::string known;
    for (const PeerEntry& peer : AllPeers()) {
      if (peer.project.folder != LCPBENCH_PEER) continue;
      known += (known.empty() ? "" : ", ") + std::string(peer.key);
      if (argc < 2 || peer.key != argv[1]) continue;
      const auto make = [&, settings = ParseSettings(argc, argv)] { return Make(library, peer.key, settings); };
      make();  // what is wrong with the settings is said now
      Hello hello;
      hello.name = peer.key;
      hello.library_version = library.version;
      hello.licence = peer.project.licence;
      return RunWorker(hello, make);
    }
    throw InputError("expected one of " + known);
  } catch (const InputError& error) {
    std::cerr << argv[0] << ": " << error.what() << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": internal error: " << error.what() << std::endl;
    return 1;
  }
}
