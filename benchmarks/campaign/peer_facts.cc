#include "benchmarks/campaign/peer_facts.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "solvers/peers/peer_table.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

/// What makes it stop, in words.
std::string StopsBy(const PeerEntry& peer) {
  constexpr std::string_view kDefault = "-default";
  if (peer.fixed_effort) return "its number of sweeps, whatever is asked for";
  if (peer.tiers) return std::string(peer.tiers->bounds);
  if (!peer.key.ends_with(kDefault)) return "the end of the method: an answer or a breakdown";
  const std::string_view tuned = peer.key.substr(0, peer.key.size() - kDefault.size());
  const auto found = std::ranges::find(AllPeers(), tuned, &PeerEntry::key);
  return std::string(found->tiers->bounds);  // AllPeers made its -default of it
}

}  // namespace

nlohmann::ordered_json PeerFactsJson() {
  nlohmann::ordered_json peers = nlohmann::ordered_json::array();
  for (const PeerEntry& peer : AllPeers()) {
    nlohmann::ordered_json entry = {{"key", peer.key},
                                    {"library", peer.project.library},
                                    {"method", peer.method},
                                    {"licence", peer.project.licence},
                                    {"route", peer.project.route == PeerRoute::kPython ? "python" : "compiled"},
                                    {"tolerance", FindSolver(peer.key).tolerance()}};
    entry["tolerances"] = nullptr;
    if (peer.tiers) entry["tolerances"] = peer.tiers->tolerances;
    entry["stops"] = StopsBy(peer);
    peers.push_back(entry);
  }
  nlohmann::ordered_json left_out = nlohmann::ordered_json::array();
  for (const LeftOutSolver& other : SolversLeftOut()) {
    left_out.push_back({{"name", other.name}, {"reason", other.reason}});
  }
  return {{"peers", peers}, {"left_out", left_out}};
}

}  // namespace lcpbench
