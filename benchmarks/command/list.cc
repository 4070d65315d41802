#include <algorithm>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "model/scenes/scene.h"
#include "solvers/auto/auto_rules.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/peer_table.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

void PrintRow(std::string_view key, const std::string& text) {
  constexpr std::size_t kKeyWidth = 26;
  std::cout << key << std::string(key.size() < kKeyWidth ? kKeyWidth - key.size() : 1, ' ') << text << '\n';
}

// The kinds of rows that it takes besides unilateral and bilateral ones.
std::string TakenRows(const SolverEntry& entry) {
  if (!entry.takes_friction && !entry.takes_bounded) return "";
  return std::string(" (takes ") + (entry.takes_friction ? "friction" : "") +
         (entry.takes_friction && entry.takes_bounded ? ", " : "") + (entry.takes_bounded ? "bounded rows" : "") + ")";
}

// Paper or library, version and licence; a peer's worker knows the version of its library.
void PrintSolvers() {
  for (const SolverEntry& entry : AllSolvers()) {
    const bool own = entry.origin == SolverOrigin::kOwn;
    const std::string version = own ? std::string(", LCPBench ") + kVersion : " " + WorkerVersion(entry.key);
    PrintRow(entry.key, entry.method + " [" + entry.source + (entry.available ? version : "") + ", " + entry.licence +
                            "]" + TakenRows(entry) + (entry.available ? "" : " (not in this build)"));
  }
}

void PrintScenes() {
  const auto print = [](std::span<const SceneFamily> families, const char* kind) {
    for (const SceneFamily& scene : families) {
      PrintRow(scene.key, std::string(scene.title) + ". " + std::string(scene.purpose) + kind);
    }
  };
  print(AllScenes(), "");
  print(FrictionScenes(), " (friction)");
}

void PrintMetrics() {
  for (const MetricEntry& metric : AllMetrics()) PrintRow(metric.key, std::string(metric.formula));
}

// What makes a peer stop, in words.
std::string StopsBy(const PeerEntry& peer) {
  constexpr std::string_view kDefault = "-default";
  if (peer.fixed_effort) return "its number of sweeps, whatever is asked for";
  if (peer.tiers) return std::string(peer.tiers->bounds);
  if (!peer.key.ends_with(kDefault)) return "the end of the method: an answer or a breakdown";
  const std::string_view tuned = peer.key.substr(0, peer.key.size() - kDefault.size());
  const auto found = std::ranges::find(AllPeers(), tuned, &PeerEntry::key);
  return std::string(found->tiers->bounds);  // AllPeers made its -default of it
}

// All solvers as report/ and docs/ read them (report/lcpbench_report/peers.json): `own` [{`key, method, tolerance` (as
// SolverEntry::tolerance) `, law` (of friction, in words)}], `peers` [{`key, library, method, licence, route`
// ("compiled" or "python") `, tolerance, tolerances` (for the tiers 1e-3, 1e-6, 1e-9; null where it follows none) `,
// stops` (in words)
// `, law, within` (the key of the solver that a transformation hands problems to)}], `left_out` [{`name, reason`}].
// Solvers that are not in this build have their entries, too.
void PrintPeers() {
  nlohmann::ordered_json own = nlohmann::ordered_json::array();
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kOwn) continue;
    own.push_back({{"key", entry.key}, {"method", entry.method}, {"tolerance", entry.tolerance()}, {"law", entry.law}});
  }
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
    entry["law"] = ToString(peer.law);
    if (!peer.within.empty()) entry["within"] = peer.within;
    peers.push_back(entry);
  }
  nlohmann::ordered_json left_out = nlohmann::ordered_json::array();
  for (const LeftOutSolver& other : SolversLeftOut()) {
    left_out.push_back({{"name", other.name}, {"reason", other.reason}});
  }
  std::cout << nlohmann::ordered_json{{"own", own}, {"peers", peers}, {"left_out", left_out}}.dump(1) << '\n';
}

void PrintRules() { std::cout << AutoRulesAsMarkdown(); }
void PrintLimits() { std::cout << AutoLimitsAsMarkdown(); }

struct ListFields {
  bool as_json = false;
  bool as_schema = false;

  void Declare(CLI::App& app) {
    CLI::Option* json =
        app.add_flag("--json", as_json, "As one JSON object: report/lcpbench_report/statistics/result_fields.json");
    // By pointer: CLI11 ends the program where there is no memory to look an option up by its name.
    app.add_flag("--schema", as_schema, "As a JSON Schema (docs/formats/campaign_lines.schema.json)")->excludes(json);
  }

  int Run() const {
    const nlohmann::ordered_json json = as_schema ? ResultJsonSchema() : ResultSchemaJson();
    std::cout << (as_json || as_schema ? json.dump(1) + "\n" : ResultSchemaMarkdown()) << std::flush;
    return 0;
  }
};

}  // namespace

void AddListCommand(CLI::App& app, CommandRun& run) {
  CLI::App* list = app.add_subcommand(
      "list", "Lists solvers, scenes, metrics, rules and limits of auto, peers or fields of result files");
  list->require_subcommand(1);
  const auto add = [list, &run](const char* name, const char* description, void (*print)()) {
    list->add_subcommand(name, description)->callback([print, &run] { run = [print] { return print(), 0; }; });
  };
  add("solvers", "Backends: key, method, source", PrintSolvers);
  add("scenes", "Scene families: key, title, purpose", PrintScenes);
  add("metrics", "Metrics of the verdict: key, formula", PrintMetrics);
  add("rules", "How auto decides, as docs/solvers/auto.md shows it", PrintRules);
  add("limits", "The numbers in these rules: name, default, range, unit, meaning", PrintLimits);
  add("peers", "Facts of our solvers, the peers and those that are left out, as one JSON object, which report/ reads",
      PrintPeers);
  AddCommand<ListFields>(*list, run, "fields", "Fields of a campaign's lines as Markdown: name, type, unit, meaning");
}

}  // namespace lcpbench
