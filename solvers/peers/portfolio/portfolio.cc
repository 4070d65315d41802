// What a careful user would build of other projects' solvers: Bullet's Dantzig code; where its answer does not pass,
// the same with the engine's mixing (cfm); where that does not, ALGLIB's QuickQP, which of all peers solves the most of
// what these two leave. Each answer is judged by rho and backward error on the clock. None of them reads a clock: the
// host's time limit ends a solve.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/peers/linked_peers.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/solvers_in_turn.h"

namespace lcpbench {
namespace {

std::unique_ptr<LcpSolver> Make(std::string_view /*key*/, SettingsReader* /*reader*/) {
  const auto turn = [](const PeerLibrary& library, std::string_view key) {
    const Settings none;
    SettingsReader reader(key, none);
    return SolversInTurn::Turn{library.make(key, &reader)};
  };
  return std::make_unique<SolversInTurn>(std::vector<SolversInTurn::Turn>{turn(BulletLibrary(), "bullet-dantzig"),
                                                                          turn(BulletLibrary(), "bullet-dantzig-cfm"),
                                                                          turn(AlglibLibrary(), "alglib-quickqp")});
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  return {"Bullet " + BulletLibrary().version + ", ALGLIB " + AlglibLibrary().version, &Make};
}

}  // namespace lcpbench
