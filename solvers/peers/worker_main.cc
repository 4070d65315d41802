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
#include "solvers/peers/solvers_in_turn.h"
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

constexpr double kShift = 1e-9;  // what the engines' users take

// The relaxed problem gets this part of the tolerance, because the tier measures by other loads.
constexpr double kOfRelaxed = 0.1;

std::unique_ptr<LcpSolver> Transformed(Transformation transformation, const WithinOptions& options) {
  if (transformation == Transformation::kFourRows) return std::make_unique<FourRowSolver>(options);
  if (transformation == Transformation::kRelaxation) return std::make_unique<RelaxationSolver>(options);
  return std::make_unique<LaggedBoundsSolver>(options);
}

// Settings of every peer without a transformation: check=yes (default no), a solver with the check that ours have,
// which is one of plain rows, and where that finds fault one more turn with a shift of `check_shift`.
std::unique_ptr<LcpSolver> Make(const PeerLibrary& library, const PeerEntry& peer, const Settings& settings) {
  SettingsReader reader(peer.key, settings);
  const bool is_plain = peer.transformation == Transformation::kNone;
  const bool is_checked = is_plain && reader.Choice("check", "no", {"no", "yes"}) == "yes";
  const double shift = is_plain ? reader.Number("check_shift", kShift, 0, 1) : 0;
  const auto make = [&] { return library.make(is_plain ? peer.key : peer.within, &reader); };
  std::unique_ptr<LcpSolver> made = is_plain ? make() : Transformed(peer.transformation, {make, kOfRelaxed});
  reader.Finish();
  if (!is_checked) return made;
  const std::shared_ptr<LcpSolver> shared = std::move(made);
  return std::make_unique<SolversInTurn>(std::vector<SolversInTurn::Turn>{{shared}, {shared, shift}});
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
