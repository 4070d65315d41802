#pragma once

#include <nlohmann/json.hpp>

namespace lcpbench {

/// The peer table as report/ and docs/ read it (report/lcpbench_report/peers.json): `peers` [{`key, library, method,
/// licence, route` ("compiled" or "python") `, tolerance` (as SolverEntry::tolerance) `, tolerances` (for the tiers
/// 1e-3, 1e-6, 1e-9; null where it follows none) `, stops` (in words)}], `left_out` [{`name, reason`}]. Peers that are
/// not in this build have their entries, too.
nlohmann::ordered_json PeerFactsJson();

}  // namespace lcpbench
