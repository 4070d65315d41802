// The main program of every peer's worker: lcpbench-worker-<peer> KEY [NAME=VALUE ...], started by ExternalSolver.

#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/friction/four_rows.h"
#include "solvers/friction/lagged_bounds.h"
#include "solvers/friction/relaxation.h"
#include "solvers/lcp/solver.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/worker.h"
#include "support/input_error.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

Settings ParseSettings(int argc, char** argv) {
  Settings settings;
  for (int i = 2; i < argc; ++i) {
    const std::string pair = argv[i];
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

// The relaxed problem gets this part of the tolerance, because the tier measures by other loads.
constexpr double kOfRelaxed = 0.1;

std::unique_ptr<LcpSolver> Transformed(Transformation transformation, const WithinOptions& options) {
  if (transformation == Transformation::kFourRows) return std::make_unique<FourRowSolver>(options);
  if (transformation == Transformation::kRelaxation) return std::make_unique<RelaxationSolver>(options);
  return std::make_unique<LaggedBoundsSolver>(options);
}

std::unique_ptr<LcpSolver> Make(const PeerLibrary& library, const PeerEntry& peer, const Settings& settings) {
  SettingsReader reader(peer.key, settings);
  const bool is_plain = peer.transformation == Transformation::kNone;
  const auto make = [&] { return library.make(is_plain ? peer.key : peer.within, &reader); };
  std::unique_ptr<LcpSolver> made = is_plain ? make() : Transformed(peer.transformation, {make, kOfRelaxed});
  reader.Finish();
  return made;
}

}  // namespace
}  // namespace lcpbench

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
      const auto make = [&, settings = ParseSettings(argc, argv)] { return Make(library, peer, settings); };
      make();  // what is wrong with the settings is said now
      Hello hello;
      hello.name = peer.key;
      hello.library_version = library.version;
      hello.licence = peer.project.licence;
      return RunWorker(hello, make);
    }
    throw InputError("expected one of " + known);
  } catch (const InputError& error) {
    if (!RefuseToStart(error.what())) std::cerr << argv[0] << ": " << Printable(error.what()) << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": internal error: " << Printable(error.what()) << std::endl;
    return 1;
  }
}
